//! What is heard of a level: shots, hits and calls; lifts, the gate, latches; fires.

use bevy::prelude::*;
use dolomite::logic::parts::{DoorState, LiftState};
use dolomite::logic::{Door, Key, Lamp, Lift, Output};
use dolomite::sound::{Bus, Loudness, PlaySound, SoundEmitter, SoundId, built_in};

use super::GameSoundSystems;
use crate::level::arms::SHOULDER;
use crate::level::gate::Bars;
use crate::level::lifts::RoofLift;
use crate::level::menu::MenuSystems;
use crate::level::parts::{Beacon, Cast, Level, Soldier};

/// Seconds until a soldier may be heard to call again: as its own.
const AGAIN: f32 = 1.0;

/// Sounds of levels.
pub struct LevelSoundPlugin;

impl Plugin for LevelSoundPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Update,
            (
                happen,
                call.run_if(any_with_component::<Soldier>),
                (dress_lifts, run_lifts)
                    .chain()
                    .run_if(any_with_component::<RoofLift>),
                (dress_gate, run_gate)
                    .chain()
                    .run_if(any_with_component::<Bars>),
                (dress_fires, burn)
                    .chain()
                    .run_if(any_with_component::<Beacon>),
            )
                .run_if(resource_exists::<Cast>)
                .after(MenuSystems)
                .in_set(GameSoundSystems),
        );
    }
}

/// A sound of something that happens: how loud, from how far, how important.
const fn once(volume: f32, reference: f32, reach: f32, priority: u8) -> Loudness {
    Loudness {
        volume,
        rate: 1.0,
        reference,
        reach,
        priority,
        bus: Bus::Effects,
    }
}

/// Shots are heard over a valley, and before all else.
const SHOT: Loudness = once(1.0, 7.0, 700.0, 200);
const HIT: Loudness = once(0.9, 4.0, 120.0, 190);
const CALL: Loudness = once(0.9, 9.0, 500.0, 180);
const LATCH: Loudness = once(0.6, 2.0, 60.0, 120);

/// Outputs of logic as sounds.
fn happen(
    mut outputs: MessageReader<Output>,
    places: Query<&Transform>,
    mut sounds: MessageWriter<PlaySound>,
) {
    for output in outputs.read() {
        let (sound, loudness, above) = match output.name {
            Key::FIRED => (built_in::SHOT, SHOT, SHOULDER),
            Key::HURT => (built_in::HIT, HIT, Vec3::ZERO),
            Key::PRESSED | Key::ARRIVED | Key::OPENED | Key::CLOSED => {
                (built_in::LATCH, LATCH, Vec3::ZERO)
            }
            _ => continue,
        };
        if let Ok(at) = places.get(output.source) {
            sounds.write(PlaySound::at(sound, at.translation + above).with(loudness));
        }
    }
}

/// How long a soldier does not call, as it was a frame ago.
#[derive(Component, Default)]
struct Called(f32);

fn call(
    mut commands: Commands,
    mut soldiers: Query<(Entity, &Soldier, &Transform, Option<&mut Called>)>,
    mut sounds: MessageWriter<PlaySound>,
) {
    for (entity, soldier, at, called) in &mut soldiers {
        let Some(mut called) = called else {
            commands.entity(entity).insert(Called(soldier.calls));
            continue;
        };
        if soldier.calls > called.0 + AGAIN {
            // No two voices are the same.
            let own = entity.index_u32().wrapping_mul(2_654_435_769) >> 24;
            let loudness = Loudness {
                rate: 0.88 + 0.24 * own as f32 / 255.0,
                ..CALL
            };
            sounds.write(PlaySound::at(built_in::CALL, at.translation + SHOULDER).with(loudness));
        }
        if called.0 != soldier.calls {
            called.0 = soldier.calls;
        }
    }
}

/// An emitter that is silent until it is told otherwise.
fn silent(sound: SoundId, reference: f32, reach: f32, bus: Bus) -> SoundEmitter {
    SoundEmitter {
        sound,
        everywhere: false,
        loudness: Loudness {
            volume: 0.0,
            reference,
            reach,
            priority: 110,
            bus,
            ..default()
        },
    }
}

fn loud(emitter: &mut Mut<SoundEmitter>, volume: f32, rate: f32) {
    let next = SoundEmitter {
        loudness: Loudness {
            volume,
            rate,
            ..emitter.loudness
        },
        ..**emitter
    };
    emitter.set_if_neq(next);
}

fn dress_lifts(
    mut commands: Commands,
    lifts: Query<Entity, (With<RoofLift>, Without<SoundEmitter>)>,
) {
    for lift in &lifts {
        commands
            .entity(lift)
            .insert(silent(built_in::LIFT, 3.0, 80.0, Bus::Effects));
    }
}

/// A lift hums the higher the faster it is.
fn run_lifts(mut lifts: Query<(&Lift, &mut SoundEmitter), With<RoofLift>>) {
    for (lift, mut emitter) in &mut lifts {
        let moves = lift.state() == LiftState::Moving;
        let speed = lift.velocity().abs();
        let volume = if moves { 0.5 } else { 0.0 };
        loud(&mut emitter, volume, 0.7 + 0.15 * speed.min(4.0));
    }
}

fn dress_gate(mut commands: Commands, gates: Query<Entity, (With<Bars>, Without<SoundEmitter>)>) {
    for gate in &gates {
        commands
            .entity(gate)
            .insert(silent(built_in::LIFT, 6.0, 200.0, Bus::Effects));
    }
}

/// A gate is a slow and heavy lift.
fn run_gate(mut gates: Query<(&Door, &mut SoundEmitter), With<Bars>>) {
    for (door, mut emitter) in &mut gates {
        let moves = matches!(door.state, DoorState::Opening | DoorState::Closing);
        loud(&mut emitter, if moves { 0.9 } else { 0.0 }, 0.55);
    }
}

fn dress_fires(
    mut commands: Commands,
    beacons: Query<Entity, (With<Beacon>, Without<SoundEmitter>)>,
) {
    for beacon in &beacons {
        commands
            .entity(beacon)
            .insert(silent(built_in::FIRE, 4.0, 150.0, Bus::Ambience));
    }
}

/// Beacons burn; what is to be lit in a town are lamps.
fn burn(level: Option<Res<Level>>, mut beacons: Query<(&Lamp, &mut SoundEmitter), With<Beacon>>) {
    let lamps = level.is_some_and(|level| !level.built.hides.is_empty());
    for (lamp, mut emitter) in &mut beacons {
        let burns = lamp.lit && !lamps;
        loud(&mut emitter, if burns { 0.8 } else { 0.0 }, 1.0);
    }
}
