//! A walk through a city: `cargo run --release -p dolomite_city --example city -- day` (or `dusk`, `night`).

use bevy::camera::{Exposure, Hdr};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::pbr::DefaultOpaqueRendererMethod;
use bevy::prelude::*;
use dolomite_city::{City, CityPlugin, CityView};

fn main() -> AppExit {
    let time = std::env::args().nth(1).unwrap_or_default();
    App::new()
        .insert_resource(DefaultOpaqueRendererMethod::deferred())
        .add_plugins((DefaultPlugins, CityPlugin))
        .add_systems(Startup, move |commands: Commands| setup(commands, &time))
        .add_systems(Update, walk)
        .run()
}

/// Sun or moon in lux, light of the sky in cd/m², its colour, exposure, hour, lamps.
type Light = (f32, f32, Color, f32, f32, f32);

fn light(time: &str) -> Light {
    match time {
        "night" => (
            0.3,
            0.15,
            Color::linear_rgb(0.002, 0.004, 0.010),
            4.5,
            21.0,
            1.0,
        ),
        "dusk" => (
            12.0,
            9.0,
            Color::linear_rgb(0.16, 0.12, 0.13),
            6.5,
            19.5,
            1.0,
        ),
        _ => (
            60_000.0,
            14_000.0,
            Color::linear_rgb(0.30, 0.50, 0.85),
            14.3,
            12.0,
            0.0,
        ),
    }
}

/// The city, its light, and a camera on the pavement.
pub fn setup(mut commands: Commands, time: &str) {
    let (lux, sky, colour, ev100, hour, lamps) = light(time);
    commands.insert_resource(ClearColor(colour));
    commands.insert_resource(GlobalAmbientLight {
        brightness: sky,
        ..default()
    });
    commands.spawn(City {
        hour,
        lamps,
        ..default()
    });
    let sun = DirectionalLight {
        illuminance: lux,
        shadow_maps_enabled: true,
        ..default()
    };
    commands.spawn((
        sun,
        Transform::default().looking_to(Vec3::new(-0.6, -0.75, -0.4), Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        CityView {
            far: 1200.0,
            ..default()
        },
        Msaa::Off,
        Hdr,
        Tonemapping::AgX,
        Exposure { ev100 },
        Transform::from_xyz(2.2, 2.4, 30.0).looking_to(Vec3::new(0.16, -0.03, -1.0), Vec3::Y),
    ));
}

fn walk(
    keys: Res<ButtonInput<KeyCode>>,
    time: Res<Time>,
    mut eyes: Query<&mut Transform, With<CityView>>,
) {
    let held = |less, more| f32::from(keys.pressed(more)) - f32::from(keys.pressed(less));
    let step = held(KeyCode::ArrowDown, KeyCode::ArrowUp) * 4.0 * time.delta_secs();
    let turn = held(KeyCode::ArrowRight, KeyCode::ArrowLeft) * time.delta_secs();
    for mut eye in &mut eyes {
        if step != 0.0 || turn != 0.0 {
            eye.rotate_y(turn);
            let ahead = eye.forward() * step;
            eye.translation += Vec3::new(ahead.x, 0.0, ahead.z);
        }
    }
}
