//! The passes of the tessellation stage without Bevy's renderer: control, measure, plan, place and
//! the three of emission, as `dolomite_tessellation` records them, with the functions of `shaders/src/stage/user.wgsl`.

use crate::gpu::{Gpu, GpuError};
use bytemuck::{Zeroable, bytes_of, cast_slice, pod_collect_to_vec, pod_read_unaligned};
use dolomite_tessellation::layout::{
    BLOCK, EVALUATED_BYTES, GRID_DISPATCH_ARGUMENTS, StageParams, StageView, VERTEX_BYTES,
    VERTEX_DISPATCH_ARGUMENTS, WorkHead,
};
use dolomite_tessellation::tables::{Instance, Tables};
use dolomite_tessellation::{
    Domain, Drawing, Mode, PatchLayout, PatchMesh, Spacing, Tessellator, Winding,
};
use std::borrow::Cow;
use std::sync::Arc;
use std::time::{Duration, Instant};
use thiserror::Error;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindGroupLayoutEntry, BindingType, Buffer, BufferBindingType, BufferUsages, ComputePipeline,
    ShaderStages,
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

/// The compiled passes of one tessellator.
pub struct StagePasses {
    work_layout: BindGroupLayout,
    emit_layout: BindGroupLayout,
    data_layout: Option<BindGroupLayout>,
    passes: [ComputePipeline; 6],
    /// Not of isolines.
    strips: Option<ComputePipeline>,
    pub(crate) tessellator: Tessellator,
    pub(crate) drawing: Drawing,
    split: bool,
}

/// What the passes of a tessellator are compiled for, beside its rules.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageOptions<'a> {
    /// Where vertices are evaluated.
    pub drawing: Drawing,
    /// Whether the patches' sides may be split.
    pub split: bool,
    /// Files in place of those whose paths they have, above all of `stage/user.wgsl`.
    pub functions: &'a [dolomite_shaders::ShaderFile],
    /// Buffers that the functions read, bound in this order at group 1.
    pub data: &'a [BufferBindingType],
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

/// Columns of a dispatch's grid, as in `work.wgsl`.
const COLUMNS: u32 = 32_768;

impl StagePasses {
    /// Compiles the passes of `tessellator`; vertices are stored.
    ///
    /// # Errors
    /// As [`Self::with_drawing`].
    pub fn new(gpu: &Gpu, tessellator: Tessellator) -> Result<Self, StageError> {
        Self::with_drawing(gpu, tessellator, Drawing::Stored)
    }

    /// Compiles the passes of `tessellator`.
    ///
    /// # Errors
    /// If a shader is wrong, or the adapter refuses it.
    pub fn with_drawing(
        gpu: &Gpu,
        tessellator: Tessellator,
        drawing: Drawing,
    ) -> Result<Self, StageError> {
        Self::with_functions(gpu, tessellator, drawing, &[])
    }

    /// As [`Self::with_drawing`], with `functions` in place of the shader files whose paths they
    /// have, above all of `stage/user.wgsl`.
    ///
    /// # Errors
    /// As [`Self::with_drawing`].
    pub fn with_functions(
        gpu: &Gpu,
        tessellator: Tessellator,
        drawing: Drawing,
        functions: &[dolomite_shaders::ShaderFile],
    ) -> Result<Self, StageError> {
        let options = StageOptions {
            drawing,
            functions,
            ..Default::default()
        };
        Self::with_options(gpu, tessellator, &options)
    }

    /// Compiles the passes of `tessellator` for `options`.
    ///
    /// # Errors
    /// If a shader is wrong, or the adapter refuses it.
    pub fn with_options(
        gpu: &Gpu,
        tessellator: Tessellator,
        options: &StageOptions,
    ) -> Result<Self, StageError> {
        let StageOptions {
            drawing,
            split,
            functions,
            data,
        } = *options;
        let scope = gpu.device().push_error_scope(wgpu::ErrorFilter::Validation);
        let layout = |kinds: &[BufferBindingType]| layout(gpu, ShaderStages::COMPUTE, kinds);
        let uniform = BufferBindingType::Uniform;
        let read = BufferBindingType::Storage { read_only: true };
        let write = BufferBindingType::Storage { read_only: false };
        let work_layout = layout(&[uniform, read, read, write]);
        let emit_layout = layout(&[uniform, read, read, read, write, write]);
        let data_layout = (!data.is_empty()).then(|| layout(data));
        let mut defs = defs(&tessellator, drawing);
        if split {
            defs.push("STAGE_SPLIT");
        }
        let pass = |file: &str, entry: &str, layout: &BindGroupLayout, more: &[&'static str]| {
            let defs = [defs.as_slice(), more].concat();
            let module = dolomite_shaders::compose_with(file, &defs, functions)?;
            let module = gpu
                .device()
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(entry),
                    source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
                });
            let layout = gpu
                .device()
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(entry),
                    bind_group_layouts: &[Some(layout), data_layout.as_ref()]
                        [..1 + usize::from(data_layout.is_some())],
                    immediate_size: 0,
                });
            let pipeline = gpu
                .device()
                .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(entry),
                    layout: Some(&layout),
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    cache: None,
                });
            Ok::<_, StageError>(pipeline)
        };
        let emission = |file, entry| pass(file, entry, &emit_layout, &["STAGE_READ"]);
        let passes = [
            pass("stage/control.wgsl", "control_patches", &work_layout, &[])?,
            pass("stage/measure.wgsl", "measure", &work_layout, &[])?,
            pass("stage/plan.wgsl", "plan", &work_layout, &[])?,
            pass("stage/place_items.wgsl", "place_items", &work_layout, &[])?,
            emission("stage/emit_vertices.wgsl", "emit_vertices")?,
            emission("stage/emit_grid.wgsl", "emit_grid")?,
        ];
        let strips = (tessellator.domain != Domain::Isolines)
            .then(|| emission("stage/emit_strips.wgsl", "emit_strips"))
            .transpose()?;
        if let Some(error) = bevy::tasks::block_on(scope.pop()) {
            return Err(GpuError::Validation(error.to_string()).into());
        }
        Ok(Self {
            work_layout,
            emit_layout,
            data_layout,
            passes,
            strips,
            tessellator,
            drawing,
            split,
        })
    }

    /// Shader definitions of its passes and draws.
    pub(crate) fn defs(&self) -> Vec<&'static str> {
        let mut defs = defs(&self.tessellator, self.drawing);
        if self.split {
            defs.push("STAGE_SPLIT");
        }
        defs
    }
}

/// A layout of whole buffers, one after the other.
pub(crate) fn layout(
    gpu: &Gpu,
    visibility: ShaderStages,
    kinds: &[BufferBindingType],
) -> BindGroupLayout {
    let entries: Vec<_> = (0_u32..)
        .zip(kinds)
        .map(|(binding, ty)| BindGroupLayoutEntry {
            binding,
            visibility,
            ty: BindingType::Buffer {
                ty: *ty,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    gpu.device()
        .create_bind_group_layout(&BindGroupLayoutDescriptor {
            label: None,
            entries: &entries,
        })
}

fn defs(tessellator: &Tessellator, drawing: Drawing) -> Vec<&'static str> {
    let mut defs = match tessellator.domain {
        Domain::Triangles => vec![],
        Domain::Quads => vec!["STAGE_QUADS", "STAGE_FOUR_POINTS"],
        Domain::Isolines => vec!["STAGE_ISOLINES", "STAGE_FOUR_POINTS"],
    };
    match tessellator.spacing {
        Spacing::Equal => {}
        Spacing::FractionalEven => defs.push("STAGE_FRACTIONAL_EVEN"),
        Spacing::FractionalOdd => defs.push("STAGE_FRACTIONAL_ODD"),
    }
    if tessellator.mode == Mode::D3d {
        defs.push("STAGE_D3D");
    }
    if tessellator.winding == Winding::Cw {
        defs.push("STAGE_CLOCKWISE");
    }
    if drawing == Drawing::Evaluated {
        defs.push("STAGE_EVALUATED");
    }
    defs
}

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

    /// Records the passes `repeats` times; gives the number of dispatches.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, repeats: u32) -> usize {
        for _ in 0..repeats.max(1) {
            encoder.clear_buffer(&self.work, 0, Some(self.params.cleared_bytes()));
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_bind_group(0, &self.groups[0], &[]);
            if let Some(data) = &self.data {
                pass.set_bind_group(1, data, &[]);
            }
            let items = self.params.items().div_ceil(BLOCK);
            let patches = self.params.patches.div_ceil(64);
            let [control, measure, plan, place, vertices, grid] = &self.passes.passes;
            for (pipeline, groups) in [
                (control, patches),
                (measure, items),
                (plan, 1),
                (place, items),
            ] {
                pass.set_pipeline(pipeline);
                pass.dispatch_workgroups(groups.min(COLUMNS), groups.div_ceil(COLUMNS), 1);
            }
            pass.set_bind_group(0, &self.groups[1], &[]);
            pass.set_pipeline(vertices);
            pass.dispatch_workgroups_indirect(&self.work, VERTEX_DISPATCH_ARGUMENTS);
            pass.set_pipeline(grid);
            pass.dispatch_workgroups_indirect(&self.work, GRID_DISPATCH_ARGUMENTS);
            if let Some(strips) = &self.passes.strips {
                let threads = self.params.strip_threads(self.passes.tessellator.domain);
                let groups = threads.div_ceil(256);
                pass.set_pipeline(strips);
                pass.dispatch_workgroups(groups.min(COLUMNS), groups.div_ceil(COLUMNS), 1);
            }
        }
        (self.passes.passes.len() + usize::from(self.passes.strips.is_some()))
            * repeats.max(1) as usize
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
    pub(crate) fn given(&self) -> [&Buffer; 3] {
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

    /// The buffer that begins with the arguments of the indexed draw.
    pub const fn arguments(&self) -> &Buffer {
        &self.work
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
