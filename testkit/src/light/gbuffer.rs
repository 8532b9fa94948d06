//! The words of the G-buffer, back from the adapter.

use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::render_resource::binding_types::{
    storage_buffer_sized, texture_2d, texture_depth_2d,
};
use bevy::render::render_resource::{
    BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries, Buffer, BufferDescriptor,
    BufferUsages, CachedComputePipelineId, CommandEncoderDescriptor, ComputePassDescriptor,
    ComputePipelineDescriptor, MapMode, PipelineCache, PollType, ShaderStages, TextureSampleType,
};
use bevy::render::renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery};
use bevy::render::{RenderApp, RenderStartup};
use bevy::shader::Shader;
use bytemuck::{Pod, Zeroable};

/// A pixel of the G-buffer.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Pixel {
    /// As `dolomite_deferred::gbuffer` describes them.
    pub words: [u32; 4],
    /// 1 on the near plane, 0 at infinity.
    pub depth: f32,
    /// The lighting id; 0 is not lit.
    pub id: u32,
}

const COPY: &str = "
@group(0) @binding(0) var words: texture_2d<u32>;
@group(0) @binding(1) var depths: texture_depth_2d;
@group(0) @binding(2) var ids: texture_2d<u32>;
@group(0) @binding(3) var<storage, read_write> pixels: array<u32>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(words);
    if any(id.xy >= size) { return; }
    let at = 6u * (id.y * size.x + id.x);
    let place = vec2<i32>(id.xy);
    let word = textureLoad(words, place, 0);
    for (var k = 0u; k < 4u; k++) { pixels[at + k] = word[k]; }
    pixels[at + 4u] = bitcast<u32>(textureLoad(depths, place, 0));
    pixels[at + 5u] = textureLoad(ids, place, 0).r;
}
";

/// Copies the G-buffer of each frame; of several cameras, the last one's.
pub struct GBufferPlugin;

#[derive(Resource, Clone)]
struct CopyShader(Handle<Shader>);

#[derive(Resource)]
struct Copy {
    layout: BindGroupLayoutDescriptor,
    pipeline: CachedComputePipelineId,
    last: Option<Buffer>,
}

impl Plugin for GBufferPlugin {
    fn build(&self, app: &mut App) {
        let shader = Shader::from_wgsl(COPY, "copy_gbuffer.wgsl");
        let shader = app.world_mut().resource_mut::<Assets<Shader>>().add(shader);
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app
            .insert_resource(CopyShader(shader))
            .add_systems(RenderStartup, start)
            .add_systems(
                Core3d,
                copy.after(Core3dSystems::Prepass)
                    .before(Core3dSystems::MainPass),
            );
    }
}

fn start(mut commands: Commands, shader: Res<CopyShader>, cache: Res<PipelineCache>) {
    let layout = BindGroupLayoutDescriptor::new(
        "copy_gbuffer",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                texture_2d(TextureSampleType::Uint),
                texture_depth_2d(),
                texture_2d(TextureSampleType::Uint),
                storage_buffer_sized(false, None),
            ),
        ),
    );
    let pipeline = cache.queue_compute_pipeline(ComputePipelineDescriptor {
        label: Some("copy_gbuffer".into()),
        layout: vec![layout.clone()],
        shader: shader.0.clone(),
        entry_point: Some("main".into()),
        ..default()
    });
    commands.insert_resource(Copy {
        layout,
        pipeline,
        last: None,
    });
}

fn copy(
    view: ViewQuery<(&ExtractedCamera, &ViewPrepassTextures)>,
    cache: Res<PipelineCache>,
    mut copy: ResMut<Copy>,
    mut ctx: RenderContext,
) {
    let (_, textures) = view.into_inner();
    let (Some(words), Some(depths), Some(ids), Some(pipeline)) = (
        textures.deferred.as_ref(),
        textures.depth_view(),
        textures.deferred_lighting_pass_id.as_ref(),
        cache.get_compute_pipeline(copy.pipeline),
    ) else {
        return;
    };
    let size = textures.size;
    let pixels = ctx.render_device().create_buffer(&BufferDescriptor {
        label: Some("copy_gbuffer"),
        size: u64::from(size.width) * u64::from(size.height) * size_of::<Pixel>() as u64,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let group = ctx.render_device().create_bind_group(
        "copy_gbuffer",
        &cache.get_bind_group_layout(&copy.layout),
        &BindGroupEntries::sequential((
            &words.texture.default_view,
            depths,
            &ids.texture.default_view,
            pixels.as_entire_buffer_binding(),
        )),
    );
    let mut pass = ctx
        .command_encoder()
        .begin_compute_pass(&ComputePassDescriptor::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(size.width.div_ceil(8), size.height.div_ceil(8), 1);
    drop(pass);
    copy.last = Some(pixels);
}

/// The G-buffer of the last frame, rows from the top; empty if there was none.
///
/// # Panics
/// If the device is lost.
#[must_use]
pub fn pixels(app: &App) -> Vec<Pixel> {
    let world = app.sub_app(RenderApp).world();
    let Some(buffer) = world
        .get_resource::<Copy>()
        .and_then(|copy| copy.last.clone())
    else {
        return Vec::new();
    };
    let device = app.world().resource::<RenderDevice>();
    let back = device.create_buffer(&BufferDescriptor {
        label: Some("copy_gbuffer_back"),
        size: buffer.size(),
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(&buffer, 0, &back, 0, buffer.size());
    app.world()
        .resource::<RenderQueue>()
        .submit([encoder.finish()]);
    back.slice(..).map_async(MapMode::Read, |result| {
        result.expect("the buffer can be mapped")
    });
    device
        .poll(PollType::wait_indefinitely())
        .expect("the device is there");
    let bytes = back.slice(..).get_mapped_range().to_vec();
    bytemuck::pod_collect_to_vec(&bytes)
}
