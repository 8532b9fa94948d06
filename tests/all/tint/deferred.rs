//! Deferred lighting takes the definitions of Bevy's own lighting pass, which depend on the view: what it asks for is
//! seen in frames that are drawn.

use bevy::app::App;
use bevy::camera::{Hdr, RenderTarget};
use bevy::core_pipeline::prepass::{MotionVectorPrepass, NormalPrepass};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{PipelineCache, PipelineDescriptor, TextureFormat};
use dolomite::deferred::{AmbientOcclusion, BlinnPhongMaterial, DeferredLighting, Way};

use super::variants::Variant;

const WAYS: [Way; 4] = [Way::BruteForce, Way::Tiled, Way::Volumes, Way::Auto];

/// Lights a sphere of each material by each way, in targets of both sorts, and gives what was asked for.
pub fn draw(app: &mut App) -> Vec<Variant> {
    let world = app.world_mut();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Sphere::new(1.0));
    let shiny = world
        .resource_mut::<Assets<BlinnPhongMaterial>>()
        .add(BlinnPhongMaterial::default());
    world.spawn((
        Mesh3d(mesh),
        MeshMaterial3d(shiny),
        Transform::from_xyz(0.0, 0.0, -4.0),
    ));
    for place in [Vec3::Y, Vec3::X] {
        world.spawn((PointLight::default(), Transform::from_translation(place)));
        let down = Transform::from_translation(place).looking_to(Vec3::NEG_Y, Vec3::X);
        world.spawn((SpotLight::default(), down));
    }
    for (order, way) in (0..).zip(WAYS) {
        let target = Image::new_target_texture(16, 16, TextureFormat::Rgba8UnormSrgb, None);
        let target = world.resource_mut::<Assets<Image>>().add(target);
        let mut camera = world.spawn((
            Camera3d::default(),
            Camera { order, ..default() },
            DeferredLighting { way },
            RenderTarget::Image(target.into()),
        ));
        if order % 2 == 1 {
            camera.insert((Hdr, NormalPrepass, MotionVectorPrepass));
        }
        if order >= 2 {
            camera.insert(AmbientOcclusion::default());
        }
    }
    for _ in 0..10 {
        app.update();
    }
    let variants = asked(app);
    // The lists, both hulls in their view, writing with and without normals and motion, three ways of lighting, and both
    // passes of ambient occlusion.
    assert!(variants.len() >= 9, "{} variants", variants.len());
    variants
}

/// The pipelines with a fragment or compute shader of ours.
fn asked(app: &App) -> Vec<Variant> {
    let shaders = app.world().resource::<Assets<Shader>>();
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    let mut variants: Vec<Variant> = Vec::new();
    for pipeline in cache.pipelines() {
        let (shader, defs) = match &pipeline.descriptor {
            PipelineDescriptor::RenderPipelineDescriptor(descriptor) => {
                let Some(fragment) = &descriptor.fragment else {
                    continue;
                };
                (&fragment.shader, &fragment.shader_defs)
            }
            PipelineDescriptor::ComputePipelineDescriptor(descriptor) => {
                (&descriptor.shader, &descriptor.shader_defs)
            }
        };
        let Some(shader) = shaders.get(shader) else {
            continue;
        };
        let known = |variant: &Variant| variant.is(shader, defs);
        if shader.path.starts_with("deferred/") && !variants.iter().any(known) {
            variants.push(Variant::new("deferred lighting", shader, defs));
        }
    }
    variants
}
