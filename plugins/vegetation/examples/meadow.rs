//! A meadow in the wind: `cargo run --release -p dolomite_vegetation --example meadow`. `-- --shot FILE.png` takes a
//! picture without a window, of `--size 960,540`; `--eye X,HEIGHT,Z,AZIMUTH,ELEVATION` says from where, `--sun
//! AZIMUTH,ELEVATION` in what light, `--density 0` what it is without grass, `--kinds FILE` what grows, `--base -9` what grows
//! on the bed of a bay, from below its water.

#[path = "support/picture.rs"]
mod picture;

use std::sync::Arc;

use bevy::camera::Hdr;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite_ground::{GroundMaterial, GroundPlugin, TerrainView};
use dolomite_sky::{Sky, SkyPlugin};
use dolomite_terrain::{
    Fractal, GroundPoint, GroundRect, Layer, Source, Sum, Terrain, TerrainData,
};
use dolomite_vegetation::{Kinds, Vegetation, VegetationPlugin, VegetationView, Wind};

fn main() {
    picture::app()
        .add_plugins((GroundPlugin::default(), SkyPlugin, VegetationPlugin))
        .insert_resource(bevy::pbr::DefaultOpaqueRendererMethod::deferred())
        .add_systems(Startup, setup)
        .run();
}

/// Hills, what grows on them, light, and the eye.
pub fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) -> Result {
    let [base] = picture::numbers("--base").unwrap_or([60.0]);
    let hills = Fractal {
        sum: Sum::Fbm,
        seed: 11,
        amplitude: 16.0,
        wavelength: 240.0,
        octaves: 7,
        ..default()
    };
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 2000.0),
        layers: vec![Layer {
            source: Source::Fractal(hills),
            mask: None,
        }],
        base,
        sea_level: None,
    })?;
    let [x, above, z, azimuth, elevation] =
        picture::numbers("--eye").unwrap_or([0.0, 1.35, 0.0, 325.0, -7.0]);
    let ground = terrain
        .sample(GroundPoint::new(DVec2::new(x.into(), z.into())))
        .value;
    let [density] = picture::numbers("--density").unwrap_or([1.0]);
    let kinds = match picture::option("--kinds") {
        Some(path) => Kinds::parse(&std::fs::read_to_string(&path)?, path.as_ref())?,
        None => Kinds::small_set(),
    };
    commands.spawn((
        terrain,
        GroundMaterial::default(),
        Vegetation {
            kinds: Arc::new(kinds),
            density,
            ..default()
        },
        Wind::default(),
    ));
    commands.spawn(picture::sun());
    // Clockwise from north.
    let turn = Quat::from_euler(
        EulerRot::YXZ,
        -azimuth.to_radians(),
        elevation.to_radians(),
        0.0,
    );
    let mut camera = commands.spawn((
        Camera3d::default(),
        Msaa::Off,
        Hdr,
        Tonemapping::AgX,
        TerrainView,
        VegetationView,
        Transform::from_xyz(x, ground + above, z).with_rotation(turn),
    ));
    if base > 0.0 {
        camera.insert(Sky::default());
        return Ok(());
    }
    // Under water: light that is scattered on the way, and a surface that is bright from below.
    camera.insert(DistanceFog {
        color: Color::linear_rgb(0.02, 0.11, 0.12),
        falloff: FogFalloff::from_visibility(45.0),
        ..default()
    });
    commands.insert_resource(ClearColor(Color::linear_rgb(0.02, 0.11, 0.12)));
    let surface = StandardMaterial {
        base_color: Color::linear_rgba(0.25, 0.5, 0.5, 0.7),
        unlit: true,
        alpha_mode: AlphaMode::Blend,
        cull_mode: None,
        ..default()
    };
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(600.0, 600.0))),
        MeshMaterial3d(materials.add(surface)),
    ));
    Ok(())
}
