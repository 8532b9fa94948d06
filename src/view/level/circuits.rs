//! Switches of lamp circuits in a city: a cabinet, and a lamp on a post above it that burns when they are on.

use bevy::light::NotShadowCaster;
use bevy::prelude::*;
use dolomite::logic::Lamp;

use crate::level::menu::MenuSystems;
use crate::level::parts::{Beacon, Level};

/// Height of the globe above what the cabinet stands on, metres, and its radius.
const GLOBE: f32 = 3.0;
const RADIUS: f32 = 0.22;

/// Luminous flux of a lamp, lumens, and where its light ends, metres: those of a large street lamp.
const LUMENS: f32 = 12_000.0;
const RANGE: f32 = 40.0;

/// Height of the pilot light above the ground, metres.
const PILOT: f32 = 0.95;

/// How bright a globe is in the picture, where 1 is white.
const GLOW: f32 = 3.0;

/// Dresses circuits.
pub struct CircuitsPlugin;

impl Plugin for CircuitsPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Update,
            (dress, burn)
                .chain()
                .after(MenuSystems)
                .run_if(any_with_component::<Beacon>)
                .run_if(in_town),
        );
    }
}

/// Whether the level that is played has houses: what is to be lit are lamps there, and fires elsewhere.
pub fn in_town(level: Option<Res<Level>>) -> bool {
    level.is_some_and(|level| !level.built.hides.is_empty())
}

/// The globe of a lamp or the pilot light of a cabinet.
#[derive(Component, Clone, Copy)]
struct Globe {
    of: Entity,
    pilot: bool,
}

#[derive(Component, Clone, Copy)]
struct Shines(Entity);

/// What globes and pilot lights are made of.
#[derive(Clone)]
struct Glass {
    dark: Handle<StandardMaterial>,
    lit: Handle<StandardMaterial>,
    waits: Handle<StandardMaterial>,
}

fn dress(
    mut commands: Commands,
    circuits: Query<(Entity, &Transform), Added<Beacon>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    if circuits.is_empty() {
        return;
    }
    let iron = materials.add(StandardMaterial {
        base_color: Color::srgb(0.10, 0.12, 0.11),
        metallic: 0.5,
        perceptual_roughness: 0.55,
        ..default()
    });
    let paint = materials.add(StandardMaterial {
        base_color: Color::srgb(0.16, 0.28, 0.22),
        perceptual_roughness: 0.6,
        ..default()
    });
    let glowing = |r: f32, g: f32, b: f32| StandardMaterial {
        base_color: Color::srgb(0.5, 0.5, 0.48),
        emissive: LinearRgba::rgb(r * GLOW, g * GLOW, b * GLOW),
        ..default()
    };
    let glass = Glass {
        dark: materials.add(glowing(0.0, 0.0, 0.0)),
        lit: materials.add(glowing(1.0, 0.82, 0.55)),
        waits: materials.add(glowing(0.8, 0.05, 0.03)),
    };
    let cabinet = meshes.add(Cuboid::new(0.6, 1.1, 0.4));
    let post = meshes.add(Cylinder::new(0.05, GLOBE).mesh().resolution(12));
    let globe = meshes.add(Sphere::new(RADIUS).mesh().uv(20, 12));
    let pilot = meshes.add(Cuboid::new(0.16, 0.07, 0.44));
    for (entity, _) in &circuits {
        commands
            .entity(entity)
            .insert((Visibility::Inherited, Wears(glass.clone())))
            .with_children(|parts| {
                parts.spawn((
                    Mesh3d(cabinet.clone()),
                    MeshMaterial3d(paint.clone()),
                    Transform::from_xyz(0.0, 0.55, 0.0),
                ));
                parts.spawn((
                    Mesh3d(post.clone()),
                    MeshMaterial3d(iron.clone()),
                    Transform::from_xyz(0.0, GLOBE / 2.0, -0.3),
                ));
                for (mesh, at, is_pilot) in [
                    (&globe, Vec3::new(0.0, GLOBE, -0.3), false),
                    (&pilot, Vec3::new(0.0, PILOT, 0.0), true),
                ] {
                    parts.spawn((
                        Globe {
                            of: entity,
                            pilot: is_pilot,
                        },
                        Mesh3d(mesh.clone()),
                        MeshMaterial3d(glass.dark.clone()),
                        NotShadowCaster,
                        Transform::from_translation(at),
                    ));
                }
                parts.spawn((
                    Shines(entity),
                    PointLight {
                        color: Color::linear_rgb(1.0, 0.80, 0.52),
                        intensity: 0.0,
                        range: RANGE,
                        radius: RADIUS,
                        ..default()
                    },
                    Transform::from_xyz(0.0, GLOBE, -0.3),
                ));
            });
    }
}

/// The materials of a circuit.
#[derive(Component, Clone)]
struct Wears(Glass);

/// What burns shines; a pilot light flickers while its switch is turned.
fn burn(
    level: Res<Level>,
    circuits: Query<(&Beacon, &Lamp, &Wears)>,
    mut globes: Query<(&Globe, &mut MeshMaterial3d<StandardMaterial>)>,
    mut lights: Query<(&Shines, &mut PointLight)>,
) {
    for (globe, mut wears) in &mut globes {
        let Ok((beacon, lamp, Wears(glass))) = circuits.get(globe.of) else {
            continue;
        };
        // Five times while it is turned.
        let flickers = (beacon.kindled / level.file.hold * 10.0) as u32 % 2 == 1;
        let wanted = match (lamp.lit, globe.pilot) {
            (true, _) => &glass.lit,
            (false, true) if !flickers => &glass.waits,
            (false, _) => &glass.dark,
        };
        if wears.0 != *wanted {
            wears.0 = wanted.clone();
        }
    }
    for (shines, mut light) in &mut lights {
        let lit = circuits.get(shines.0).is_ok_and(|(_, lamp, _)| lamp.lit);
        let wanted = if lit { LUMENS } else { 0.0 };
        if light.intensity != wanted {
            light.intensity = wanted;
        }
    }
}
