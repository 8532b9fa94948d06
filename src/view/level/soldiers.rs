//! Soldiers look like the hiker, in other colours.
//!
//! Logic's soldier is a point on the grid of its ground. What is drawn is an entity of its own, which stands on the
//! terrain, between the last two steps.

use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use dolomite::character::gait::Motion;
use dolomite::character::{Character, CharacterMotion};
use dolomite::terrain::Ground;

use crate::level::parts::{Fallen, Soldier, ground_of};
use crate::level::yaw_of;
use crate::scene::CurrentScene;
use crate::view::hero::Hero;

/// What the hiker's colours are multiplied by: steel and dark blue.
const DYE: LinearRgba = LinearRgba::rgb(0.20, 0.30, 0.52);

/// Half of the depth of a figure that lies, metres.
const LYING: f32 = 0.15;

/// Dresses soldiers.
pub struct SoldiersPlugin;

impl Plugin for SoldiersPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Dyes>()
            .add_systems(FixedLast, note)
            .add_systems(
                Update,
                (dress.run_if(resource_exists::<Hero>), dye, undress),
            )
            .add_systems(
                RunFixedMainLoop,
                place.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
            );
    }
}

/// What a soldier looks like, between its last two steps: x, z and the way that it looks.
#[derive(Component, Clone, Copy, Debug)]
pub struct Looks {
    /// Whose looks.
    of: Entity,
    before: (Vec2, f32),
    now: (Vec2, f32),
}

#[derive(Component)]
struct Dyed;

/// Materials in other colours.
#[derive(Resource, Default)]
struct Dyes(HashMap<AssetId<StandardMaterial>, Handle<StandardMaterial>>);

fn dress(
    mut commands: Commands,
    hero: Res<Hero>,
    soldiers: Query<(Entity, &Transform), With<Soldier>>,
    looks: Query<&Looks>,
) {
    for (of, at) in &soldiers {
        if looks.iter().any(|looks| looks.of == of) {
            continue;
        }
        let now = (ground_of(at), yaw_of(at));
        let mut entity = commands.spawn((
            Looks {
                of,
                before: now,
                now,
            },
            Transform::from_translation(at.translation),
            Visibility::default(),
            CharacterMotion::default(),
            Character {
                figure: hero.person.clone(),
            },
        ));
        if let Some(scene) = &hero.scene {
            entity.with_child(WorldAssetRoot(scene.clone()));
        }
    }
}

/// Who is gone looks like nothing.
fn undress(mut commands: Commands, looks: Query<(Entity, &Looks)>, soldiers: Query<&Soldier>) {
    for (entity, looks) in &looks {
        if !soldiers.contains(looks.of) {
            commands.entity(entity).despawn();
        }
    }
}

fn note(soldiers: Query<&Transform, With<Soldier>>, mut looks: Query<&mut Looks>) {
    for mut looks in &mut looks {
        if let Ok(at) = soldiers.get(looks.of) {
            looks.before = looks.now;
            looks.now = (ground_of(at), yaw_of(at));
        }
    }
}

/// The shorter way from one turn to another, radians.
fn turn(from: f32, to: f32) -> f32 {
    (to - from + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI
}

fn place(
    time: Res<Time<Fixed>>,
    scene: Res<CurrentScene>,
    fallen: Query<(), With<Fallen>>,
    mut looks: Query<(&Looks, &mut Transform, &mut CharacterMotion)>,
) {
    let (part, step) = (time.overstep_fraction(), time.timestep().as_secs_f32());
    for (looks, mut at, mut motion) in &mut looks {
        let ((from, was), (to, is)) = (looks.before, looks.now);
        let place = from.lerp(to, part);
        let height = scene.terrain.height(place.as_dvec2()) as f32;
        let turned = turn(was, is);
        if fallen.contains(looks.of) {
            // On the back: the figure stands on its origin.
            let lies = Quat::from_rotation_y(is + std::f32::consts::PI)
                * Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
            at.set_if_neq(Transform::from_xyz(to.x, height + LYING, to.y).with_rotation(lies));
            motion.set_if_neq(CharacterMotion::default());
            continue;
        }
        at.set_if_neq(Transform::from_xyz(place.x, height, place.y)
                // A facing of 0 is −z, and the figure looks along its +z.
                .with_rotation(Quat::from_rotation_y(
                    was + turned * part + std::f32::consts::PI,
                )));
        motion.set_if_neq(CharacterMotion(Motion {
            speed: from.distance(to) / step,
            turn_rate: turned / step,
            ..default()
        }));
    }
}

/// Meshes of soldiers that have come get their colours.
fn dye(
    mut commands: Commands,
    looks: Query<Entity, (With<Looks>, Without<Dyed>)>,
    children: Query<&Children>,
    wears: Query<&MeshMaterial3d<StandardMaterial>>,
    mut dyes: ResMut<Dyes>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for soldier in &looks {
        let mut dyed = false;
        for part in children.iter_descendants(soldier) {
            let Ok(MeshMaterial3d(cloth)) = wears.get(part) else {
                continue;
            };
            let Some(material) = materials.get(cloth).cloned() else {
                continue;
            };
            let known = dyes.0.get(&cloth.id()).cloned();
            let other = known.unwrap_or_else(|| {
                let plain = material.base_color.to_linear();
                let mixed = LinearRgba::rgb(
                    plain.red * DYE.red,
                    plain.green * DYE.green,
                    plain.blue * DYE.blue,
                );
                materials.add(StandardMaterial {
                    base_color: mixed.into(),
                    ..material
                })
            });
            dyes.0.insert(cloth.id(), other.clone());
            commands.entity(part).insert(MeshMaterial3d(other));
            dyed = true;
        }
        if dyed {
            commands.entity(soldier).insert(Dyed);
        }
    }
}
