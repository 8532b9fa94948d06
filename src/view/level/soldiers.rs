//! What soldiers look like: the figure of `assets/soldier`, whose clips follow what logic says.
//!
//! Logic's soldier is a point on the grid of its ground. What is drawn is an entity of its own, which stands on the
//! terrain, between the last two steps.
//!
//! | logic | clip |
//! |---|---|
//! | walks, runs, turns | `patrol`, `run`, `turn_left`, `turn_right`, by speed |
//! | calls the others | `alarm` |
//! | sees the player and is alarmed | `aim`, held |
//! | shot ([`Key::FIRED`]), was hit ([`Key::HURT`]) | `shoot`, `hit` |
//! | is [`Fallen`] | `fall_back`, held: it lies |

use bevy::math::DVec3;
use bevy::prelude::*;
use dolomite::character::feet::Place;
use dolomite::character::gait::Motion;
use dolomite::character::{Character, CharacterMotion, CharacterState, Input, Workspace};
use dolomite::fbx::FbxConversion;
use dolomite::logic::{Key, Output};
use dolomite::terrain::Ground;

use crate::level::parts::{Fallen, Soldier, ground_of};
use crate::level::yaw_of;
use crate::scene::CurrentScene;
use crate::settings::paths::AssetsDir;
use crate::view::person::{Loading, Person, PersonFiles};

/// Where the soldier lies.
pub const FILES: PersonFiles = PersonFiles {
    model: "soldier/soldier.fbx",
    gaits: "soldier/gaits.ron",
};

/// Numbers of the one-shots in the soldier's `gaits.ron`.
pub mod shots {
    /// Calls the others.
    pub const ALARM: usize = 0;
    /// Holds the crossbow at the shoulder.
    pub const AIM: usize = 1;
    /// Shoots, and draws the string anew.
    pub const SHOOT: usize = 2;
    /// Was hit.
    pub const HIT: usize = 3;
    /// Falls on the back, and lies.
    pub const FALL: usize = 4;
}

/// Seconds after which everybody who fell lies still.
const LIES: f32 = 3.0;

/// Dresses soldiers.
pub struct SoldiersPlugin;

impl Plugin for SoldiersPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(FixedLast, note).add_systems(
            Update,
            (
                call.run_if(any_with_component::<Soldier>),
                arrive.run_if(resource_exists::<Coming>),
                dress.run_if(resource_exists::<Wear>),
                undress,
                act,
            )
                .chain(),
        );
        app.add_systems(
            RunFixedMainLoop,
            place.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
        );
    }
}

/// The soldier's figure is being loaded.
#[derive(Resource)]
struct Coming(Loading);

/// What all soldiers look like; nothing where the figure could not be loaded.
#[derive(Resource)]
struct Wear(Option<Person>);

/// Whether every soldier looks as it will.
pub fn are_there(world: &mut World) -> bool {
    let count = |world: &mut World| {
        let mut soldiers = world.query_filtered::<(), With<Soldier>>();
        soldiers.iter(world).count()
    };
    match world.get_resource::<Wear>() {
        Some(Wear(None)) => true,
        Some(Wear(Some(_))) => {
            let mut looks = world.query_filtered::<(), With<Looks>>();
            looks.iter(world).count() >= count(world)
        }
        None => count(world) == 0,
    }
}

/// The figure is loaded once somebody is to look like it.
fn call(
    mut commands: Commands,
    assets: Res<AssetServer>,
    coming: Option<Res<Coming>>,
    wear: Option<Res<Wear>>,
) {
    if coming.is_none() && wear.is_none() {
        commands.insert_resource(Coming(Loading::new(FILES, &assets)));
    }
}

fn arrive(
    mut commands: Commands,
    coming: Res<Coming>,
    assets: Res<AssetServer>,
    gltfs: Res<Assets<Gltf>>,
    conversions: Res<Assets<FbxConversion>>,
    folder: Res<AssetsDir>,
) {
    let Some(person) = coming.0.poll(&assets, &gltfs, &conversions, &folder.0) else {
        return;
    };
    if let Err(error) = &person {
        error!("soldiers are not seen: {error}");
    }
    commands.remove_resource::<Coming>();
    commands.insert_resource(Wear(person.ok()));
}

/// What a soldier looks like, between its last two steps: x, z and the way that it looks.
#[derive(Component, Clone, Copy, Debug)]
pub struct Looks {
    /// Whose looks.
    of: Entity,
    before: (Vec2, f32),
    now: (Vec2, f32),
    /// Seconds until it calls again, as they were a frame ago.
    calls: f32,
}

fn dress(
    mut commands: Commands,
    wear: Res<Wear>,
    soldiers: Query<(Entity, &Transform, Has<Fallen>), With<Soldier>>,
    looks: Query<&Looks>,
) {
    let Some(person) = &wear.0 else { return };
    for (of, at, has_fallen) in &soldiers {
        if looks.iter().any(|looks| looks.of == of) {
            continue;
        }
        let now = (ground_of(at), yaw_of(at));
        let mut state = CharacterState::default();
        if has_fallen {
            // Who fell before anybody saw it lies already.
            state.hold(Some(shots::FALL));
            let input = Input {
                dt: LIES,
                motion: Motion::default(),
                place: Place {
                    position: DVec3::ZERO,
                    rotation: Quat::IDENTITY,
                },
            };
            person
                .figure
                .advance(&mut state.0, &input, &mut Workspace::default());
        }
        let mut entity = commands.spawn((
            Looks {
                of,
                before: now,
                now,
                calls: 0.0,
            },
            Transform::from_translation(at.translation),
            Visibility::default(),
            CharacterMotion::default(),
            state,
            Character {
                figure: person.figure.clone(),
            },
        ));
        if let Some(scene) = &person.scene {
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
            // As the ground lies.
            let up = scene.terrain.normal(to.as_dvec2()).as_vec3();
            let lies = Quat::from_rotation_arc(Vec3::Y, up)
                * Quat::from_rotation_y(is + std::f32::consts::PI);
            at.set_if_neq(Transform::from_xyz(to.x, height, to.y).with_rotation(lies));
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

/// Clips follow what logic says.
fn act(
    mut outputs: MessageReader<Output>,
    soldiers: Query<(&Soldier, Has<Fallen>)>,
    mut looks: Query<(&mut Looks, &mut CharacterState)>,
) {
    let heard: Vec<Output> = outputs.read().copied().collect();
    for (mut looks, mut state) in &mut looks {
        let Ok((soldier, has_fallen)) = soldiers.get(looks.of) else {
            continue;
        };
        if has_fallen {
            state.hold(Some(shots::FALL));
            state.cut();
            continue;
        }
        let aims = soldier.alarmed && soldier.wish.face.is_some();
        state.hold(aims.then_some(shots::AIM));
        if soldier.calls > looks.calls {
            state.play(shots::ALARM);
        }
        if looks.calls != soldier.calls {
            looks.calls = soldier.calls;
        }
        for output in heard.iter().filter(|output| output.source == looks.of) {
            if output.name == Key::HURT {
                state.play(shots::HIT);
            } else if output.name == Key::FIRED {
                state.play(shots::SHOOT);
            }
        }
    }
}
