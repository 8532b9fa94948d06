//! Skinning from a crowd's palette: the GPU against the CPU reference in f32, and against f64.

use crate::gpu::{Binding, Gpu, GpuError, Kernel};
use crate::random::Random;
use bevy::math::{DVec3, Vec3};
use bytemuck::{Pod, Zeroable, bytes_of, cast_slice, pod_collect_to_vec};
use dolomite_character::SkinnedMesh;
use dolomite_character::crowd::{CrowdFigure, Palette, skin};
use thiserror::Error;

/// No position has these bits: a NaN with a payload. The output is filled with it first.
const SENTINEL: u32 = 0x7fc0_dead;
/// Figures for each mesh.
const FIGURES: usize = 24;

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

/// What the shader binds of a mesh and of a palette: the bytes of its vertices, and of what all figures share.
#[must_use]
pub fn bound(palette: &Palette, mesh: &SkinnedMesh) -> [Vec<u8>; 2] {
    let pair = |a: u16, b: u16| u32::from(a) | (u32::from(b) << 16);
    let vertices: Vec<Vertex> = (0..mesh.positions.len())
        .map(|i| Vertex {
            position: mesh.positions[i],
            joints_01: pair(mesh.joints[i][0], mesh.joints[i][1]),
            normal: mesh.normals.get(i).copied().unwrap_or([0.0, 1.0, 0.0]),
            joints_23: pair(mesh.joints[i][2], mesh.joints[i][3]),
            weights: mesh.weights[i],
        })
        .collect();
    let crowd = Crowd {
        anchor: [0.0; 3],
        joints: palette.joints,
    };
    [pod_collect_to_vec(&vertices), bytes_of(&crowd).to_vec()]
}

/// The shader on an adapter.
pub struct Probe {
    gpu: Gpu,
    kernel: Kernel,
}

/// Why nothing was skinned.
#[derive(Debug, Error)]
pub enum SkinningError {
    /// No adapter, or it refused.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The shader is not valid.
    #[error("{0}")]
    Shader(String),
    /// A vertex of a figure was not written.
    #[error("the shader left vertex {0} out")]
    LeftOut(usize),
    /// The model cannot be baked.
    #[error(transparent)]
    Palette(#[from] dolomite_character::crowd::PaletteError),
}

/// Distances of every vertex of every figure, and between normals of unit length.
#[derive(Debug, Default)]
pub struct Distances {
    /// To the CPU reference, metres.
    pub reference: Vec<f64>,
    /// To f64, metres.
    pub exact: Vec<f64>,
    /// Between normals of GPU and CPU reference.
    pub normals: Vec<f64>,
}

impl Probe {
    /// Compiles the shader.
    ///
    /// # Errors
    /// [`SkinningError`].
    pub fn new(gpu: Gpu) -> Result<Self, SkinningError> {
        let module = dolomite_shaders::compose("character/probe.wgsl", &[])
            .map_err(|error| SkinningError::Shader(error.to_string()))?;
        let kernel = gpu.kernel(module, "probe")?;
        Ok(Self { gpu, kernel })
    }

    /// Name of the adapter.
    pub fn device(&self) -> &str {
        &self.gpu.name
    }

    /// Position from the anchor, and normal, of every vertex of every figure.
    ///
    /// # Errors
    /// [`SkinningError`].
    pub fn run(
        &self,
        palette: &Palette,
        mesh: &SkinnedMesh,
        figures: &[CrowdFigure],
    ) -> Result<Vec<[Vec3; 2]>, SkinningError> {
        let [vertices, crowd] = bound(palette, mesh);
        let count = mesh.positions.len() * figures.len();
        let mut answers: Vec<u8> = pod_collect_to_vec(&vec![SENTINEL; count * 8]);
        let groups = &mut [
            vec![
                Binding::Read(cast_slice(&palette.rows)),
                Binding::Read(cast_slice(figures)),
                Binding::Uniform(&crowd),
            ],
            vec![Binding::Read(&vertices), Binding::Write(&mut answers)],
        ];
        let blocks = (count as u32).div_ceil(64);
        let workgroups = [blocks.min(65_535), blocks.div_ceil(65_535), 1];
        self.gpu.run(&self.kernel, groups, workgroups)?;
        let words: Vec<u32> = pod_collect_to_vec(&answers);
        let one = 1.0_f32.to_bits();
        words
            .chunks_exact(8)
            .enumerate()
            .map(|(index, answer)| {
                if [answer[3], answer[7]] != [one; 2] {
                    return Err(SkinningError::LeftOut(index));
                }
                let vector =
                    |at: usize| Vec3::from_array([0, 1, 2].map(|i| f32::from_bits(answer[at + i])));
                Ok([vector(0), vector(4)])
            })
            .collect()
    }

    /// Every vertex of every mesh, each in 24 figures at random places and moments.
    ///
    /// # Errors
    /// [`SkinningError`].
    pub fn measure(
        &self,
        palette: &Palette,
        meshes: &[SkinnedMesh],
        seed: u32,
    ) -> Result<Distances, SkinningError> {
        let mut random = Random::new(seed);
        let mut distances = Distances::default();
        for mesh in meshes {
            let figures: Vec<CrowdFigure> =
                (0..FIGURES).map(|_| figure(palette, &mut random)).collect();
            let answers = self.run(palette, mesh, &figures)?;
            for (index, [position, normal]) in answers.iter().enumerate() {
                let figure = &figures[index / mesh.positions.len()];
                let vertex = index % mesh.positions.len();
                let rows =
                    skin::vertex_rows(palette, figure, mesh.joints[vertex], mesh.weights[vertex]);
                let local = Vec3::from(mesh.positions[vertex]);
                let cpu = figure.placed(skin::skinned_position(&rows, local));
                distances.reference.push(f64::from(position.distance(cpu)));
                distances.exact.push(
                    position
                        .as_dvec3()
                        .distance(truth(palette, mesh, vertex, figure)),
                );
                if let Some(local) = mesh.normals.get(vertex) {
                    let cpu = figure.turned(skin::skinned_normal(&rows, Vec3::from(*local)));
                    distances.normals.push(f64::from(normal.distance(cpu)));
                }
            }
        }
        Ok(distances)
    }
}

/// A figure within 8 m, at some moment of some clip.
pub fn figure(palette: &Palette, random: &mut Random) -> CrowdFigure {
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
}

/// The place of a vertex in f64, from the palette's numbers and the figure's words.
#[expect(clippy::disallowed_methods, reason = "an f64 oracle")]
pub fn truth(palette: &Palette, mesh: &SkinnedMesh, vertex: usize, figure: &CrowdFigure) -> DVec3 {
    let joints = palette.joints as usize;
    let first = (figure.pose >> 16) as usize * joints;
    let part = f64::from((figure.pose >> 8) & 255) / 256.0;
    let p = mesh.positions[vertex].map(f64::from);
    let mut skinned = [0.0; 3];
    for (joint, weight) in mesh.joints[vertex].iter().zip(mesh.weights[vertex]) {
        for (row, sum) in skinned.iter_mut().enumerate() {
            let at = |frame: usize| {
                let row = palette.rows[(first + frame * joints + usize::from(*joint)) * 3 + row]
                    .map(f64::from);
                row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]
            };
            *sum += f64::from(weight) * (at(0) * (1.0 - part) + at(1) * part);
        }
    }
    let angle = f64::from(figure.place & 4095) * std::f64::consts::TAU / 4096.0;
    let [x, y, z] = skinned;
    let (s, c) = angle.sin_cos();
    DVec3::new(x * c + z * s, y, z * c - x * s) + figure.offset().as_dvec3()
}
