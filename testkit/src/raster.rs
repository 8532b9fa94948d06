//! Pixels that triangles leave uncovered: a picture of one colour, drawn over another.

use crate::gpu::{Gpu, GpuError};
use crate::stage::StageRun;
use bytemuck::cast_slice;
use dolomite_geometry::layout::VERTEX_BYTES;
use wgpu::{
    BufferUsages, Extent3d, FragmentState, LoadOp, Operations, RenderPassColorAttachment,
    RenderPassDescriptor, RenderPipelineDescriptor, StoreOp, TextureDescriptor, TextureDimension,
    TextureFormat, TextureUsages, VertexAttribute, VertexBufferLayout, VertexFormat, VertexState,
    VertexStepMode,
};

/// Side of the picture, pixels: rows of a copy are 256 bytes.
pub const SIDE: u32 = 256;

/// What a pixel holds that no triangle covers.
const SENTINEL: u8 = 255;

const SHADER: &str = "
@group(0) @binding(0) var<uniform> clip_from_stage: mat4x4<f32>;
@vertex fn vertex(@location(0) position: vec3<f32>) -> @builtin(position) vec4<f32> {
    return clip_from_stage * vec4(position, 1.0);
}
@fragment fn fragment() -> @location(0) vec4<f32> {
    return vec4(0.0);
}";

/// Draws what a run of the stage emitted, both sides, without depth.
pub struct Raster {
    pipeline: wgpu::RenderPipeline,
    target: wgpu::Texture,
    staging: wgpu::Buffer,
}

impl Raster {
    /// Makes pipeline and target.
    #[must_use]
    pub fn new(gpu: &Gpu) -> Self {
        let device = gpu.device();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("cover"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let pipeline = device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some("cover"),
            layout: None,
            vertex: VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[VertexBufferLayout {
                    array_stride: VERTEX_BYTES,
                    step_mode: VertexStepMode::Vertex,
                    attributes: &[VertexAttribute {
                        format: VertexFormat::Float32x3,
                        offset: 0,
                        shader_location: 0,
                    }],
                }],
            },
            fragment: Some(FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &[Some(TextureFormat::R8Unorm.into())],
            }),
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            multiview_mask: None,
            cache: None,
        });
        let target = device.create_texture(&TextureDescriptor {
            label: Some("cover"),
            size: Extent3d {
                width: SIDE,
                height: SIDE,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format: TextureFormat::R8Unorm,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let staging = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("cover"),
            size: u64::from(SIDE * SIDE),
            usage: BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Self {
            pipeline,
            target,
            staging,
        }
    }

    /// Pixels that the triangles of the last run leave uncovered; the matrix column by column.
    ///
    /// # Errors
    /// If the picture does not come back.
    pub fn uncovered(
        &self,
        gpu: &Gpu,
        run: &StageRun<'_>,
        clip_from_stage: &[f32; 16],
    ) -> Result<usize, GpuError> {
        use wgpu::util::{BufferInitDescriptor, DeviceExt};
        let device = gpu.device();
        let matrix = device.create_buffer_init(&BufferInitDescriptor {
            label: None,
            contents: cast_slice(clip_from_stage),
            usage: BufferUsages::UNIFORM,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: matrix.as_entire_binding(),
            }],
        });
        let view = self.target.create_view(&Default::default());
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: None,
            color_attachments: &[Some(RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: Operations {
                    load: LoadOp::Clear(wgpu::Color::WHITE),
                    store: StoreOp::Store,
                },
            })],
            depth_stencil_attachment: None,
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.set_vertex_buffer(0, run.vertices.slice(..));
        pass.set_index_buffer(run.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed_indirect(run.pools().work, 0);
        drop(pass);
        encoder.copy_texture_to_buffer(
            self.target.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.staging,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(SIDE),
                    rows_per_image: None,
                },
            },
            self.target.size(),
        );
        gpu.queue().submit([encoder.finish()]);
        let pixels = gpu.read(&self.staging)?;
        Ok(pixels.iter().filter(|pixel| **pixel == SENTINEL).count())
    }
}
