//! The passes of the level of detail without Bevy's renderer, as `dolomite_tessellation` records them.

mod answers;

pub use answers::{DetailAnswers, Staged};

use crate::gpu::{Gpu, GpuError};
use bytemuck::{bytes_of, cast_slice, pod_collect_to_vec};
use dolomite_tessellation::detail::DetailCells;
use dolomite_tessellation::detail::lattice::MAX_DEPTH;
use dolomite_tessellation::detail::layout::{
    Beginning, DEPTH_PASSES, DetailParams, DetailPass, GROUPS, HEAD_COARSENING, HEAD_LEFT,
    HEAD_USED, LAST_PASSES, VIEW_CELL_BYTES,
};
use dolomite_tessellation::stage::layout::VERTEX_BYTES;
use std::borrow::Cow;
use std::time::{Duration, Instant};
use thiserror::Error;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupLayout, BindGroupLayoutEntry, BindingType, Buffer, BufferBindingType,
    BufferUsages, ComputePass, ComputePipeline, ShaderStages,
};

/// Why the passes could not be run.
#[derive(Debug, Error)]
pub enum DetailError {
    /// No adapter, or it refuses a pass.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A shader could not be put together.
    #[error("a shader of the level of detail could not be composed: {0}")]
    Shader(#[from] dolomite_shaders::ComposeError),
}

/// What one choice left.
#[derive(Clone, Debug, PartialEq)]
pub struct DetailRun {
    /// Positions relative to the anchor.
    pub positions: Vec<[f32; 3]>,
    /// Counter-clockwise seen from above.
    pub triangles: Vec<[u32; 3]>,
    /// What demands were divided by.
    pub coarsening: f32,
    /// The greatest demand that finest cells leave.
    pub left: f32,
    /// Cells that are kept.
    pub used: u32,
    /// From the first pass to the last.
    pub time: Duration,
}

/// One ground's passes and buffers.
pub struct DetailStage<'a> {
    gpu: &'a Gpu,
    depth_passes: Vec<ComputePipeline>,
    last_passes: Vec<ComputePipeline>,
    pass_layout: BindGroupLayout,
    emit_layout: BindGroupLayout,
    beginning: Beginning,
    terrain: BindGroup,
    corners: Buffer,
    uniform: Buffer,
    /// A slot a depth.
    depths: Buffer,
    kept: [Buffer; 5],
    capacity: u32,
    stamp: u32,
    /// Of the newest choice.
    vertices: Option<Buffer>,
    answers: Option<answers::AnswerPass>,
}

/// What a choice is written to.
struct Chosen {
    encoder: wgpu::CommandEncoder,
    vertices: Buffer,
    indices: Buffer,
    head: Buffer,
}

/// Bytes between the slots of a uniform buffer.
const SLOT: u64 = 256;

const UNIFORM: BufferBindingType = BufferBindingType::Uniform;
const READ: BufferBindingType = BufferBindingType::Storage { read_only: true };
const WRITE: BufferBindingType = BufferBindingType::Storage { read_only: false };

fn layout(gpu: &Gpu, types: &[(BufferBindingType, bool)]) -> BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(
            |(binding, &(ty, has_dynamic_offset))| BindGroupLayoutEntry {
                binding,
                visibility: ShaderStages::COMPUTE,
                ty: BindingType::Buffer {
                    ty,
                    has_dynamic_offset,
                    min_binding_size: None,
                },
                count: None,
            },
        )
        .collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &entries,
    };
    gpu.device().create_bind_group_layout(&descriptor)
}

fn group(gpu: &Gpu, layout: &BindGroupLayout, resources: &[wgpu::BindingResource]) -> BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry {
            binding,
            resource: resource.clone(),
        })
        .collect();
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &entries,
    })
}

impl<'a> DetailStage<'a> {
    /// Compiles the passes and makes buffers with room for `capacity` cells.
    ///
    /// # Errors
    /// [`DetailError`].
    pub fn new(gpu: &'a Gpu, cells: &DetailCells, capacity: u32) -> Result<Self, DetailError> {
        let pass_layout = layout(
            gpu,
            &[
                (UNIFORM, false),
                (UNIFORM, true),
                (WRITE, false),
                (WRITE, false),
                (WRITE, false),
                (WRITE, false),
                (WRITE, false),
            ],
        );
        let terrain_layout = layout(gpu, &[(READ, false), (READ, false), (UNIFORM, false)]);
        let emit_layout = layout(gpu, &[(READ, false), (WRITE, false)]);
        let pipeline = |file: &str, entry: &str, second: Option<&BindGroupLayout>| {
            let module = dolomite_shaders::compose(file, &[])?;
            let module = gpu
                .device()
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(file),
                    source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
                });
            let layouts = [Some(&pass_layout), second];
            let layout = gpu
                .device()
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(entry),
                    bind_group_layouts: &layouts[..1 + usize::from(second.is_some())],
                    immediate_size: 0,
                });
            Ok::<_, DetailError>(gpu.device().create_compute_pipeline(
                &wgpu::ComputePipelineDescriptor {
                    label: Some(entry),
                    layout: Some(&layout),
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    cache: None,
                },
            ))
        };
        let depth_passes = DEPTH_PASSES
            .iter()
            .map(|(file, entry)| {
                let second = file.contains("make").then_some(&terrain_layout);
                pipeline(file, entry, second)
            })
            .collect::<Result<_, _>>()?;
        let last_passes = LAST_PASSES
            .iter()
            .map(|(file, entry, _)| {
                let emits = file.contains("emit") || file.contains("finish");
                pipeline(file, entry, emits.then_some(&emit_layout))
            })
            .collect::<Result<_, _>>()?;
        let beginning = Beginning::new(cells);
        let empty = |size: u64| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let filled = |contents: &[u8], usage| {
            gpu.device().create_buffer_init(&BufferInitDescriptor {
                label: None,
                contents,
                usage: usage | BufferUsages::COPY_DST,
            })
        };
        let room = u64::from(capacity);
        let kept = [
            empty(96 * room),
            empty(16 * room),
            empty(VIEW_CELL_BYTES * room),
            empty(size_of_val(&beginning.counts(true)) as u64),
            empty(2 * room),
        ];
        let blocks = &beginning.blocks;
        let mut lists = vec![0_u32; capacity as usize / 2];
        let last = lists.len() - 1;
        for (k, &block) in blocks.iter().enumerate() {
            lists[k] = block;
            lists[last - k] = block;
        }
        gpu.queue()
            .write_buffer(&kept[1], 0, cast_slice(&beginning.links));
        gpu.queue().write_buffer(&kept[4], 0, cast_slice(&lists));
        let mut depths = vec![0_u8; (SLOT * u64::from(MAX_DEPTH + 1)) as usize];
        for depth in 0..=MAX_DEPTH {
            let pass = DetailPass {
                depth,
                ..DetailPass::default()
            };
            let at = (u64::from(depth) * SLOT) as usize;
            depths[at..at + size_of::<DetailPass>()].copy_from_slice(bytes_of(&pass));
        }
        let given = cells.terrain().gpu();
        let terrain = group(
            gpu,
            &terrain_layout,
            &[
                filled(cast_slice(&given.layers), BufferUsages::STORAGE).as_entire_binding(),
                filled(cast_slice(&given.data), BufferUsages::STORAGE).as_entire_binding(),
                filled(bytes_of(&given.uniform), BufferUsages::UNIFORM).as_entire_binding(),
            ],
        );
        Ok(Self {
            gpu,
            depth_passes,
            last_passes,
            pass_layout,
            emit_layout,
            terrain,
            corners: filled(cast_slice(&beginning.corners), BufferUsages::STORAGE),
            uniform: filled(&[0; size_of::<DetailParams>()], BufferUsages::UNIFORM),
            depths: filled(&depths, BufferUsages::UNIFORM),
            beginning,
            kept,
            capacity,
            stamp: 0,
            vertices: None,
            answers: None,
        })
    }

    /// Chooses, and makes the mesh.
    ///
    /// # Errors
    /// [`DetailError`].
    pub fn run(&mut self, params: DetailParams) -> Result<DetailRun, DetailError> {
        let Chosen {
            encoder,
            vertices,
            indices,
            head,
        } = self.choose(params);
        let gpu = self.gpu;
        let start = Instant::now();
        gpu.queue().submit([encoder.finish()]);
        gpu.finish()?;
        let time = start.elapsed();
        let head: Vec<u32> = pod_collect_to_vec(&gpu.read(&head)?);
        let words: Vec<u32> = pod_collect_to_vec(&gpu.read(&vertices)?);
        let numbers: Vec<u32> = pod_collect_to_vec(&gpu.read(&indices)?);
        let (vertices, triangles) = (head[12] as usize, head[13] as usize);
        Ok(DetailRun {
            positions: words
                .chunks_exact(5)
                .take(vertices)
                .map(|vertex| [vertex[0], vertex[1], vertex[2]].map(f32::from_bits))
                .collect(),
            triangles: numbers
                .chunks_exact(3)
                .take(triangles)
                .map(|corners| [corners[0], corners[1], corners[2]])
                .collect(),
            coarsening: f32::from_bits(head[HEAD_COARSENING]),
            left: f32::from_bits(head[HEAD_LEFT]),
            used: head[HEAD_USED],
            time,
        })
    }

    /// Records a choice.
    fn choose(&mut self, params: DetailParams) -> Chosen {
        let gpu = self.gpu;
        self.stamp += 1;
        let params = DetailParams {
            stamp: self.stamp,
            capacity: self.capacity,
            ..params
        };
        let queue = gpu.queue();
        queue.write_buffer(&self.uniform, 0, bytes_of(&params));
        let fresh = self.stamp == 1;
        let counts = self.beginning.counts(fresh);
        let skipped = usize::from(!fresh);
        queue.write_buffer(
            &self.kept[3],
            4 * skipped as u64,
            cast_slice(&counts[skipped..]),
        );
        queue.write_buffer(&self.kept[4], 0, cast_slice(&self.beginning.blocks));
        let out = |bytes: u64| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: bytes,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let vertices = out(VERTEX_BYTES * u64::from(params.max_vertices));
        let indices = out(12 * u64::from(params.max_triangles));
        let head = out(128);
        let slot = wgpu::BufferBinding {
            buffer: &self.depths,
            offset: 0,
            size: std::num::NonZero::new(size_of::<DetailPass>() as u64),
        };
        let mut bound = vec![
            self.uniform.as_entire_binding(),
            wgpu::BindingResource::Buffer(slot),
        ];
        bound.extend(self.kept.iter().map(Buffer::as_entire_binding));
        let shared = group(gpu, &self.pass_layout, &bound);
        let emit = |buffer: &Buffer| {
            let bound = [self.corners.as_entire_binding(), buffer.as_entire_binding()];
            group(gpu, &self.emit_layout, &bound)
        };
        let [to_vertices, to_indices, to_head] = [&vertices, &indices, &head].map(emit);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            let dispatch = |pass: &mut ComputePass, pipeline, groups| {
                pass.set_pipeline(pipeline);
                pass.dispatch_workgroups(groups, 1, 1);
            };
            for depth in 0..=params.depth {
                pass.set_bind_group(0, &shared, &[depth * SLOT as u32]);
                pass.set_bind_group(1, &self.terrain, &[]);
                for pipeline in &self.depth_passes {
                    dispatch(&mut pass, pipeline, GROUPS);
                }
            }
            for (pipeline, (file, entry, single)) in self.last_passes.iter().zip(LAST_PASSES) {
                let target = match (file, entry) {
                    ("detail/emit_triangles.wgsl", _) => &to_indices,
                    ("detail/finish.wgsl", _) => &to_head,
                    _ => &to_vertices,
                };
                pass.set_bind_group(1, target, &[]);
                dispatch(&mut pass, pipeline, if single { 1 } else { GROUPS });
            }
        }
        self.vertices = Some(vertices.clone());
        Chosen {
            encoder,
            vertices,
            indices,
            head,
        }
    }
}
