//! What soldiers notice, whom they call, and what each leaf of their behaviour wants of them.

use bevy::math::ops;
use bevy::prelude::*;
use dolomite::logic::senses::{Memory, Sight};
use dolomite::logic::{Action, Key, LeafBatch, LogicClock, Phase, Status, Value, Values};

use super::arms::{SHOULDER, lead};
use super::parts::{Cast, Level, LevelKeys, LevelState, Player, Soldier, Wish, ground_of};

/// Seconds until somebody right before them is known for who they are, and how many more at the end of sight.
const NOTICE: (f32, f32) = (0.35, 2.0);

/// What a soldier is less sure of in a second in which it sees nobody.
const DOUBTS: f32 = 0.3;

/// An alarmed soldier who is less sure of its memory than this is alarmed no more.
const FORGETS: f32 = 0.3;

/// Seconds between two calls of a soldier who sees the player.
const CALLS: f32 = 6.0;

/// How sure one is of what another calls, 0 to 1; and of what is seen then.
const CALLED: (f32, f32) = (0.9, 0.6);

/// An alarmed soldier comes no nearer than this, metres: it shoots.
const STANDS: f32 = 12.0;

/// A place is reached from this far away, metres.
const THERE: f32 = 3.0;

/// Part of its running speed at which a soldier looks into something.
const LOOKS_INTO: f32 = 0.75;

/// How fast who looks about turns, radians a second.
const LOOKS_ABOUT: f32 = 0.9;

/// Who is seen is noticed, the sooner the nearer; who is sure calls the others.
pub(super) fn notice(
    level: Res<Level>,
    cast: Res<Cast>,
    keys: Res<LevelKeys>,
    clock: Res<LogicClock>,
    mut state: ResMut<LevelState>,
    players: Query<&Transform, With<Player>>,
    mut soldiers: Query<
        (
            Entity,
            &mut Soldier,
            &Sight,
            &mut Memory,
            &mut Values,
            &Transform,
        ),
        Without<Player>,
    >,
) {
    let Ok(player) = players.get(cast.player) else {
        return;
    };
    state.alarmed = 0;
    state.noticed = 0.0;
    let mut calls: Vec<(Entity, Vec3)> = Vec::new();
    for (entity, mut soldier, sight, _, mut values, at) in &mut soldiers {
        let seconds = clock.delta;
        soldier.wish = Wish::default();
        soldier.calls = (soldier.calls - seconds).max(0.0);
        let sees = sight.sees(cast.player);
        if sees {
            let far = at.translation.distance(player.translation) / sight.range.max(1.0);
            soldier.notice += seconds / (NOTICE.0 + NOTICE.1 * far);
        } else if !soldier.alarmed {
            soldier.notice = (soldier.notice - DOUBTS * seconds).max(0.0);
        }
        if soldier.notice >= 1.0 {
            soldier.notice = 1.0;
            soldier.alarmed = true;
            if sees && soldier.calls == 0.0 {
                soldier.calls = CALLS;
                calls.push((entity, at.translation));
            }
        }
        if soldier.alarmed && !sees && values.number(Key::ALERT) < FORGETS {
            soldier.alarmed = false;
            soldier.notice = 0.0;
        }
        let number = |yes: bool| Value::Float(f32::from(u8::from(yes)));
        // The behaviour's file declares both as numbers.
        let _ = values.set(keys.sees, number(sees));
        let _ = values.set(keys.alarmed, number(soldier.alarmed));
        state.alarmed += u32::from(soldier.alarmed);
        if !soldier.alarmed {
            state.noticed = state.noticed.max(soldier.notice);
        }
    }
    state.calls += calls.len() as u32;
    for (caller, from) in calls {
        for (entity, mut soldier, _, mut memory, _, at) in &mut soldiers {
            let far = at.translation.distance(from);
            if entity != caller && far <= level.file.soldiers.calls {
                memory.note(Some(cast.player), player.translation, CALLED.0);
                soldier.notice = soldier.notice.max(CALLED.1);
            }
        }
    }
}

/// Soldiers at a leaf, each with what it remembers.
type Agents<'w, 's> = Query<'w, 's, (&'static mut Soldier, &'static Transform, &'static Values)>;

/// Calls `each` for every soldier at a leaf that goes on.
fn at_leaf(
    batch: &mut LeafBatch,
    agents: &mut Agents,
    mut each: impl FnMut(Entity, &mut Soldier, &Transform, &Values) -> Status,
) {
    for (call, _) in batch.iter_mut() {
        if call.phase == Phase::Stop {
            continue;
        }
        call.status = match agents.get_mut(call.agent) {
            Ok((mut soldier, at, values)) => each(call.agent, &mut soldier, at, values),
            Err(_) => Status::Failure,
        };
    }
}

fn remembered(values: &Values) -> Option<Vec2> {
    let place: Vec3 = values.read(Key::PLACE)?;
    Some(Vec2::new(place.x, place.z))
}

/// To the next place of the round.
pub(super) fn walk_on(InMut(batch): InMut<LeafBatch>, level: Res<Level>, mut agents: Agents) {
    at_leaf(batch, &mut agents, |_, soldier, at, _| {
        let goal = soldier.round[soldier.next % soldier.round.len()];
        if ground_of(at).distance(goal) < THERE {
            soldier.next = (soldier.next + 1) % soldier.round.len();
            return Status::Success;
        }
        soldier.wish = Wish {
            goal: Some(goal),
            speed: level.file.soldiers.walk,
            face: None,
        };
        Status::Running
    });
}

/// Turns around.
pub(super) fn look_about(InMut(batch): InMut<LeafBatch>, mut agents: Agents) {
    at_leaf(batch, &mut agents, |_, soldier, at, _| {
        let ahead = at.rotation * Vec3::NEG_Z;
        let (sin, cos) = ops::sin_cos(LOOKS_ABOUT);
        // As far ahead as it turns in a second.
        let turned = Vec2::new(ahead.x * cos + ahead.z * sin, ahead.z * cos - ahead.x * sin);
        soldier.wish.face = Some(ground_of(at) + turned * 10.0);
        Status::Running
    });
}

/// Stands and looks where somebody may be.
pub(super) fn stare(InMut(batch): InMut<LeafBatch>, mut agents: Agents) {
    at_leaf(batch, &mut agents, |_, soldier, _, values| {
        soldier.wish.face = remembered(values);
        Status::Running
    });
}

/// To where something was seen or heard.
pub(super) fn go_there(InMut(batch): InMut<LeafBatch>, level: Res<Level>, mut agents: Agents) {
    at_leaf(batch, &mut agents, |_, soldier, at, values| {
        let Some(goal) = remembered(values) else {
            return Status::Failure;
        };
        let goal = level.grid.nearest_open(goal, 12).unwrap_or(goal);
        if ground_of(at).distance(goal) < THERE {
            return Status::Success;
        }
        soldier.wish = Wish {
            goal: Some(goal),
            speed: level.file.soldiers.run * LOOKS_INTO,
            face: None,
        };
        Status::Running
    });
}

/// After the player, and shoots.
pub(super) fn fight(
    InMut(batch): InMut<LeafBatch>,
    level: Res<Level>,
    cast: Res<Cast>,
    keys: Res<LevelKeys>,
    clock: Res<LogicClock>,
    mut agents: Agents,
    players: Query<&Transform, With<Player>>,
    weapons: Query<&dolomite::logic::Weapon>,
    mut actions: MessageWriter<Action>,
) {
    let Ok(player) = players.get(cast.player) else {
        return;
    };
    let s = &level.file.soldiers;
    at_leaf(batch, &mut agents, |agent, soldier, at, values| {
        let Some(goal) = remembered(values) else {
            return Status::Failure;
        };
        let sees = values.number(keys.sees) > 0.5;
        let far = at.translation.distance(player.translation);
        let near = sees && far < STANDS;
        soldier.wish = Wish {
            goal: (!near).then_some(goal),
            speed: s.run,
            face: sees.then(|| ground_of(player)),
        };
        let ready = weapons
            .get(agent)
            .is_ok_and(|weapon| clock.step >= weapon.ready);
        if sees && ready && far <= s.range {
            let spread = s.spread.to_radians();
            let muzzle = at.translation + SHOULDER;
            let aim = lead(muzzle, player.translation, far, Vec2::ZERO, s.bolt);
            let turn = Quat::from_rotation_y(soldier.random.signed(spread))
                * Quat::from_axis_angle(
                    Vec3::Y.cross(aim).try_normalize().unwrap_or(Vec3::X),
                    soldier.random.signed(spread / 2.0),
                );
            actions.write(Action::new(agent, Key::FIRE, turn * aim));
        }
        Status::Running
    });
}
