//! An island of noise, its triangles chosen by the terrain LOD, beside a displaced sphere of your own, whose patches
//! the tessellation stage divides: both share the G-buffer and the shadows.
//! `cargo run --release --example terrain`.

mod support;

use std::sync::Arc;

use bevy::light::CascadeShadowConfigBuilder;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use dolomite::DolomitePlugins;
use dolomite::ground::{GroundMaterial, GroundTextures, MaterialBands, Sea, TerrainView};
use dolomite::terrain::{
    Fractal, Ground, GroundRect, Hill, Layer, Source, Sum, Terrain, TerrainData,
};
use dolomite::tessellation::render::{PatchKind, PatchPlugin, PatchShader};
use dolomite::tessellation::{PatchLayout, Patches, shapes};

/// A boulder that stands on the island.
#[derive(Resource, AsBindGroup, Clone)]
pub struct Boulder {}

impl PatchKind for Boulder {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;
    const UV_RANGE: f32 = 2.0;
    const CUSTOM_MATERIAL: bool = true;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/rock.wgsl")
    }
}

fn main() {
    support::app("Terrain")
        .add_plugins((DolomitePlugins, PatchPlugin(Boulder {})))
        .insert_resource(ClearColor(Color::srgb(0.42, 0.60, 0.80)))
        .add_systems(Startup, setup)
        .run();
}

fn setup(mut commands: Commands, assets: Res<AssetServer>) -> Result {
    let relief = Fractal {
        sum: Sum::Eroded,
        octaves: 10,
        amplitude: 75.0,
        wavelength: 330.0,
        ..default()
    };
    let dome = Hill {
        centre: DVec2::ZERO,
        radius: 560.0,
        height: 150.0,
    };
    let layer = |source| Layer { source, mask: None };
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 6000.0),
        layers: vec![layer(Source::Hill(dome)), layer(Source::Fractal(relief))],
        base: -78.0,
        sea_level: Some(0.0),
    })?;
    let textures = GroundTextures {
        albedo_height: assets.load("textures/terrain_albedo_height.png"),
        normal_roughness: assets.load("textures/terrain_normal_roughness.png"),
    };
    let material = GroundMaterial::from(MaterialBands {
        tree_line: 62.0,
        snow_line: 92.0,
        blend: 16.0,
        ..default()
    });
    // Half of it in the ground.
    let place = DVec2::new(60.0, 230.0);
    let height = terrain.height(place) as f32;
    let boulder = Patches::<Boulder>::new(Arc::new(shapes::octahedron(4)));
    commands.spawn((
        boulder.with(0, Vec4::new(0.0, 0.14, 1.4, 0.0)),
        Transform::from_xyz(place.x as f32, height + 4.0, place.y as f32)
            .with_scale(Vec3::splat(16.0)),
    ));
    commands.spawn((terrain, material, textures, Sea::default()));
    let cascades = CascadeShadowConfigBuilder {
        first_cascade_far_bound: 120.0,
        maximum_distance: 1200.0,
        ..default()
    };
    commands.spawn((support::light(60_000.0, 2_200.0), cascades.build()));
    let circle = support::Circle {
        centre: Vec3::new(0.0, 35.0, 60.0),
        distance: 460.0,
        yaw: 0.25,
        pitch: 0.2,
    };
    commands.spawn((support::camera(circle, 6.0, 13.4), TerrainView));
    Ok(())
}
