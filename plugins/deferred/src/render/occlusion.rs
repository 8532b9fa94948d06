//! The passes of ambient occlusion: one that looks around each pixel, one that takes the mean.

use bevy::math::UVec2;
use bevy::render::diagnostic::{DiagnosticsRecorder, RecordDiagnostics};
use bevy::render::render_resource::binding_types::{
    texture_2d, texture_depth_2d, texture_storage_2d, uniform_buffer, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries, BindingResource, Buffer,
    BufferInitDescriptor, BufferUsages, CommandEncoder, ComputePassDescriptor, ComputePipeline,
    ComputePipelineDescriptor, Extent3d, PipelineCache, ShaderStages, StorageTextureAccess,
    TextureDescriptor, TextureDimension, TextureFormat, TextureSampleType, TextureUsages,
    TextureView,
};
use bevy::render::renderer::RenderDevice;
use bevy::render::texture::{CachedTexture, TextureCache};
use bevy::render::view::ViewUniform;
use bytemuck::{Pod, Zeroable};

use super::shaders::Shaders;
use crate::occlusion::{AmbientOcclusion, OcclusionResolution};

/// `Settings` in `shaders/src/deferred/occlusion.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Uniform {
    /// Metres.
    pub radius: f32,
    /// Metres.
    pub thickness: f32,
    /// Pixels.
    pub most_pixels: f32,
    /// Pixels of the view on a side of one that is looked from.
    pub scale: i32,
    /// A pixel.
    pub slices: u32,
    /// On each side of a slice.
    pub steps: u32,
    /// To 32 bytes.
    pub pad: [u32; 2],
}

impl Uniform {
    /// Of a component; `None` where there is nothing to find.
    #[must_use]
    pub fn new(occlusion: &AmbientOcclusion) -> Option<Self> {
        let settings = occlusion.settings()?;
        Some(Self {
            radius: settings.radius,
            thickness: settings.thickness,
            most_pixels: settings.most_pixels,
            scale: match occlusion.resolution {
                OcclusionResolution::Full => 1,
                OcclusionResolution::Half => 2,
            },
            slices: settings.slices,
            steps: settings.steps,
            pad: [0; 2],
        })
    }
}

/// What a view has for it.
pub struct ViewOcclusion {
    uniform: Uniform,
    buffer: Buffer,
    size: UVec2,
    traced: CachedTexture,
    /// The share of the light from everywhere that reaches each pixel of the view.
    pub visible: CachedTexture,
}

impl ViewOcclusion {
    /// For a view of `size` pixels, both above 0; the buffer of the last frame is kept where it still serves.
    pub fn new(
        uniform: Uniform,
        size: UVec2,
        last: Option<Self>,
        device: &RenderDevice,
        textures: &mut TextureCache,
    ) -> Self {
        let last = last.filter(|last| last.uniform == uniform);
        let buffer = last.map_or_else(
            || {
                device.create_buffer_with_data(&BufferInitDescriptor {
                    label: Some("dolomite_deferred_occlusion"),
                    contents: bytemuck::bytes_of(&uniform),
                    usage: BufferUsages::UNIFORM,
                })
            },
            |last| last.buffer,
        );
        let mut texture = |label, size: UVec2, format| {
            let descriptor = TextureDescriptor {
                label: Some(label),
                size: Extent3d {
                    width: size.x,
                    height: size.y,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format,
                usage: TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            };
            textures.get(device, descriptor)
        };
        let cells = (size + uniform.scale as u32 - 1) / uniform.scale as u32;
        Self {
            uniform,
            buffer,
            size,
            traced: texture("dolomite_deferred_traced", cells, TextureFormat::Rg32Float),
            visible: texture("dolomite_deferred_visible", size, TextureFormat::R32Float),
        }
    }

    /// What it was made for.
    #[must_use]
    pub const fn uniform(&self) -> Uniform {
        self.uniform
    }

    /// Of its textures and its buffer.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let texels = |texture: &CachedTexture| {
            u64::from(texture.texture.width()) * u64::from(texture.texture.height())
        };
        8 * texels(&self.traced) + 4 * texels(&self.visible) + self.buffer.size()
    }
}

/// The layout of a pass: the one that looks around, or the one that takes the mean.
#[must_use]
pub fn layout(filter: bool) -> BindGroupLayoutDescriptor {
    let common = (
        uniform_buffer::<ViewUniform>(true),
        uniform_buffer_sized(false, None),
        texture_depth_2d(),
        texture_2d(TextureSampleType::Uint),
    );
    let write = |format| texture_storage_2d(format, StorageTextureAccess::WriteOnly);
    let entries = if filter {
        BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                common.0,
                common.1,
                common.2,
                common.3,
                texture_2d(TextureSampleType::Float { filterable: false }),
                write(TextureFormat::R32Float),
            ),
        )
        .to_vec()
    } else {
        BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                common.0,
                common.1,
                common.2,
                common.3,
                write(TextureFormat::Rg32Float),
            ),
        )
        .to_vec()
    };
    BindGroupLayoutDescriptor::new("dolomite_deferred_occlusion", &entries)
}

/// Both pipelines.
#[must_use]
pub fn pipelines(shaders: &Shaders) -> [ComputePipelineDescriptor; 2] {
    [false, true].map(|filter| ComputePipelineDescriptor {
        label: Some("dolomite_deferred_occlusion".into()),
        layout: vec![layout(filter)],
        shader: if filter {
            shaders.occlusion_filter.clone()
        } else {
            shaders.occlusion_trace.clone()
        },
        entry_point: Some(if filter { "filter_pixels" } else { "trace" }.into()),
        ..Default::default()
    })
}

/// What is recorded for a view.
pub struct Recording<'a> {
    /// Its textures.
    pub occlusion: &'a ViewOcclusion,
    /// The one that looks around, and the one that takes the mean.
    pub pipelines: [&'a ComputePipeline; 2],
    /// Of the G-buffer.
    pub depths: &'a TextureView,
    /// Its words.
    pub words: &'a TextureView,
    /// The uniforms of all views.
    pub views: BindingResource<'a>,
    /// Of this view in them.
    pub offset: u32,
}

/// Both passes.
pub fn record(
    recording: &Recording<'_>,
    device: &RenderDevice,
    cache: &PipelineCache,
    diagnostics: Option<&DiagnosticsRecorder>,
    encoder: &mut CommandEncoder,
) {
    let occlusion = recording.occlusion;
    let uniform = occlusion.buffer.as_entire_binding();
    let trace = device.create_bind_group(
        "dolomite_deferred_occlusion",
        &cache.get_bind_group_layout(&layout(false)),
        &BindGroupEntries::sequential((
            recording.views.clone(),
            uniform.clone(),
            recording.depths,
            recording.words,
            &occlusion.traced.default_view,
        )),
    );
    let filter = device.create_bind_group(
        "dolomite_deferred_occlusion",
        &cache.get_bind_group_layout(&layout(true)),
        &BindGroupEntries::sequential((
            recording.views.clone(),
            uniform,
            recording.depths,
            recording.words,
            &occlusion.traced.default_view,
            &occlusion.visible.default_view,
        )),
    );
    let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
        label: Some("dolomite_deferred_occlusion"),
        timestamp_writes: None,
    });
    let span = diagnostics.pass_span(&mut pass, "dolomite_deferred_occlusion");
    let scale = occlusion.uniform.scale as u32;
    let sizes = [(occlusion.size + scale - 1) / scale, occlusion.size];
    for ((group, pipeline), size) in [trace, filter].iter().zip(recording.pipelines).zip(sizes) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[recording.offset]);
        pass.dispatch_workgroups(size.x.div_ceil(8), size.y.div_ceil(8), 1);
    }
    span.end(&mut pass);
}
