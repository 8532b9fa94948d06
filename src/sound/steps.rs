//! Steps: when a foot lands, as the gait has it, a sound of what it lands on.

use bevy::prelude::*;
use dolomite::character::{CharacterMotion, CharacterState};
use dolomite::ground::GroundMaterial;
use dolomite::sound::{Loudness, PlaySound, SoundId, built_in};

use super::GameSoundSystems;
use super::ground::{material, step_on};
use crate::play::figure::Figure;
use crate::play::jump::Jump;
use crate::scene::CurrentScene;

/// Slower than this, metres a second, and turned slower than this, radians a second, nobody's foot leaves the ground.
const STANDS: f32 = 0.15;
const TURNS: f32 = 0.4;

/// Amplitudes of a slow step, and of one of a run of this many metres a second.
const SOFT: f32 = 0.22;
const HARD: f32 = 0.7;
const RUN: f32 = 5.0;

/// A landing after a leap, as a multiple of a hard step.
const LANDING: f32 = 1.4;

/// Steps are heard from the camera behind the figure, and of soldiers over a street.
const REFERENCE: f32 = 3.0;
const REACH: f32 = 60.0;

/// Steps give way to shots and calls.
const PRIORITY: u8 = 90;

/// Steps of whoever walks.
pub struct StepsPlugin;

impl Plugin for StepsPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Update,
            (
                know.run_if(
                    resource_changed::<CurrentScene>.or_else(not(resource_exists::<Walked>)),
                ),
                mark,
                step.run_if(resource_exists::<Walked>),
            )
                .chain()
                .in_set(GameSoundSystems),
        );
    }
}

/// What is walked on.
#[derive(Resource)]
struct Walked(GroundMaterial);

fn know(mut commands: Commands, scene: Res<CurrentScene>) {
    commands.insert_resource(Walked(material(&scene)));
}

/// Where somebody was in their step a frame ago, and whether they were in the air.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
struct Stride {
    phase: f32,
    air: bool,
}

fn mark(mut commands: Commands, new: Query<Entity, (With<CharacterState>, Without<Stride>)>) {
    for entity in &new {
        // A soldier's figure may be gone by then.
        commands.entity(entity).try_insert(Stride::default());
    }
}

/// Whether a foot landed between two phases, each 0 to 1: the left one at 0, the right one at 1/2. A phase never goes
/// back; in a frame it goes on by less than a half.
fn landed(before: f32, now: f32) -> bool {
    let half = |phase: f32| phase >= 0.5;
    before != now && half(before) != half(now)
}

/// How loud a step at a speed is, metres a second.
fn loudness(speed: f32) -> Loudness {
    let part = (speed / RUN).clamp(0.0, 1.0);
    Loudness {
        volume: SOFT + (HARD - SOFT) * part,
        reference: REFERENCE,
        reach: REACH,
        priority: PRIORITY,
        ..default()
    }
}

fn step(
    time: Res<Time>,
    scene: Res<CurrentScene>,
    walked: Res<Walked>,
    mut walkers: Query<(
        &Transform,
        &CharacterState,
        &CharacterMotion,
        &mut Stride,
        Option<&Figure>,
    )>,
    mut sounds: MessageWriter<PlaySound>,
) {
    if time.delta_secs() == 0.0 {
        return;
    }
    for (at, state, motion, mut stride, figure) in &mut walkers {
        let next = Stride {
            phase: state.0.locomotion.phase,
            air: motion.0.airborne,
        };
        let before = *stride;
        if before == next {
            continue;
        }
        *stride = next;
        let moves = motion.0.speed.abs() > STANDS || motion.0.turn_rate.abs() > TURNS;
        let lands = before.air && !next.air;
        let steps = moves && !next.air && landed(before.phase, next.phase);
        if !(lands || steps) {
            continue;
        }
        let mut loud = loudness(motion.0.speed.abs());
        if lands {
            loud.volume = HARD * LANDING;
        }
        // No two feet are alike: a little higher or lower, by where it lands.
        loud.rate = 0.94 + 0.12 * (at.translation.x * 7.3 + at.translation.z * 5.1).rem_euclid(1.0);
        let sound = under(at, figure, &scene, &walked.0);
        sounds.write(PlaySound::at(sound, at.translation).with(loud));
    }
}

/// What somebody stands on: the figure may stand on a thing above the ground.
fn under(
    at: &Transform,
    figure: Option<&Figure>,
    scene: &CurrentScene,
    material: &GroundMaterial,
) -> SoundId {
    let on_thing = figure.is_some_and(|figure| matches!(figure.now.jump, Jump::On { .. }));
    if on_thing {
        return built_in::STEP_ROAD;
    }
    let place = bevy::math::DVec2::new(f64::from(at.translation.x), f64::from(at.translation.z));
    step_on(scene, material, place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_foot_lands_once_in_a_stride() {
        for step in [0.01_f32, 0.037, 0.11, 0.3, 0.49] {
            let mut phase = 0.3_f32;
            let mut count = 0;
            let mut gone = 0.0_f64;
            while gone < 40.0 {
                let next = (phase + step).rem_euclid(1.0);
                count += u32::from(landed(phase, next));
                phase = next;
                gone += f64::from(step);
            }
            // 40 strides of two steps each, one more where the last frame goes beyond.
            assert!((79..=81).contains(&count), "{step}: {count}");
        }
        assert!(!landed(0.2, 0.2) && !landed(0.7, 0.7));
    }

    #[test]
    fn who_runs_is_louder() {
        assert!(loudness(0.0).volume < loudness(1.6).volume);
        assert!(loudness(1.6).volume < loudness(5.0).volume);
        assert_eq!(loudness(50.0).volume, HARD);
    }
}
