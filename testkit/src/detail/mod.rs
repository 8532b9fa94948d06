//! The passes of the level of detail without Bevy's renderer, recorded by
//! [`dolomite_ground::render::detail::record`] as in an app.

mod answers;
mod layouts;
mod record;
mod times;

pub use answers::{DetailAnswers, Staged};

use crate::gpu::{Gpu, GpuError};
use bytemuck::{bytes_of, cast_slice, pod_collect_to_vec, pod_read_unaligned};
use dolomite_geometry::layout::{GeometryHead, HEAD_WORDS};
use dolomite_ground::detail::DetailCells;
use dolomite_ground::detail::lattice::MAX_DEPTH;
use dolomite_ground::detail::layout::{
    ALL_COUNT_WORDS, ARGUMENT_BYTES, Beginning, CLOSING_BYTES, DEPTH_PASSES, DetailParams,
    DetailPass, EditedRect, HEAD_COARSENING, HEAD_LEFT, HEAD_USED, LAST_PASSES, LIST_BYTES, MAKE,
    Pass, STOCK_HEAD_BYTES, SWEEP_PASS, Second, VIEW_CELL_BYTES, without,
};
use dolomite_ground::render::detail::record::SLOT;
use dolomite_terrain::Terrain;
use layouts::{Layouts, group};
use std::borrow::Cow;
use std::time::{Duration, Instant};
use thiserror::Error;
pub use times::PassTime;
pub(crate) use times::Timer;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BindGroup, Buffer, BufferUsages, ComputePipeline};

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
    /// Counter-clockwise seen from above; where the choice leaves out what its picture does not show,
    /// those that it may show.
    pub triangles: Vec<[u32; 3]>,
    /// Those that were left out, where they are kept.
    pub others: Vec<[u32; 3]>,
    /// What error ratios were divided by.
    pub coarsening: f32,
    /// The greatest error ratio that finest cells leave.
    pub left: f32,
    /// Cells that are kept.
    pub used: u32,
    /// From the first pass to the last.
    pub time: Duration,
}

/// One ground's passes and buffers.
pub struct DetailStage<'a> {
    gpu: &'a Gpu,
    /// Those of a depth, those that close a choice, and the sweep.
    passes: Vec<ComputePipeline>,
    layouts: Layouts,
    beginning: Beginning,
    terrain: BindGroup,
    corners: Buffer,
    uniform: Buffer,
    /// A slot a depth.
    depths: Buffer,
    kept: [Buffer; 5],
    stock: Buffer,
    arguments: [Buffer; 2],
    closing: Buffer,
    capacity: u32,
    stamp: u32,
    /// Where the ground was edited, and whether its roots are to be made again.
    edited: Vec<EditedRect>,
    remade: bool,
    /// Of the newest choice.
    vertices: Option<Buffer>,
    answers: Option<answers::AnswerPass>,
    /// Of the newest choice, where they are wanted.
    times: Option<times::Timer>,
}

/// What a choice is written to.
struct Chosen {
    encoder: wgpu::CommandEncoder,
    vertices: Buffer,
    indices: Buffer,
    head: Buffer,
}

impl<'a> DetailStage<'a> {
    /// Compiles the passes and makes buffers with room for `capacity` cells.
    ///
    /// # Errors
    /// [`DetailError`].
    pub fn new(gpu: &'a Gpu, cells: &DetailCells, capacity: u32) -> Result<Self, DetailError> {
        let layouts = Layouts::new(gpu);
        let without = without(cells.terrain());
        let pipeline = |(file, entry, second, _): &Pass| {
            let defs: &[&str] = match second {
                Second::Ground => &without,
                _ => &[],
            };
            let module = dolomite_shaders::compose(file, defs)?;
            let module = gpu
                .device()
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(*file),
                    source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
                });
            let second = layouts.of(*second);
            let groups = [Some(&layouts.shared), second];
            let layout = gpu
                .device()
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(entry),
                    bind_group_layouts: &groups[..1 + usize::from(second.is_some())],
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
        let passes = DEPTH_PASSES.iter().chain(&LAST_PASSES).chain([&SWEEP_PASS]);
        let passes = passes.map(pipeline).collect::<Result<_, _>>()?;
        let beginning = Beginning::new(cells);
        let empty = |size: u64| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage: BufferUsages::STORAGE
                    | BufferUsages::COPY_DST
                    | BufferUsages::COPY_SRC
                    | BufferUsages::INDIRECT,
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
            empty(4 * ALL_COUNT_WORDS as u64),
            empty(LIST_BYTES * room),
        ];
        let lists = beginning.lists(capacity);
        gpu.queue()
            .write_buffer(&kept[1], 0, cast_slice(&beginning.links));
        gpu.queue().write_buffer(&kept[4], 0, cast_slice(&lists));
        let stock = empty(STOCK_HEAD_BYTES + room);
        gpu.queue()
            .write_buffer(&stock, 0, cast_slice(&beginning.stock()));
        let mut depths = vec![0_u8; (SLOT * u64::from(MAX_DEPTH + 1)) as usize];
        for depth in 0..=MAX_DEPTH {
            let pass = DetailPass {
                depth,
                ..DetailPass::default()
            };
            let at = (u64::from(depth) * SLOT) as usize;
            depths[at..at + size_of::<DetailPass>()].copy_from_slice(bytes_of(&pass));
        }
        let terrain = ground(gpu, &layouts, cells.terrain());
        Ok(Self {
            gpu,
            passes,
            layouts,
            arguments: [0, 1].map(|_| empty(ARGUMENT_BYTES)),
            closing: empty(CLOSING_BYTES),
            terrain,
            corners: filled(cast_slice(&beginning.corners), BufferUsages::STORAGE),
            uniform: filled(&[0; size_of::<DetailParams>()], BufferUsages::UNIFORM),
            depths: filled(&depths, BufferUsages::UNIFORM),
            beginning,
            kept,
            stock,
            capacity,
            stamp: 0,
            edited: Vec::new(),
            remade: false,
            vertices: None,
            answers: None,
            times: None,
        })
    }

    /// Takes other edits of the ground over, as a store of an app does. Its definitions stay: the ground has to have had a
    /// layer of edits before.
    pub fn edit(&mut self, cells: &mut DetailCells, terrain: &Terrain) {
        let lines = cells.follow_edits(terrain).unwrap_or_default();
        let stamp = self.stamp;
        self.edited
            .extend(lines.into_iter().map(|[low, high]| EditedRect {
                low: low.to_array(),
                high: high.to_array(),
                stamp,
                ..EditedRect::default()
            }));
        self.beginning = Beginning::new(cells);
        let queue = self.gpu.queue();
        queue.write_buffer(&self.corners, 0, cast_slice(&self.beginning.corners));
        self.terrain = ground(self.gpu, &self.layouts, terrain);
        self.remade = true;
    }

    /// How many blocks of four cells the newest choice made.
    ///
    /// # Errors
    /// [`DetailError`].
    pub fn made(&self) -> Result<u32, DetailError> {
        let counts: Vec<u32> = pod_collect_to_vec(&self.gpu.read(&self.kept[3])?);
        Ok(counts[MAKE..=MAKE + MAX_DEPTH as usize].iter().sum())
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
        let head: GeometryHead = pod_read_unaligned(&gpu.read(&head)?);
        let words: Vec<u32> = pod_collect_to_vec(&gpu.read(&vertices)?);
        let numbers: Vec<u32> = pod_collect_to_vec(&gpu.read(&indices)?);
        let (vertices, triangles) = (head.vertices as usize, head.primitives as usize);
        let others = head.others;
        let head: [u32; HEAD_WORDS as usize] = bytemuck::cast(head);
        let listed = |first: usize, count: usize| {
            let triples = numbers.chunks_exact(3).skip(first).take(count);
            triples
                .map(|corners| [corners[0], corners[1], corners[2]])
                .collect()
        };
        Ok(DetailRun {
            positions: words
                .chunks_exact(5)
                .take(vertices)
                .map(|vertex| [vertex[0], vertex[1], vertex[2]].map(f32::from_bits))
                .collect(),
            triangles: listed(0, triangles),
            others: listed(others[2] as usize / 3, others[0] as usize / 3),
            coarsening: f32::from_bits(head[HEAD_COARSENING]),
            left: f32::from_bits(head[HEAD_LEFT]),
            used: head[HEAD_USED],
            time,
        })
    }
}

/// What the height function reads, bound.
fn ground(gpu: &Gpu, layouts: &Layouts, terrain: &Terrain) -> BindGroup {
    let given = terrain.gpu();
    let filled = |contents: &[u8], usage| {
        gpu.device().create_buffer_init(&BufferInitDescriptor {
            label: None,
            contents,
            usage,
        })
    };
    group(
        gpu,
        &layouts.ground,
        &[
            filled(cast_slice(&given.layers), BufferUsages::STORAGE).as_entire_binding(),
            filled(cast_slice(&given.data), BufferUsages::STORAGE).as_entire_binding(),
            filled(bytes_of(&given.uniform), BufferUsages::UNIFORM).as_entire_binding(),
        ],
    )
}
