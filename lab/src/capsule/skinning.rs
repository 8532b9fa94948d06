//! Skinning of a crowd from its palette, against the CPU reference: every vertex of every figure.

use bevy::math::{Affine3A, EulerRot, Quat, Vec3};
use bytemuck::cast_slice;
use dolomite_character::SkinnedMesh;
use dolomite_character::crowd::{CrowdFigure, Palette, PaletteClip, skin};
use dolomite_testkit::random::Random;
use dolomite_testkit::skinning::{bound, figure};

use super::CapsuleError;
use super::builder::Builder;
use super::format::{BindingKind, Capsule, Field, FieldType, From};

/// Joints of a figure.
const JOINTS: u32 = 24;
/// Clips, and frames of each.
const CLIPS: u32 = 3;
const FRAMES: u32 = 12;
const VERTICES: usize = 200;
const FIGURES: usize = 40;

/// Units in the last place that a coordinate may be off, of [`SIZE`] metres.
const ULP: f64 = 4.0;
/// A figure stands up to 8 m from the anchor, and a vertex up to 4 m from it.
const SIZE: f32 = 16.0;
/// Of a normal, of 1: 1.5 for the matrix, 1.5 for the product of three terms, 2 for the inverse square root and 1 for its
/// product, 2.5 for the turn, whose sine is off by one.
const NORMAL_ULP: f64 = 8.5;

/// Joints that turn and move at random.
fn palette(random: &mut Random) -> Palette {
    let mut signed = || 2.0 * random.unit_f32() - 1.0;
    let mut rows = Vec::new();
    for _ in 0..CLIPS * FRAMES * JOINTS {
        let turn = Quat::from_euler(EulerRot::YXZ, 3.0 * signed(), signed(), signed());
        let place = Vec3::new(signed(), signed(), signed());
        let joint = Affine3A::from_rotation_translation(turn, place);
        rows.extend([0, 1, 2].map(|k| {
            let of = |column: bevy::math::Vec3A| column.to_array()[k];
            let [x, y, z] = [joint.x_axis, joint.y_axis, joint.z_axis].map(of);
            [x, y, z, of(joint.translation)]
        }));
    }
    let clips = (0..CLIPS).map(|clip| PaletteClip {
        name: format!("clip {clip}"),
        first: clip * FRAMES,
        frames: FRAMES,
        duration: 1.0,
    });
    Palette {
        joints: JOINTS,
        rows,
        clips: clips.collect(),
    }
}

/// Vertices that hang on one joint to four.
fn mesh(random: &mut Random) -> SkinnedMesh {
    let mut mesh = SkinnedMesh::default();
    for vertex in 0..VERTICES {
        let mut signed = || 2.0 * random.unit_f32() - 1.0;
        mesh.positions.push([signed(), 1.0 + signed(), signed()]);
        let normal = Vec3::new(signed(), signed(), signed()).try_normalize();
        mesh.normals.push(normal.unwrap_or(Vec3::Y).to_array());
        mesh.joints
            .push([0; 4].map(|_| random.below(JOINTS as usize) as u16));
        let hangs_on = 1 + vertex % 4;
        let mut weights = [0.0; 4];
        for weight in &mut weights[..hangs_on] {
            *weight = 1.0 / hangs_on as f32;
        }
        mesh.weights.push(weights);
    }
    mesh
}

/// Forty figures of two hundred vertices.
///
/// # Errors
/// If the shader is wrong.
pub fn capsule(name: &str, about: &str, seed: u32) -> Result<Capsule, CapsuleError> {
    let mut random = Random::new(seed);
    let palette = palette(&mut random);
    let mesh = mesh(&mut random);
    let figures: Vec<CrowdFigure> = (0..FIGURES)
        .map(|_| figure(&palette, &mut random))
        .collect();
    let expected: Vec<[f32; 8]> = figures
        .iter()
        .flat_map(|figure| (0..VERTICES).map(move |vertex| (figure, vertex)))
        .map(|(figure, vertex)| {
            let (joints, weights) = (mesh.joints[vertex], mesh.weights[vertex]);
            let rows = skin::vertex_rows(&palette, figure, joints, weights);
            let place = skin::skinned_position(&rows, mesh.positions[vertex].into());
            let normal = skin::skinned_normal(&rows, mesh.normals[vertex].into());
            let ([x, y, z], [u, v, w]) = (
                figure.placed(place).to_array(),
                figure.turned(normal).to_array(),
            );
            [x, y, z, 1.0, u, v, w, 1.0]
        })
        .collect();

    let mut builder = Builder::new(name, about);
    let file = "character/probe.wgsl";
    let module = dolomite_shaders::compose(file, &[])?;
    let module = builder.module(file, &[], &module)?;
    let read = BindingKind::ReadOnlyStorage;
    let layouts = [
        builder.layout(&[read, read, BindingKind::Uniform]),
        builder.layout(&[read, BindingKind::Storage]),
    ];
    let pipeline = builder.pipeline(module, "probe", &layouts);
    let [vertices, crowd] = bound(&palette, &mesh);
    let given = [
        builder.buffer("palette", cast_slice(&palette.rows)),
        builder.buffer("figures", cast_slice(&figures)),
        builder.buffer("crowd", &crowd),
    ];
    let vertices = builder.buffer("vertices", &vertices);
    let found = builder.filled("answers", 32 * expected.len() as u64, 0xAB);
    let groups = [
        builder.group(layouts[0], &given),
        builder.group(layouts[1], &[vertices, found]),
    ];
    builder.dispatch(
        pipeline,
        &groups,
        [expected.len().div_ceil(64) as u32, 1, 1],
    );
    let number = |ulp, scale| FieldType::F32 { ulp, scale };
    let fields = vec![
        Field::new("position", 0, 3, number(ULP, SIZE)),
        Field::words("answered", 12, 1),
        Field::new("normal", 16, 3, number(NORMAL_ULP, 1.0)),
        Field::words("answered", 28, 1),
    ];
    let from = From::CpuReference;
    builder.check(
        "skinned",
        (found, 0, 32),
        fields,
        cast_slice(&expected),
        from,
    );
    Ok(builder.finish())
}
