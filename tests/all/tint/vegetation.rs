//! What grows is drawn by pipelines that depend on the view and on which shapes there are: what they ask for is seen in
//! frames that are drawn.

use std::sync::Arc;

use bevy::app::App;
use bevy::camera::{Hdr, RenderTarget};
use bevy::core_pipeline::prepass::{
    DeferredPrepass, DepthPrepass, MotionVectorPrepass, NormalPrepass,
};
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{PipelineCache, PipelineDescriptor, TextureFormat};
use bevy::shader::ShaderDefVal;
use dolomite::ground::{GroundMaterial, TerrainView};
use dolomite::terrain::{GroundRect, Layer, Source, Terrain, TerrainData};
use dolomite::vegetation::{Kinds, Shape, Vegetation, VegetationRanks, VegetationView};

use super::variants::Variant;

/// Grows every shape in views of each sort, with shadows, and gives what was asked for.
pub fn draw(app: &mut App) -> Vec<Variant> {
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 100.0),
        layers: vec![Layer {
            source: Source::Fractal(dolomite::terrain::Fractal::default()),
            mask: None,
        }],
        base: 20.0,
        sea_level: None,
    });
    // Trees and rocks are drawn by Bevy.
    let mut kinds = Kinds::small_set();
    kinds
        .kinds
        .retain(|kind| !matches!(kind.shape, Shape::Mesh(_)));
    for kind in &mut kinds.kinds {
        kind.keeps_off.clear();
    }
    let world = app.world_mut();
    world.spawn((
        terrain.expect("in range"),
        GroundMaterial::default(),
        Vegetation {
            kinds: Arc::new(kinds),
            density: 0.01,
            ..default()
        },
    ));
    let sun = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    world.spawn((sun, Transform::default().looking_to(Vec3::NEG_ONE, Vec3::Y)));
    let cameras: Vec<Entity> = (0..4)
        .map(|order| {
            let target = Image::new_target_texture(16, 16, TextureFormat::Rgba8UnormSrgb, None);
            let target = world.resource_mut::<Assets<Image>>().add(target);
            let mut camera = world.spawn((
                Camera3d::default(),
                Camera { order, ..default() },
                (Msaa::Off, Hdr, TerrainView, VegetationView),
                (DeferredPrepass, DepthPrepass),
                RenderTarget::Image(target.into()),
                Transform::from_xyz(0.0, 80.0, 0.0).looking_to(Vec3::NEG_Y, Vec3::X),
            ));
            if order == 0 {
                camera.insert(VegetationRanks);
            }
            if order % 2 == 1 {
                camera.insert(NormalPrepass);
            }
            if order >= 2 {
                camera.insert(MotionVectorPrepass);
            }
            camera.id()
        })
        .collect();
    let mut variants = Vec::new();
    for _ in 0..30 {
        app.update();
        variants = asked(app);
        if variants.len() >= MOST {
            break;
        }
    }
    for camera in cameras {
        app.world_mut().despawn(camera);
    }
    assert!(variants.len() >= MOST, "{} variants", variants.len());
    variants
}

/// Three files of passes; three levels of detail of blades, two of flowers and three of chains in four sorts of views, and
/// for their ranks; and shadows.
const MOST: usize = 3 + 8 * 5 + 1;

/// The pipelines with a shader of vegetation.
fn asked(app: &App) -> Vec<Variant> {
    let shaders = app.world().resource::<Assets<Shader>>();
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    let mut variants: Vec<Variant> = Vec::new();
    for pipeline in cache.pipelines() {
        let (shader, defs): (_, &[ShaderDefVal]) = match &pipeline.descriptor {
            PipelineDescriptor::RenderPipelineDescriptor(descriptor) => {
                (&descriptor.vertex.shader, &descriptor.vertex.shader_defs)
            }
            PipelineDescriptor::ComputePipelineDescriptor(descriptor) => {
                (&descriptor.shader, &descriptor.shader_defs)
            }
        };
        let Some(shader) = shaders.get(shader) else {
            continue;
        };
        let known = |variant: &Variant| variant.is(shader, defs);
        if shader.path.starts_with("vegetation/") && !variants.iter().any(known) {
            variants.push(Variant::new("what grows", shader, defs));
        }
    }
    variants
}
