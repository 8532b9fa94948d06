//! A frame of the stage: its passes, the main draw into a G-buffer, and draws into shadow maps, with
//! the stage's own `draw.wgsl`.

use bytemuck::{Zeroable, bytes_of, cast_slice};
use dolomite_geometry::layout::{
    EVALUATED_BYTES, GeometryDraw, MATERIAL_ROWS, MaterialRow, VERTEX_BYTES,
};
use dolomite_geometry::render::{DrawCall, DrawSource, record_draw};
use dolomite_shaders::ShaderFile;
use dolomite_tessellation::Drawing;
use dolomite_testkit::gpu::{Gpu, GpuError};
use dolomite_testkit::stage::{StageError, StagePasses, StageRun, layout};
use std::borrow::Cow;
use std::time::{Duration, Instant};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupLayout, Buffer, BufferBindingType, BufferUsages, CommandEncoder,
    DepthStencilState, Extent3d, LoadOp, Operations, RenderPassColorAttachment,
    RenderPassDepthStencilAttachment, RenderPassDescriptor, RenderPipeline,
    RenderPipelineDescriptor, ShaderStages, StoreOp, TextureDescriptor, TextureDimension,
    TextureFormat, TextureUsages, TextureView, VertexAttribute, VertexBufferLayout, VertexFormat,
    VertexState, VertexStepMode,
};

/// Size of the main view, pixels.
pub const MAIN: [u32; 2] = [1280, 720];

/// What Bevy's deferred prepass writes where no other prepass is on.
const TARGETS: [TextureFormat; 2] = [TextureFormat::Rgba32Uint, TextureFormat::R8Uint];

/// Pipelines, targets and matrices of the draws.
pub struct Draws<'a> {
    gpu: &'a Gpu,
    main: RenderPipeline,
    shadow: RenderPipeline,
    given: BindGroup,
    nothing: BindGroup,
    main_view: BindGroup,
    shadow_views: Vec<BindGroup>,
    targets: Vec<TextureView>,
    depth: TextureView,
    maps: Vec<TextureView>,
}

/// How often the passes of the stage run in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Emission {
    /// Nothing changed.
    Never,
    /// As the stage does it.
    Once,
    /// For each view by itself, as if views did not share what is emitted.
    EveryView,
}

/// What of a frame is recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// The passes of the stage: not at all, once, or again before every shadow draw.
    pub stage: Emission,
    /// The draw into the G-buffer.
    pub main: bool,
    /// Draws into shadow maps, one each.
    pub shadows: usize,
}

/// What was recorded, and how long it took.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// From submission to completion.
    pub time: Duration,
    /// Compute dispatches recorded.
    pub dispatches: usize,
    /// Draws recorded.
    pub draws: usize,
}

impl<'a> Draws<'a> {
    /// For what `run` emits with `functions`: a main view, and shadow maps of `side`² pixels, one a
    /// matrix.
    ///
    /// # Errors
    /// If a shader is wrong, or the adapter refuses it.
    pub fn new(
        gpu: &'a Gpu,
        passes: &StagePasses,
        run: &StageRun<'_>,
        functions: &[ShaderFile],
        main: [[f32; 4]; 4],
        side: u32,
        lights: &[[[f32; 4]; 4]],
    ) -> Result<Self, StageError> {
        let device = gpu.device();
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let uniform = BufferBindingType::Uniform;
        let read = BufferBindingType::Storage { read_only: true };
        let layouts = [
            layout(gpu, ShaderStages::VERTEX, &[uniform, read, read]),
            layout(gpu, ShaderStages::VERTEX, &[]),
            layout(gpu, ShaderStages::VERTEX_FRAGMENT, &[uniform, uniform]),
        ];
        let pipeline = |main: bool| pipeline(gpu, passes, functions, &layouts, main);
        let pipelines = [pipeline(true)?, pipeline(false)?];
        let rows = [MaterialRow {
            base_color: [0.5, 0.4, 0.3, 0.0],
            emissive: [0.0, 0.0, 0.0, 0.5],
            surface: [0.9, 0.0, 1.0, 0.0],
        }; MATERIAL_ROWS];
        let buffer = |contents: &[u8]| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: None,
                contents,
                usage: BufferUsages::UNIFORM,
            })
        };
        let materials = buffer(cast_slice(&rows));
        let view = |clip_from_anchor: [[f32; 4]; 4]| {
            let mut draw = GeometryDraw::zeroed();
            draw.clip_from_anchor = clip_from_anchor;
            draw.previous_clip_from_anchor = clip_from_anchor;
            draw.uv_range = 1.0;
            group(gpu, &layouts[2], &[&buffer(bytes_of(&draw)), &materials])
        };
        let depth = TextureFormat::Depth32Float;
        let draws = Self {
            gpu,
            given: group(gpu, &layouts[0], &run.given()),
            nothing: group(gpu, &layouts[1], &[]),
            main_view: view(main),
            shadow_views: lights.iter().map(|light| view(*light)).collect(),
            targets: TARGETS.map(|format| target(gpu, MAIN, format)).to_vec(),
            depth: target(gpu, MAIN, depth),
            maps: lights
                .iter()
                .map(|_| target(gpu, [side; 2], depth))
                .collect(),
            main: pipelines[0].clone(),
            shadow: pipelines[1].clone(),
        };
        match bevy::tasks::block_on(scope.pop()) {
            Some(error) => Err(GpuError::Validation(error.to_string()).into()),
            None => Ok(draws),
        }
    }

    /// Records some parts of a frame in one submission and waits for it.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn frame(&self, run: &StageRun<'_>, parts: Parts) -> Result<Frame, StageError> {
        let mut encoder = self
            .gpu
            .device()
            .create_command_encoder(&Default::default());
        let mut dispatches = 0;
        if parts.stage != Emission::Never {
            dispatches += run.record(&mut encoder, 1);
        }
        if parts.main {
            self.draw_main(&mut encoder, run);
        }
        let shadows = parts.shadows.min(self.maps.len());
        for (map, view) in self.maps.iter().zip(&self.shadow_views).take(shadows) {
            if parts.stage == Emission::EveryView {
                dispatches += run.record(&mut encoder, 1);
            }
            let draw = (&self.shadow, view);
            self.draw(&mut encoder, run, draw, &[], map);
        }
        let start = Instant::now();
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.finish()?;
        Ok(Frame {
            time: start.elapsed(),
            dispatches,
            draws: usize::from(parts.main) + shadows,
        })
    }

    fn draw_main(&self, encoder: &mut CommandEncoder, run: &StageRun<'_>) {
        let clear = |view| RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: Operations {
                load: LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: StoreOp::Store,
            },
        };
        // As Bevy lays them out: normals and motion first, which are off.
        let mut colours = vec![None, None];
        colours.extend(self.targets.iter().map(|view| Some(clear(view))));
        let draw = (&self.main, &self.main_view);
        self.draw(encoder, run, draw, &colours, &self.depth);
    }

    fn draw(
        &self,
        encoder: &mut CommandEncoder,
        run: &StageRun<'_>,
        (pipeline, view): (&RenderPipeline, &BindGroup),
        colours: &[Option<RenderPassColorAttachment<'_>>],
        depth: &TextureView,
    ) {
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: None,
            color_attachments: colours,
            depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(Operations {
                    load: LoadOp::Clear(0.0),
                    store: StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        let call = DrawCall {
            pipeline,
            groups: [&self.given, &self.nothing, view],
            slot: None,
            pools: run.pools(),
            source: DrawSource::Indexed,
        };
        record_draw(&mut pass, &call, None);
    }

    /// Pixels of the main view that the last frame's main draw covers.
    ///
    /// # Errors
    /// If they do not come back.
    pub fn covered(&self) -> Result<usize, StageError> {
        let [width, height] = MAIN;
        let device = self.gpu.device();
        let ids = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(width * height),
            usage: BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            self.targets[1].texture().as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &ids,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    // A byte a pixel; rows of 1280 bytes are whole times the 256 of a copy.
                    bytes_per_row: Some(width),
                    rows_per_image: None,
                },
            },
            self.targets[1].texture().size(),
        );
        self.gpu.queue().submit([encoder.finish()]);
        let ids = self.gpu.read(&ids)?;
        Ok(ids.iter().filter(|id| **id != 0).count())
    }
}

fn pipeline(
    gpu: &Gpu,
    passes: &StagePasses,
    functions: &[ShaderFile],
    layouts: &[BindGroupLayout; 3],
    main: bool,
) -> Result<RenderPipeline, StageError> {
    let device = gpu.device();
    let def = if main { "GBUFFER" } else { "GEOMETRY_SHADOW" };
    let module = passes.draw_module(&[def], functions)?;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("stage_draw"),
        source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
    });
    let [given, nothing, view] = layouts;
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("stage_draw"),
        bind_group_layouts: &[Some(given), Some(nothing), Some(view)],
        immediate_size: 0,
    });
    let attribute = |format, offset, shader_location| VertexAttribute {
        format,
        offset,
        shader_location,
    };
    let stored = [
        attribute(VertexFormat::Float32x3, 0, 0),
        attribute(VertexFormat::Uint32, 12, 1),
        attribute(VertexFormat::Snorm16x2, 16, 2),
    ];
    let evaluated = [
        attribute(VertexFormat::Uint32, 0, 0),
        attribute(VertexFormat::Uint32x2, 4, 1),
    ];
    let (array_stride, attributes) = match passes.drawing {
        Drawing::Stored => (VERTEX_BYTES, stored.as_slice()),
        Drawing::Evaluated => (EVALUATED_BYTES, evaluated.as_slice()),
    };
    let targets = [None, None, Some(TARGETS[0].into()), Some(TARGETS[1].into())];
    Ok(device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some("stage_draw"),
        layout: Some(&layout),
        vertex: VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[VertexBufferLayout {
                array_stride,
                step_mode: VertexStepMode::Vertex,
                attributes,
            }],
        },
        fragment: main.then_some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &targets,
        }),
        primitive: wgpu::PrimitiveState {
            // As the stage's pipelines in Bevy, those of shadow views too.
            cull_mode: Some(wgpu::Face::Back),
            ..Default::default()
        },
        depth_stencil: Some(DepthStencilState {
            format: TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        multiview_mask: None,
        cache: None,
    }))
}

fn group(gpu: &Gpu, layout: &BindGroupLayout, buffers: &[&Buffer]) -> BindGroup {
    let entries: Vec<_> = (0_u32..)
        .zip(buffers)
        .map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &entries,
    })
}

fn target(gpu: &Gpu, [width, height]: [u32; 2], format: TextureFormat) -> TextureView {
    let texture = gpu.device().create_texture(&TextureDescriptor {
        label: None,
        size: Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}
