//! Ground that is edited while it is drawn: a crater a second, and every fifth second one is taken back.
//! `cargo run --release -p dolomite_ground --example edits`.

use std::time::Duration;

use bevy::light::light_consts::lux;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::time::common_conditions::on_timer;
use dolomite_ground::{GroundMaterial, GroundPlugin, TerrainView};
use dolomite_terrain::{
    Edit, EditKind, Fractal, GroundRect, Layer, Source, Terrain, TerrainData, TerrainEdits,
};

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, GroundPlugin::default()))
        .insert_resource(ClearColor(Color::srgb(0.55, 0.70, 0.86)))
        .add_systems(Startup, setup)
        .add_systems(Update, dig.run_if(on_timer(Duration::from_secs(1))))
        .run()
}

/// Rolling ground, its history, the sun and a camera.
pub fn setup(mut commands: Commands) -> Result {
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 2000.0),
        layers: vec![Layer {
            source: Source::Fractal(Fractal::default()),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    })?;
    let edits = TerrainEdits::new(&terrain)?;
    commands.spawn((terrain, edits, GroundMaterial::default()));
    let sun = DirectionalLight {
        illuminance: lux::AMBIENT_DAYLIGHT,
        ..default()
    };
    let low = Transform::default().looking_to(Vec3::new(-2.0, -1.2, -1.0), Vec3::Y);
    commands.spawn((sun, low));
    let eye = Transform::from_xyz(0.0, 320.0, 420.0).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((Camera3d::default(), Msaa::Off, TerrainView, eye));
    Ok(())
}

/// The next crater, or one less.
pub fn dig(ground: Single<(&mut Terrain, &mut TerrainEdits)>, mut count: Local<u32>) -> Result {
    let (mut terrain, mut edits) = ground.into_inner();
    *count += 1;
    if count.is_multiple_of(5) {
        if let Some(before) = edits.undo(&terrain) {
            *terrain = before;
        }
        return Ok(());
    }
    let crater = Edit {
        kind: EditKind::Lower,
        place: DVec2::from_angle(f64::from(*count) * 2.4) * 12.0 * f64::from(*count).sqrt(),
        radius: 20.0,
        strength: 6.0,
        falloff: 0.8,
    };
    *terrain = edits.apply(&terrain, &crater)?.terrain;
    Ok(())
}
