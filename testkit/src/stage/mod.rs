//! The passes of the tessellation stage without Bevy's renderer: control, measure, plan, place and
//! the three of emission, recorded by [`dolomite_tessellation::render::record`] as in an app, with the
//! functions of `shaders/src/stage/user.wgsl`.

mod passes;
mod record;

pub use passes::{StageOptions, StagePasses, layout};

use crate::gpu::{Gpu, GpuError};
use bytemuck::{Zeroable, bytes_of, cast_slice, pod_collect_to_vec, pod_read_unaligned};
use dolomite_geometry::layout::{EVALUATED_BYTES, VERTEX_BYTES};
use dolomite_geometry::render::Pools;
use dolomite_tessellation::layout::{StageParams, StageView, WorkHead};
use dolomite_tessellation::tables::{Instance, Tables};
use dolomite_tessellation::{Domain, Drawing, PatchLayout, PatchMesh};
use std::sync::Arc;
use std::time::{Duration, Instant};
use thiserror::Error;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, Buffer, BufferBindingType, BufferUsages,
};

/// Why the stage could not be run.
#[derive(Debug, Error)]
pub enum StageError {
    /// No adapter, or it refuses a pass.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A shader could not be put together.
    #[error("a stage shader could not be composed: {0}")]
    Shader(#[from] dolomite_shaders::ComposeError),
    /// More patches than a buffer holds.
    #[error("the patches need {0} bytes in one buffer, more than WebGPU promises")]
    TooLarge(u64),
}

/// Patches on the adapter, with room for what becomes of them.
pub struct StageRun<'a> {
    gpu: &'a Gpu,
    passes: &'a StagePasses,
    params: StageParams,
    given: [Buffer; 3],
    work: Buffer,
    /// 20 bytes a vertex, behind them [`GUARD`] bytes that nothing may write.
    pub vertices: Buffer,
    /// Behind the pool's indices [`GUARD`] bytes that nothing may write.
    pub indices: Buffer,
    groups: [BindGroup; 2],
    /// What the functions read.
    data: Option<BindGroup>,
}

/// What came out of a run.
pub struct Emitted {
    /// Counters and draw arguments.
    pub head: WorkHead,
    /// Position, packed normal and material, packed texture coordinates.
    pub vertices: Vec<[u32; 5]>,
    /// Three a triangle, two a segment.
    pub indices: Vec<u32>,
    /// Whether what lies behind the pools is as it was.
    pub guarded: bool,
}

/// Bytes behind each pool that are watched.
pub const GUARD: usize = 4096;

/// What every byte of the pools holds before a run.
const SENTINEL: u8 = 0xAB;

/// A view without perspective from everywhere: all planes let everything in.
fn open_view() -> StageView {
    StageView {
        planes: [[0.0, 0.0, 0.0, 1.0]; 6],
        pixels_per_radian: 1000.0,
        pixels_per_edge: 8.0,
        ..Zeroable::zeroed()
    }
}

impl<'a> StageRun<'a> {
    /// Puts entities of one layout on the adapter, with pools of so many vertices and primitives.
    ///
    /// # Errors
    /// If they are too many.
    pub fn new(
        gpu: &'a Gpu,
        passes: &'a StagePasses,
        layout: PatchLayout,
        entities: &[(Arc<PatchMesh>, Instance)],
        pools: [u32; 2],
    ) -> Result<Self, StageError> {
        let tables = Tables::new(layout, entities).map_err(StageError::TooLarge)?;
        let mut params = tables.params;
        params.view = open_view();
        params.uv_range = 1.0;
        [params.max_vertices, params.max_primitives] = pools;
        let buffer = |contents: &[u8], usage| {
            gpu.device().create_buffer_init(&BufferInitDescriptor {
                label: None,
                contents,
                usage: usage | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
            })
        };
        let storage = BufferUsages::STORAGE;
        let pool = |bytes: usize| vec![SENTINEL; bytes + GUARD];
        // A binding may not be empty.
        let full = |bytes: &[u8]| {
            if bytes.is_empty() {
                vec![0; 16]
            } else {
                bytes.to_vec()
            }
        };
        let uniform = buffer(bytes_of(&params), BufferUsages::UNIFORM);
        let words = buffer(&full(cast_slice(&tables.words)), storage);
        let data = buffer(&full(cast_slice(&tables.data)), storage);
        let work = buffer(
            &vec![SENTINEL; params.work_bytes() as usize],
            storage | BufferUsages::INDIRECT,
        );
        let vertices = buffer(
            &pool(pools[0] as usize * VERTEX_BYTES as usize),
            storage | BufferUsages::VERTEX,
        );
        let corners = corners(passes.tessellator.domain);
        let indices = buffer(
            &pool(pools[1] as usize * 4 * corners),
            storage | BufferUsages::INDEX,
        );
        let group = |layout, buffers: &[&Buffer]| {
            let entries: Vec<_> = (0_u32..)
                .zip(buffers)
                .map(|(binding, buffer)| BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            gpu.device().create_bind_group(&BindGroupDescriptor {
                label: None,
                layout,
                entries: &entries,
            })
        };
        let groups = [
            group(&passes.work_layout, &[&uniform, &words, &data, &work]),
            group(
                &passes.emit_layout,
                &[&uniform, &words, &data, &work, &vertices, &indices],
            ),
        ];
        Ok(Self {
            gpu,
            passes,
            params,
            given: [uniform, words, data],
            work,
            vertices,
            indices,
            groups,
            data: None,
        })
    }

    /// Gives the functions what they read: the bytes of each buffer of
    /// [`StageOptions::data`], in that order.
    pub fn set_data(&mut self, contents: &[&[u8]], kinds: &[BufferBindingType]) {
        let Some(layout) = &self.passes.data_layout else {
            return;
        };
        let buffers: Vec<Buffer> = contents
            .iter()
            .zip(kinds)
            .map(|(contents, kind)| {
                let usage = match kind {
                    BufferBindingType::Uniform => BufferUsages::UNIFORM,
                    BufferBindingType::Storage { .. } => BufferUsages::STORAGE,
                };
                self.gpu.device().create_buffer_init(&BufferInitDescriptor {
                    label: None,
                    contents,
                    usage,
                })
            })
            .collect();
        let entries: Vec<_> = (0_u32..)
            .zip(&buffers)
            .map(|(binding, buffer)| BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let group = self.gpu.device().create_bind_group(&BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        });
        self.data = Some(group);
    }

    /// Sees the patches as `view` does, with vertices that can store texture coordinates to
    /// `uv_range`.
    pub fn set_view(&mut self, view: StageView, uv_range: f32) {
        self.params.view = view;
        self.params.uv_range = uv_range;
        let uniform = &self.given[0];
        self.gpu
            .queue()
            .write_buffer(uniform, 0, bytes_of(&self.params));
    }

    /// Records the passes `repeats` times and waits; gives the wall time of one.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn tessellate(&self, repeats: u32) -> Result<Duration, StageError> {
        let mut encoder = self
            .gpu
            .device()
            .create_command_encoder(&Default::default());
        self.record(&mut encoder, repeats);
        self.timed(encoder, repeats)
    }

    /// Copies as many bytes as the last run emitted, `repeats` times; the wall time of one.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn copy(&self, head: &WorkHead, repeats: u32) -> Result<Duration, StageError> {
        let vertices = u64::from(head.vertices) * self.vertex_bytes();
        let indices = u64::from(head.indexed[0]) * 4;
        let target = |size| {
            self.gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage: BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let (to_vertices, to_indices) = (target(vertices), target(indices));
        let encoder = |repeats: u32| {
            let mut encoder = self
                .gpu
                .device()
                .create_command_encoder(&Default::default());
            for _ in 0..repeats {
                encoder.copy_buffer_to_buffer(&self.vertices, 0, &to_vertices, 0, Some(vertices));
                encoder.copy_buffer_to_buffer(&self.indices, 0, &to_indices, 0, Some(indices));
            }
            encoder
        };
        // The first copy pays for the pages of a fresh buffer.
        self.timed(encoder(1), 1)?;
        self.timed(encoder(repeats.max(1)), repeats)
    }

    fn timed(&self, encoder: wgpu::CommandEncoder, repeats: u32) -> Result<Duration, StageError> {
        let start = Instant::now();
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.finish()?;
        Ok(start.elapsed() / repeats.max(1))
    }

    /// What a pass after emission reads: parameters, tables, data and the work buffer, as bytes.
    ///
    /// # Errors
    /// If they do not come back.
    pub fn inputs(&self) -> Result<[Vec<u8>; 4], StageError> {
        let [_, tables, data] = &self.given;
        Ok([
            bytes_of(&self.params).to_vec(),
            self.gpu.read(tables)?,
            self.gpu.read(data)?,
            self.gpu.read(&self.work)?,
        ])
    }

    /// What control and evaluate functions read: parameters, tables, data.
    pub fn given(&self) -> [&Buffer; 3] {
        self.given.each_ref()
    }

    /// Bytes of a vertex in the pool.
    const fn vertex_bytes(&self) -> u64 {
        match self.passes.drawing {
            Drawing::Stored => VERTEX_BYTES,
            Drawing::Evaluated => EVALUATED_BYTES,
        }
    }

    /// Vertices and indices that the last run emitted, bytes.
    #[must_use]
    pub const fn bytes(&self, head: &WorkHead) -> u64 {
        head.vertices as u64 * self.vertex_bytes() + head.indexed[0] as u64 * 4
    }

    /// What draws read.
    #[must_use]
    pub const fn pools(&self) -> Pools<'_> {
        Pools {
            vertices: &self.vertices,
            previous: None,
            indices: &self.indices,
            work: &self.work,
        }
    }

    /// Counters and arguments of the last run.
    ///
    /// # Errors
    /// If they do not come back.
    pub fn head(&self) -> Result<WorkHead, StageError> {
        let bytes = self.gpu.read(&self.work)?;
        Ok(pod_read_unaligned(&bytes[..size_of::<WorkHead>()]))
    }

    /// Everything of the last run.
    ///
    /// # Errors
    /// If it does not come back.
    pub fn read(&self) -> Result<Emitted, StageError> {
        let head = self.head()?;
        let vertices = self.gpu.read(&self.vertices)?;
        let indices = self.gpu.read(&self.indices)?;
        let guarded = [&vertices, &indices].iter().all(|bytes| {
            bytes[bytes.len() - GUARD..]
                .iter()
                .all(|byte| *byte == SENTINEL)
        });
        let used = head.vertices as usize * VERTEX_BYTES as usize;
        Ok(Emitted {
            head,
            vertices: pod_collect_to_vec(&vertices[..used.min(vertices.len())]),
            indices: pod_collect_to_vec(
                &indices[..(head.indexed[0] as usize * 4).min(indices.len())],
            ),
            guarded,
        })
    }
}

/// Indices of a primitive.
const fn corners(domain: Domain) -> usize {
    match domain {
        Domain::Isolines => 2,
        _ => 3,
    }
}
