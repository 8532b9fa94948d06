//! An island, drawn in an app with nothing of Dolomite but the ground: no file, no setting.
//! `cargo run --release -p dolomite_ground --example ground`.

use bevy::light::light_consts::lux;
use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite_ground::{GroundMaterial, GroundPlugin, Sea, TerrainView};
use dolomite_terrain::{Fractal, GroundRect, Hill, Layer, Source, Sum, Terrain, TerrainData};

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, GroundPlugin::default()))
        .insert_resource(ClearColor(Color::srgb(0.55, 0.70, 0.86)))
        .add_systems(Startup, setup)
        .run()
}

/// The island, the sun, and a camera that sees the island.
pub fn setup(mut commands: Commands) -> Result {
    let layer = |source| Layer { source, mask: None };
    let island = Hill {
        centre: DVec2::ZERO,
        radius: 2600.0,
        height: 1000.0,
    };
    let ridges = Fractal {
        sum: Sum::Ridged,
        seed: 5,
        amplitude: 550.0,
        ..default()
    };
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 8000.0),
        layers: vec![layer(Source::Hill(island)), layer(Source::Fractal(ridges))],
        base: -350.0,
        sea_level: Some(0.0),
    })?;
    commands.spawn((terrain, GroundMaterial::default(), Sea::default()));
    let sun = DirectionalLight {
        illuminance: lux::AMBIENT_DAYLIGHT,
        shadow_maps_enabled: true,
        ..default()
    };
    commands.spawn((
        sun,
        Transform::default().looking_to(Vec3::new(-2.0, -1.2, -1.0), Vec3::Y),
    ));
    let eye =
        Transform::from_xyz(2600.0, 900.0, 2600.0).looking_at(Vec3::new(0.0, 250.0, 0.0), Vec3::Y);
    commands.spawn((Camera3d::default(), Msaa::Off, TerrainView, eye));
    Ok(())
}
