//! The way out: a gate in the wall around a quarter, which opens when all beacons burn.

use bevy::prelude::*;
use dolomite::collision::Blocker;
use dolomite::logic::parts::{Outcome, Slide, Visitor};
use dolomite::logic::{Door, Key, Mission, Objective, Wire, Wires, Zone};

use super::parts::{Cast, Level, LevelPart, LevelState};

/// Seconds until the gate is open.
const OPENS: f32 = 4.0;

/// Holds nobody: until the gate is open nobody leaves.
const NOBODY: Vec3 = Vec3::NEG_ONE;

/// The gate.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[require(LevelPart)]
pub struct Bars;

/// The place beyond the gate.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[require(LevelPart)]
pub struct Beyond;

/// The gate of a level, if it has one: `objective` opens it, and `mission` is won beyond it.
pub(super) fn spawn(world: &mut World, level: &Level, cast: &Cast) {
    let Some(gate) = level.built.gate else {
        return;
    };
    let slide = Slide {
        closed: gate.closed,
        open: gate.open,
    };
    let door = Door {
        time: OPENS,
        ..default()
    };
    let at = Transform::from_translation(gate.closed);
    let half_size = gate.half;
    let bars = world
        .spawn((Bars, door, slide, Blocker { half_size }, at))
        .id();
    let opens = Wires(vec![Wire::new(Key::DONE, bars, Key::OPEN)]);
    world.entity_mut(cast.objective).insert(opens);
    let left = world.spawn((LevelPart, Objective::new(1))).id();
    let leaves = Wire::new(Key::ENTERED, left, Key::PROGRESS).with(1);
    world.spawn((
        Beyond,
        Zone::new(NOBODY),
        Transform::from_translation(gate.beyond.0),
        Wires(vec![leaves]),
    ));
    world.entity_mut(cast.player).insert(Visitor::default());
    if let Some(mut mission) = world.get_mut::<Mission>(cast.mission) {
        mission.objectives.push(left);
    }
}

/// Beyond the gate counts once all beacons burn.
pub(super) fn unbar(
    level: Res<Level>,
    cast: Res<Cast>,
    mut state: ResMut<LevelState>,
    objectives: Query<&Objective>,
    mut beyond: Query<&mut Zone, With<Beyond>>,
) {
    let lit = objectives.get(cast.objective);
    if state.open || !lit.is_ok_and(|lit| lit.outcome == Outcome::Won) {
        return;
    }
    let Some(gate) = level.built.gate else {
        return;
    };
    state.open = true;
    for mut zone in &mut beyond {
        zone.half_size = gate.beyond.1;
    }
}
