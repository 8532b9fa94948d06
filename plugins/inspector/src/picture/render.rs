//! The pass that draws a picture over a view, in the render world.

use bevy::core_pipeline::prepass::{
    BackgroundMotionVectorsBindGroup, BackgroundMotionVectorsPipelineId, MotionVectorPrepass,
    ViewPrepassTextures,
};
use bevy::core_pipeline::upscaling::upscaling;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::binding_types::uniform_buffer;
use bevy::render::render_resource::{
    BindGroupEntry, BindGroupLayoutDescriptor, BindGroupLayoutEntries, BindingResource,
    CachedRenderPipelineId, ColorTargetState, ColorWrites, FragmentState, IntoBinding, LoadOp,
    Operations, PipelineCache, RenderPassColorAttachment, RenderPassDescriptor,
    RenderPipelineDescriptor, ShaderStages, ShaderType, StoreOp, TextureFormat, UniformBuffer,
    VertexState,
};
use bevy::render::renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery};
use bevy::render::view::{ExtractedView, ViewTarget};
use bevy::render::{Extract, ExtractSchedule, MainWorld, Render, RenderSystems};

use super::equip::Shown;
use super::source::{Found, Marks, Source, Way, own_pictures};
use super::{FramePicture, PicturePasses};

/// `Look` in `shaders/src/inspector/picture.wgsl`.
#[derive(ShaderType, Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Look {
    to_z: Vec4,
    to_w: Vec4,
    viewport: Vec4,
    near: f32,
    far: f32,
    fastest: f32,
    most: f32,
    pyramid_level: u32,
    difference: f32,
}

impl Look {
    /// Numbers that would divide by 0, or are none, are those of the default.
    fn new(settings: &FramePicture, view: &ExtractedView) -> Self {
        let usual = FramePicture::default();
        let above = |value: f32, usual: f32| {
            if value.is_finite() && value > 0.0 {
                value
            } else {
                usual
            }
        };
        let near = above(settings.near, usual.near);
        let far = above(settings.far, usual.far);
        let from_clip = view.clip_from_view.inverse();
        Self {
            to_z: from_clip.row(2),
            to_w: from_clip.row(3),
            viewport: view.viewport.as_vec4(),
            near,
            far: if far > near { far } else { 2.0 * near },
            fastest: above(settings.fastest, usual.fastest),
            most: above(settings.most, usual.most),
            pyramid_level: settings.level,
            difference: above(settings.difference, usual.difference),
        }
    }
}

/// The system set in `Core3d` that draws pictures, behind post-processing. An app that draws its own UI over a 3D camera
/// orders it: what comes before is covered.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FramePictureSystems;

/// What a pipeline differs by.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Key {
    define: &'static str,
    source: &'static str,
    many_samples: bool,
    format: TextureFormat,
}

#[derive(Resource, Default)]
struct Pipelines(HashMap<Key, CachedRenderPipelineId>);

/// What is drawn over a view.
#[derive(Component)]
struct ViewPicture {
    way: Way,
    many_samples: bool,
    pipeline: CachedRenderPipelineId,
    look: UniformBuffer<Look>,
}

pub(super) fn build(render_app: &mut SubApp, passes: PicturePasses) {
    render_app
        .insert_resource(passes)
        .init_resource::<Pipelines>()
        .add_systems(ExtractSchedule, extract.run_if(is_shown))
        .add_systems(
            Render,
            (
                prepare.run_if(resource_exists::<Shown>),
                mend.run_if(resource_exists::<Shown>),
                (clear, mend).run_if(resource_removed::<Shown>),
            )
                .in_set(RenderSystems::PrepareResources),
        )
        .add_systems(
            Core3d,
            show.run_if(resource_exists::<Shown>)
                .in_set(FramePictureSystems)
                .after(Core3dSystems::PostProcess)
                .before(upscaling),
        );
}

/// Whether something is, or was in the last frame.
fn is_shown(main: Res<MainWorld>, ours: Option<Res<Shown>>) -> bool {
    ours.is_some() || main.contains_resource::<Shown>()
}

/// Takes over what is shown, where that is new.
fn extract(mut commands: Commands, theirs: Extract<Option<Res<Shown>>>, ours: Option<Res<Shown>>) {
    match (&*theirs, ours) {
        (Some(theirs), ours) if ours.is_none() || theirs.is_changed() => {
            commands.insert_resource(Shown::clone(theirs));
        }
        (None, Some(_)) => commands.remove_resource::<Shown>(),
        _ => {}
    }
}

fn clear(mut commands: Commands, views: Query<Entity, With<ViewPicture>>) {
    for view in &views {
        commands.entity(view).remove::<ViewPicture>();
    }
}

/// Takes from views without motion vectors the pipeline that Bevy draws those of the background with: Bevy 0.19 leaves it
/// on a camera whose `MotionVectorPrepass` is removed, draws it without a target, and rendering stops.
fn mend(
    mut commands: Commands,
    views: Query<
        Entity,
        (
            With<BackgroundMotionVectorsPipelineId>,
            Without<MotionVectorPrepass>,
        ),
    >,
) {
    for view in &views {
        commands.entity(view).remove::<(
            BackgroundMotionVectorsPipelineId,
            BackgroundMotionVectorsBindGroup,
        )>();
    }
}

fn prepare(
    mut commands: Commands,
    shown: Res<Shown>,
    cache: Res<PipelineCache>,
    mut pipelines: ResMut<Pipelines>,
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
    mut views: Query<
        (
            Entity,
            &ExtractedView,
            &Msaa,
            &ViewPrepassTextures,
            Option<&mut ViewPicture>,
        ),
        With<ExtractedCamera>,
    >,
) {
    for (entity, view, msaa, prepass, last) in &mut views {
        let has = |way: &&Way| match way.source {
            Source::Words => prepass.deferred.is_some(),
            Source::Depth => prepass.depth.is_some(),
            Source::Normals => prepass.normal.is_some(),
            Source::Motion => prepass.motion_vectors.is_some(),
            // Those are made later in the frame.
            Source::Texture(_) | Source::Layers(..) | Source::Buffer(_) => true,
        };
        let Some(way) = shown.picture.ways.iter().find(has).copied() else {
            commands.entity(entity).remove::<ViewPicture>();
            continue;
        };
        let many_samples = way.source.follows_samples() && msaa.samples() > 1;
        let key = Key {
            define: way.define,
            source: way.source.define(),
            many_samples,
            format: view.target_format,
        };
        let pipeline = *pipelines
            .0
            .entry(key)
            .or_insert_with(|| cache.queue_render_pipeline(descriptor(&key, &way, &shown)));
        let look = Look::new(&shown.settings, view);
        if let Some(mut last) = last {
            if *last.look.get() != look {
                last.look.set(look);
                last.look.write_buffer(&device, &queue);
            }
            (last.way, last.many_samples, last.pipeline) = (way, many_samples, pipeline);
            continue;
        }
        let mut look = UniformBuffer::from(look);
        look.set_label(Some("dolomite_picture"));
        look.write_buffer(&device, &queue);
        commands.entity(entity).insert(ViewPicture {
            way,
            many_samples,
            pipeline,
            look,
        });
    }
}

fn layout(way: &Way, many_samples: bool) -> BindGroupLayoutDescriptor {
    let look = uniform_buffer::<Look>(false);
    let read = way.source.layout(many_samples);
    let (stages, label) = (ShaderStages::FRAGMENT, "dolomite_picture");
    if let Source::Layers(..) = way.source {
        let all = (look, read, uniform_buffer::<Marks>(false));
        BindGroupLayoutDescriptor::new(label, &BindGroupLayoutEntries::sequential(stages, all))
    } else {
        let both = (look, read);
        BindGroupLayoutDescriptor::new(label, &BindGroupLayoutEntries::sequential(stages, both))
    }
}

/// Definitions that the shader is compiled with.
fn definitions(
    define: &'static str,
    source: &'static str,
    many_samples: bool,
    encoded: bool,
) -> Vec<&'static str> {
    let mut all = vec![define, source];
    all.extend(many_samples.then_some("MANY_SAMPLES"));
    all.extend(encoded.then_some("ENCODED"));
    all
}

/// Every set of definitions that a pipeline of ours asks for: for checks that compile them all. `others` are the ways of
/// pictures that other plugins add.
#[must_use]
pub fn variants(others: &[Way]) -> Vec<Vec<&'static str>> {
    let own = own_pictures();
    let own = own.iter().flat_map(|picture| picture.ways.iter());
    let mut all = Vec::new();
    for way in own.chain(others) {
        for encoded in [false, true] {
            for many_samples in [false, way.source.follows_samples()] {
                let one = definitions(way.define, way.source.define(), many_samples, encoded);
                if !all.contains(&one) {
                    all.push(one);
                }
            }
        }
    }
    all
}

fn descriptor(key: &Key, way: &Way, shown: &Shown) -> RenderPipelineDescriptor {
    // A target without it keeps numbers as they are: half floats are linear, bytes are encoded.
    let encoded = !key.format.is_srgb()
        && matches!(
            key.format,
            TextureFormat::Rgba8Unorm | TextureFormat::Bgra8Unorm
        );
    let defines = definitions(key.define, key.source, key.many_samples, encoded);
    let defines: Vec<_> = defines.into_iter().map(Into::into).collect();
    RenderPipelineDescriptor {
        label: Some("dolomite_picture".into()),
        layout: vec![layout(way, key.many_samples)],
        vertex: VertexState {
            shader: shown.shader.clone(),
            shader_defs: defines.clone(),
            entry_point: Some("vertex".into()),
            ..default()
        },
        fragment: Some(FragmentState {
            shader: shown.shader.clone(),
            shader_defs: defines,
            entry_point: Some("fragment".into()),
            targets: vec![Some(ColorTargetState {
                format: key.format,
                blend: None,
                write_mask: ColorWrites::ALL,
            })],
        }),
        ..default()
    }
}

fn found(source: Source, view: EntityRef) -> Option<Found> {
    let prepass = view.get::<ViewPrepassTextures>();
    let attachment = match source {
        Source::Words => prepass?.deferred.as_ref(),
        Source::Depth => prepass?.depth.as_ref(),
        Source::Normals => prepass?.normal.as_ref(),
        Source::Motion => prepass?.motion_vectors.as_ref(),
        Source::Texture(get) | Source::Layers(get, _) => return get(view).map(Found::Texture),
        Source::Buffer(get) => return get(view).map(Found::Buffer),
    };
    Some(Found::Texture(attachment?.texture.default_view.clone()))
}

fn show(
    world: &World,
    view: ViewQuery<(Entity, &ExtractedCamera, &ViewTarget, &ViewPicture)>,
    (cache, queue): (Res<PipelineCache>, Res<RenderQueue>),
    passes: Res<PicturePasses>,
    mut ctx: RenderContext,
) {
    let (entity, camera, target, picture) = view.into_inner();
    let (Some(pipeline), Some(look), Some(found)) = (
        cache.get_render_pipeline(picture.pipeline),
        picture.look.binding(),
        found(picture.way.source, world.entity(entity)),
    ) else {
        return;
    };
    let read: BindingResource = match &found {
        Found::Texture(view) => view.into_binding(),
        Found::Buffer(buffer) => buffer.as_entire_binding(),
    };
    // What became of the layers is known when all views of lights are.
    let marks = match picture.way.source {
        Source::Layers(_, marks) => {
            let mut marks = UniformBuffer::from(marks(world, entity));
            marks.set_label(Some("dolomite_picture_marks"));
            marks.write_buffer(ctx.render_device(), &queue);
            Some(marks)
        }
        _ => None,
    };
    let marks = marks.as_ref().and_then(UniformBuffer::binding);
    let entries: Vec<_> = (0..)
        .zip([look, read].into_iter().chain(marks))
        .map(|(binding, resource)| BindGroupEntry { binding, resource })
        .collect();
    let group = ctx.render_device().create_bind_group(
        "dolomite_picture",
        &cache.get_bind_group_layout(&layout(&picture.way, picture.many_samples)),
        &entries,
    );
    passes.add();
    let diagnostics = ctx.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("dolomite_picture"),
        color_attachments: &[Some(RenderPassColorAttachment {
            view: target.main_texture_view(),
            depth_slice: None,
            resolve_target: None,
            ops: Operations {
                load: LoadOp::Load,
                store: StoreOp::Store,
            },
        })],
        depth_stencil_attachment: None,
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = diagnostics.pass_span(&mut pass, "dolomite_picture");
    if let Some(viewport) = &camera.viewport {
        pass.set_camera_viewport(viewport);
    }
    pass.set_render_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.draw(0..3, 0..1);
    span.end(&mut pass);
}
