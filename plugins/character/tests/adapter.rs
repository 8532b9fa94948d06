//! Skinning from the palette on whatever adapter there is, against the twin in f32 and the truth in f64:
//! every vertex of every mesh. The output is filled with a sentinel first.

mod support;

use bevy::math::{DVec3, Vec3};
use bytemuck::{Pod, Zeroable, bytes_of, cast_slice, pod_collect_to_vec};
use dolomite_character::crowd::{CrowdFigure, Palette, skin};
use dolomite_character::{Rig, SkinnedMesh};
use dolomite_lab::gpu::{Binding, Gpu, Kernel, for_test};
use support::{Random, person};

/// No position has these bits: a NaN with a payload.
const SENTINEL: u32 = 0x7fc0_dead;

/// `Vertex` of `character/probe.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Vertex {
    position: [f32; 3],
    joints_01: u32,
    normal: [f32; 3],
    joints_23: u32,
    weights: [f32; 4],
}

/// `Crowd` of `character/types.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Crowd {
    anchor: [f32; 3],
    joints: u32,
}

struct Probe {
    gpu: Gpu,
    kernel: Kernel,
}

impl Probe {
    /// `None`, with a line that says so, where there is no adapter; in CI that is a failure.
    fn new() -> Option<Self> {
        let gpu = for_test()?;
        let module = dolomite_shaders::compose("character/probe.wgsl", &[]);
        let module = module.unwrap_or_else(|error| panic!("{error}"));
        let kernel = gpu.kernel(module, "probe").expect("compiles");
        Some(Self { gpu, kernel })
    }

    /// Position and normal of every vertex of every figure.
    fn run(
        &self,
        palette: &Palette,
        mesh: &SkinnedMesh,
        figures: &[CrowdFigure],
    ) -> Vec<[Vec3; 2]> {
        let pair = |a: u16, b: u16| u32::from(a) | (u32::from(b) << 16);
        let vertices: Vec<Vertex> = (0..mesh.positions.len())
            .map(|i| Vertex {
                position: mesh.positions[i],
                joints_01: pair(mesh.joints[i][0], mesh.joints[i][1]),
                normal: mesh.normals[i],
                joints_23: pair(mesh.joints[i][2], mesh.joints[i][3]),
                weights: mesh.weights[i],
            })
            .collect();
        let count = vertices.len() * figures.len();
        let mut answers: Vec<u8> = pod_collect_to_vec(&vec![SENTINEL; count * 8]);
        let crowd = Crowd {
            anchor: [0.0; 3],
            joints: palette.joints,
        };
        let groups = &mut [
            vec![
                Binding::Read(cast_slice(&palette.rows)),
                Binding::Read(cast_slice(figures)),
                Binding::Uniform(bytes_of(&crowd)),
            ],
            vec![
                Binding::Read(cast_slice(&vertices)),
                Binding::Write(&mut answers),
            ],
        ];
        let blocks = (count as u32).div_ceil(64);
        let workgroups = [blocks.min(65_535), blocks.div_ceil(65_535), 1];
        self.gpu
            .run(&self.kernel, groups, workgroups)
            .expect("runs");
        let words: Vec<u32> = pod_collect_to_vec(&answers);
        words
            .chunks_exact(8)
            .map(|answer| {
                assert_eq!(
                    [answer[3], answer[7]],
                    [1.0_f32.to_bits(); 2],
                    "every place is answered"
                );
                [0, 4].map(|at| Vec3::from_array([0, 1, 2].map(|i| f32::from_bits(answer[at + i]))))
            })
            .collect()
    }
}

/// The place of a vertex in f64, from the palette's numbers and the figure's words.
fn truth(palette: &Palette, mesh: &SkinnedMesh, vertex: usize, figure: &CrowdFigure) -> DVec3 {
    let first = (figure.pose >> 16) as usize * palette.joints as usize;
    let part = f64::from((figure.pose >> 8) & 255) / 256.0;
    let p = mesh.positions[vertex].map(f64::from);
    let mut skinned = [0.0; 3];
    for (joint, weight) in mesh.joints[vertex].iter().zip(mesh.weights[vertex]) {
        for (row, sum) in skinned.iter_mut().enumerate() {
            let at = |frame: usize| {
                let row = palette.rows
                    [(first + frame * palette.joints as usize + usize::from(*joint)) * 3 + row];
                let row = row.map(f64::from);
                row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]
            };
            *sum += f64::from(weight) * (at(0) * (1.0 - part) + at(1) * part);
        }
    }
    let angle = f64::from(figure.place & 4095) * std::f64::consts::TAU / 4096.0;
    let [x, y, z] = skinned;
    let (s, c) = angle.sin_cos();
    let turned = DVec3::new(x * c + z * s, y, z * c - x * s);
    turned + figure.offset().as_dvec3()
}

/// Greatest distances over every vertex of every mesh: to the twin, to the truth, and between normals.
fn worst(probe: &Probe, rig: &Rig, palette: &Palette, random: &mut Random) -> (f64, f64, f64) {
    let (mut twin, mut exact, mut normals) = (0.0_f64, 0.0_f64, 0.0_f64);
    for mesh in &rig.meshes {
        let figures: Vec<CrowdFigure> = (0..24)
            .map(|_| {
                let clip = random.below(palette.clips.len());
                let time = random.range(0.0, palette.clips[clip].duration);
                let offset = Vec3::new(
                    random.range(-8.0, 8.0),
                    random.range(-4.0, 4.0),
                    random.range(-8.0, 8.0),
                );
                CrowdFigure::new(
                    offset,
                    random.range(-3.2, 3.2),
                    palette.frame(clip, time, true),
                    0,
                )
            })
            .collect();
        let answers = probe.run(palette, mesh, &figures);
        for (index, [position, normal]) in answers.iter().enumerate() {
            let (figure, vertex) = (
                &figures[index / mesh.positions.len()],
                index % mesh.positions.len(),
            );
            let rows =
                skin::vertex_rows(palette, figure, mesh.joints[vertex], mesh.weights[vertex]);
            let cpu = figure.placed(skin::skinned_position(
                &rows,
                Vec3::from(mesh.positions[vertex]),
            ));
            let cpu_normal = figure.turned(skin::skinned_normal(
                &rows,
                Vec3::from(mesh.normals[vertex]),
            ));
            twin = twin.max(f64::from(position.distance(cpu)));
            exact = exact.max(
                position
                    .as_dvec3()
                    .distance(truth(palette, mesh, vertex, figure)),
            );
            normals = normals.max(f64::from(normal.distance(cpu_normal)));
        }
    }
    (twin, exact, normals)
}

#[test]
fn every_vertex_is_where_the_twin_has_it() {
    let Some(probe) = Probe::new() else { return };
    let mut random = Random::new(21);
    let mut rigs = vec![person::rig_with_mesh()];
    rigs.extend(support::knight());
    for rig in &rigs {
        let clips: Vec<usize> = (0..rig.clips.len()).collect();
        let palette = Palette::bake(rig, 0, &clips, 30.0).unwrap();
        let (twin, exact, normals) = worst(&probe, rig, &palette, &mut random);
        eprintln!(
            "{} clips on {}: twin {twin:.2e} m, f64 {exact:.2e} m, normals {normals:.2e}",
            clips.len(),
            probe.gpu.name
        );
        // The bound.
        assert!(twin <= 1e-5 && exact <= 1e-5, "{twin:e} m, {exact:e} m");
        // An inverse square root of the GPU may be off by 2 ulp, directions by some more roundings.
        assert!(normals <= 5e-6, "{normals:e}");
        // A wrong joint is seen: the same figures with every joint the next one.
        let mut wrong = palette.clone();
        wrong.rows.rotate_left(3);
        let mesh = &rig.meshes[0];
        let figure = CrowdFigure::new(Vec3::ZERO, 0.0, palette.frame(0, 0.1, true), 0);
        let answers = probe.run(&wrong, mesh, &[figure]);
        let off = (0..mesh.positions.len())
            .map(|vertex| {
                answers[vertex][0]
                    .as_dvec3()
                    .distance(truth(&palette, mesh, vertex, &figure))
            })
            .fold(0.0, f64::max);
        assert!(off > 1e-3, "{off:e} m");
    }
}
