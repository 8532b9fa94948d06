//! Beacons with their fire, bandages, bolts that fly; and the sun of the hour.

use bevy::light::NotShadowCaster;
use bevy::math::ops;
use bevy::prelude::*;
use dolomite::logic::parts::Shots;
use dolomite::logic::{DayClock, Lamp, PickUp};
use dolomite::sky::Sun;
use dolomite::terrain::Ground;

use super::circuits::in_town;
use crate::level::day::sun;
use crate::level::menu::MenuSystems;
use crate::level::parts::{Bandage, Beacon, Cast, Level};
use crate::scene::CurrentScene;

/// Height of the basket above the ground, metres.
const BASKET: f32 = 2.1;

/// Luminous flux of a beacon, lumens, and where its light ends, metres: a great fire.
const LUMENS: f32 = 60_000.0;
const RANGE: f32 = 70.0;

/// How bright flames are in the picture, where 1 is white.
const GLOW: f32 = 2.4;

/// The sun is moved when it has gone so many degrees: the sky is computed anew then.
const TURN: f32 = 0.5;

/// How long a bolt is drawn, metres.
const BOLT: f32 = 1.6;

/// Dresses beacons, bandages and bolts.
pub struct BeaconsPlugin;

impl Plugin for BeaconsPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Update,
            (
                (dress_beacons, burn).run_if(not(in_town)),
                dress_bandages,
                show_bandages,
                fly,
                turn_sun,
            )
                .after(MenuSystems),
        );
    }
}

/// The fire of a beacon; its number tells its tongues apart.
#[derive(Component, Clone, Copy)]
struct Flame(Entity, u32);

/// The light of a beacon.
#[derive(Component, Clone, Copy)]
struct Glow(Entity);

#[derive(Component)]
struct Bolt;

fn dress_beacons(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    beacons: Query<(Entity, &Transform), Added<Beacon>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    if beacons.is_empty() {
        return;
    }
    let stone = materials.add(StandardMaterial {
        base_color: Color::srgb(0.46, 0.44, 0.41),
        perceptual_roughness: 0.95,
        reflectance: 0.25,
        ..default()
    });
    let wood = materials.add(StandardMaterial {
        base_color: Color::srgb(0.30, 0.20, 0.12),
        perceptual_roughness: 0.9,
        ..default()
    });
    let iron = materials.add(StandardMaterial {
        base_color: Color::linear_rgb(0.03, 0.03, 0.035),
        metallic: 0.6,
        perceptual_roughness: 0.55,
        ..default()
    });
    let flames: Vec<_> = [(1.0, 0.20, 0.02), (1.0, 0.38, 0.05), (1.0, 0.58, 0.14)]
        .into_iter()
        .map(|(r, g, b)| {
            materials.add(StandardMaterial {
                base_color: Color::BLACK,
                emissive: LinearRgba::rgb(r * GLOW, g * GLOW, b * GLOW),
                ..default()
            })
        })
        .collect();
    let steps = [(1.25, 0.5, 0.25), (0.95, 0.45, 0.7), (0.68, 0.45, 1.12)];
    let steps = steps.map(|(radius, height, at)| {
        let mesh = Cylinder::new(radius, height).mesh().resolution(9).build();
        let mesh = mesh.with_duplicated_vertices().with_computed_flat_normals();
        (meshes.add(mesh), at)
    });
    let basket = meshes.add(ConicalFrustum {
        radius_top: 0.62,
        radius_bottom: 0.34,
        height: 0.5,
    });
    let log = meshes.add(Cylinder::new(0.09, 1.1).mesh().resolution(7));
    let tongue = Cone {
        radius: 0.42,
        height: 1.0,
    };
    // From its foot upwards, so that it grows there.
    let tongue = meshes.add(tongue.mesh().build().translated_by(Vec3::Y * 0.5));
    for (entity, at) in &beacons {
        let place = at.translation;
        let truth = scene.terrain.height(Vec2::new(place.x, place.z).as_dvec2()) as f32;
        // Logic knows the ground to some decimetres.
        let down = Vec3::Y * (truth - place.y - 0.15);
        commands
            .entity(entity)
            .insert(Visibility::Inherited)
            .with_children(|parts| {
                for (mesh, height) in &steps {
                    parts.spawn((
                        Mesh3d(mesh.clone()),
                        MeshMaterial3d(stone.clone()),
                        Transform::from_translation(down + Vec3::Y * *height),
                    ));
                }
                parts.spawn((
                    Mesh3d(basket.clone()),
                    MeshMaterial3d(iron.clone()),
                    Transform::from_translation(down + Vec3::Y * (BASKET - 0.55)),
                ));
                for turn in 0..5_u32 {
                    let (sin, cos) = ops::sin_cos(turn as f32 * 1.257);
                    let lean =
                        Quat::from_rotation_y(turn as f32 * 1.257) * Quat::from_rotation_z(0.7);
                    parts.spawn((
                        Mesh3d(log.clone()),
                        MeshMaterial3d(wood.clone()),
                        Transform::from_translation(
                            down + Vec3::new(cos * 0.22, BASKET - 0.2, -sin * 0.22),
                        )
                        .with_rotation(lean),
                    ));
                }
                for (number, colour) in (0..9_u32).zip(flames.iter().cycle()) {
                    let (sin, cos) = ops::sin_cos(number as f32 * 2.4);
                    let out = 0.05 * number as f32;
                    parts.spawn((
                        Flame(entity, number),
                        Mesh3d(tongue.clone()),
                        MeshMaterial3d(colour.clone()),
                        NotShadowCaster,
                        Visibility::Hidden,
                        Transform::from_translation(down + Vec3::new(cos * out, BASKET, sin * out)),
                    ));
                }
                parts.spawn((
                    Glow(entity),
                    PointLight {
                        color: Color::linear_rgb(1.0, 0.55, 0.2),
                        intensity: 0.0,
                        range: RANGE,
                        radius: 0.4,
                        ..default()
                    },
                    Transform::from_translation(down + Vec3::Y * (BASKET + 0.9)),
                ));
            });
    }
}

/// Flames flicker; the light with them.
fn burn(
    time: Res<Time>,
    level: Res<Level>,
    beacons: Query<(&Beacon, &Lamp)>,
    mut flames: Query<(&Flame, &mut Transform, &mut Visibility)>,
    mut lights: Query<(&Glow, &mut PointLight)>,
) {
    let now = time.elapsed_secs_wrapped();
    let size = |of: Entity| match beacons.get(of) {
        Ok((_, lamp)) if lamp.lit => 1.0,
        Ok((beacon, _)) => 0.45 * (beacon.kindled / level.file.hold).min(1.0),
        Err(_) => 0.0,
    };
    for (flame, mut at, mut seen) in &mut flames {
        let size = size(flame.0);
        let wanted = match size > 0.01 {
            true => Visibility::Inherited,
            false => Visibility::Hidden,
        };
        seen.set_if_neq(wanted);
        if wanted == Visibility::Hidden {
            continue;
        }
        let number = flame.1 as f32;
        let beat = ops::sin(now * (7.0 + number * 0.9) + number * 1.7);
        // The inner tongues are the taller ones.
        let height = size * (2.3 - 0.16 * number) * (1.0 + 0.16 * beat);
        let width = size * (0.95 - 0.05 * number) * (1.0 - 0.1 * beat);
        at.scale = Vec3::new(width, height.max(0.05), width);
        at.rotation = Quat::from_rotation_y(number) * Quat::from_rotation_z(0.12 * beat);
    }
    for (glow, mut light) in &mut lights {
        let beat = ops::sin(now * 9.0) * 0.06 + ops::sin(now * 23.0) * 0.04;
        let wanted = LUMENS * size(glow.0) * (1.0 + beat);
        if light.intensity != wanted {
            light.intensity = wanted;
        }
    }
}

fn dress_bandages(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    bandages: Query<(Entity, &Transform), Added<Bandage>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    if bandages.is_empty() {
        return;
    }
    let plain = |r: f32, g: f32, b: f32| StandardMaterial {
        base_color: Color::srgb(r, g, b),
        perceptual_roughness: 0.8,
        ..default()
    };
    let (linen, cross) = (
        materials.add(plain(0.88, 0.86, 0.80)),
        materials.add(plain(0.75, 0.06, 0.05)),
    );
    let case = meshes.add(Cuboid::new(0.6, 0.35, 0.45));
    let bars = [Cuboid::new(0.32, 0.02, 0.1), Cuboid::new(0.1, 0.02, 0.32)];
    let bars = bars.map(|bar| meshes.add(bar));
    for (entity, at) in &bandages {
        let place = Vec2::new(at.translation.x, at.translation.z);
        let truth = scene.terrain.height(place.as_dvec2()) as f32;
        let foot = truth - at.translation.y;
        commands
            .entity(entity)
            .insert(Visibility::Inherited)
            .with_children(|parts| {
                parts.spawn((
                    Mesh3d(case.clone()),
                    MeshMaterial3d(linen.clone()),
                    Transform::from_xyz(0.0, foot + 0.15, 0.0),
                ));
                for bar in &bars {
                    parts.spawn((
                        Mesh3d(bar.clone()),
                        MeshMaterial3d(cross.clone()),
                        Transform::from_xyz(0.0, foot + 0.33, 0.0),
                    ));
                }
            });
    }
}

fn show_bandages(mut bandages: Query<(&PickUp, &mut Visibility), With<Bandage>>) {
    for (one, mut seen) in &mut bandages {
        seen.set_if_neq(match one.there {
            true => Visibility::Inherited,
            false => Visibility::Hidden,
        });
    }
}

/// As many bolts are drawn as fly.
fn fly(
    mut commands: Commands,
    shots: Res<Shots>,
    mut bolts: Query<(Entity, &mut Transform), With<Bolt>>,
    mut made: Local<Option<(Handle<Mesh>, Handle<StandardMaterial>)>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let mut flying = shots.0.iter().map(|shot| {
        let ahead = shot.velocity.as_vec3().normalize_or(Vec3::Y);
        Transform::from_translation(shot.place.as_vec3())
            .with_rotation(Quat::from_rotation_arc(Vec3::Y, ahead))
    });
    for (entity, mut at) in &mut bolts {
        match flying.next() {
            Some(next) => *at = next,
            None => commands.entity(entity).despawn(),
        }
    }
    for next in flying {
        let (mesh, material) = made.get_or_insert_with(|| {
            let mesh = Cylinder::new(0.025, BOLT).mesh().resolution(5);
            let material = StandardMaterial {
                base_color: Color::srgb(0.25, 0.20, 0.14),
                emissive: LinearRgba::rgb(0.5, 0.35, 0.2),
                ..default()
            };
            (meshes.add(mesh), materials.add(material))
        });
        commands.spawn((
            Bolt,
            Mesh3d(mesh.clone()),
            MeshMaterial3d(material.clone()),
            next,
        ));
    }
}

/// The sun stands where the hour says.
fn turn_sun(cast: Option<Res<Cast>>, clocks: Query<&DayClock>, mut suns: Query<&mut Sun>) {
    let Some(clock) = cast.and_then(|cast| clocks.get(cast.clock).ok()) else {
        return;
    };
    let (azimuth, elevation) = sun(clock.hour);
    for mut now in &mut suns {
        let far = (now.azimuth - azimuth)
            .abs()
            .max((now.elevation - elevation).abs());
        if far >= TURN {
            now.set_if_neq(Sun { azimuth, elevation });
        }
    }
}
