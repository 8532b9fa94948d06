//! Drawing what the stage emitted into a depth buffer, by the stage's own vertex shader: as stored, or
//! evaluated by the draw.

use crate::gpu::Gpu;
use crate::stage::{StageError, StagePasses, StageRun, layout};
use bytemuck::{Zeroable, bytes_of};
use dolomite_geometry::layout::{EVALUATED_BYTES, GeometryDraw, VERTEX_BYTES};
use dolomite_geometry::render::{DrawCall, DrawSource, record_draw};
use dolomite_tessellation::{Domain, Drawing};
use std::borrow::Cow;
use std::time::{Duration, Instant};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BufferBindingType, BufferUsages, DepthStencilState, Extent3d, LoadOp, Operations,
    RenderPassDepthStencilAttachment, RenderPassDescriptor, RenderPipelineDescriptor, ShaderStages,
    StoreOp, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, VertexAttribute,
    VertexBufferLayout, VertexFormat, VertexState, VertexStepMode,
};

/// Side of the depth buffer, pixels: few, so that vertices are what is measured.
const SIDE: u32 = 64;

/// A draw of one run.
pub struct Draw<'a> {
    gpu: &'a Gpu,
    run: &'a StageRun<'a>,
    pipeline: wgpu::RenderPipeline,
    depth: wgpu::TextureView,
    groups: [BindGroup; 3],
}

impl<'a> Draw<'a> {
    /// Makes the pipeline for what `passes` emit.
    ///
    /// # Errors
    /// If the shader is wrong, or the adapter refuses it.
    pub fn new(
        gpu: &'a Gpu,
        passes: &StagePasses,
        run: &'a StageRun<'a>,
    ) -> Result<Self, StageError> {
        let device = gpu.device();
        let module = passes.draw_module(&[], &[])?;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("stage_draw"),
            source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
        });
        let uniform = BufferBindingType::Uniform;
        let read = BufferBindingType::Storage { read_only: true };
        let vertex = ShaderStages::VERTEX;
        let layouts = [
            layout(gpu, vertex, &[uniform, read, read]),
            layout(gpu, vertex, &[]),
            layout(gpu, vertex, &[uniform]),
        ];
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
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("stage_draw"),
            bind_group_layouts: &[Some(&layouts[0]), Some(&layouts[1]), Some(&layouts[2])],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some("stage_draw"),
            layout: Some(&pipeline_layout),
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
            fragment: None,
            primitive: wgpu::PrimitiveState {
                topology: match passes.tessellator.domain {
                    Domain::Isolines => wgpu::PrimitiveTopology::LineList,
                    _ => wgpu::PrimitiveTopology::TriangleList,
                },
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
        });
        let depth = device.create_texture(&TextureDescriptor {
            label: Some("stage_depth"),
            size: Extent3d {
                width: SIDE,
                height: SIDE,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format: TextureFormat::Depth32Float,
            usage: TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        // Everything within the picture: a hundredth of the size, from the middle.
        let mut draw = GeometryDraw::zeroed();
        for k in 0..3 {
            draw.clip_from_anchor[k][k] = 0.01;
        }
        draw.clip_from_anchor[3] = [0.0, 0.0, 0.5, 1.0];
        draw.uv_range = 1.0;
        let draw = device.create_buffer_init(&BufferInitDescriptor {
            label: None,
            contents: bytes_of(&draw),
            usage: BufferUsages::UNIFORM,
        });
        let group = |layout: &wgpu::BindGroupLayout, buffers: &[&wgpu::Buffer]| {
            let entries: Vec<_> = (0_u32..)
                .zip(buffers)
                .map(|(binding, buffer)| wgpu::BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout,
                entries: &entries,
            })
        };
        let groups = [
            group(&layouts[0], &run.given()),
            group(&layouts[1], &[]),
            group(&layouts[2], &[&draw]),
        ];
        Ok(Self {
            gpu,
            run,
            pipeline,
            depth: depth.create_view(&Default::default()),
            groups,
        })
    }

    /// Draws the last run `repeats` times; the wall time of one.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn draw(&self, repeats: u32) -> Result<Duration, StageError> {
        let mut encoder = self
            .gpu
            .device()
            .create_command_encoder(&Default::default());
        for _ in 0..repeats.max(1) {
            let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
                label: None,
                color_attachments: &[],
                depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
                    view: &self.depth,
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
            let [given, nothing, view] = &self.groups;
            let call = DrawCall {
                pipeline: &self.pipeline,
                groups: [given, nothing, view],
                slot: None,
                pools: self.run.pools(),
                source: DrawSource::Indexed,
            };
            record_draw(&mut pass, &call, None);
        }
        let start = Instant::now();
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.finish()?;
        Ok(start.elapsed() / repeats.max(1))
    }
}
