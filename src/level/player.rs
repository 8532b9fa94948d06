//! The player as logic knows them: where the figure is, what is heard of it, how it falls and gets well, what it
//! lights.

use bevy::prelude::*;
use dolomite::logic::senses::Noise;
use dolomite::logic::{Action, Health, Key, Lamp, LogicClock, Output};

use super::parts::{Beacon, Cast, Level, LevelKeys, LevelState, MIDDLE, Player, ground_of};
use crate::input::PlayerInput;
use crate::play::figure::Figure;
use crate::play::jump::Jump;

/// Faster than this, metres a second, one runs.
const RUNS: f32 = 2.6;

/// Metres between two noises of steps.
const STRIDE: f32 = 1.5;

/// Seconds in which the heat of a torch that is taken away is gone, as a part of those in which it came.
const COOLS: f32 = 2.0;

/// Who looks about within this distance sees a beacon flare up, metres.
const FLARE: f32 = 60.0;

/// A beacon that is higher or lower by more than this is on another storey, metres: the lowest roofs are twice as high,
/// and on the steepest slope that one walks it is more than a torch reaches.
const STOREY: f32 = 4.0;

/// The fastest landing that knees bear, metres a second: from 2.5 m.
const BEARS: f32 = 7.0;

/// The player is where the figure is; steps are heard.
pub(super) fn follow(
    level: Res<Level>,
    cast: Res<Cast>,
    clock: Res<LogicClock>,
    figures: Query<&Figure>,
    mut players: Query<(&mut Player, &mut Transform)>,
    mut noises: MessageWriter<Noise>,
    mut actions: MessageWriter<Action>,
) {
    let (Some(figure), Ok((mut player, mut at))) =
        (figures.iter().next(), players.get_mut(cast.player))
    else {
        return;
    };
    let place = figure.now.place.as_vec2();
    let way = place.distance(ground_of(&at));
    let height = level.grid.height(place) + figure.now.jump.lift() as f32 + MIDDLE;
    at.translation = Vec3::new(place.x, height, place.y);
    player.unhurt += clock.delta;
    player.stepped += way;
    match figure.now.jump {
        Jump::Air { rise, .. } => player.sinks = (-rise).max(0.0),
        Jump::None | Jump::On { .. } | Jump::Bending { .. } => {
            let hurts = (player.sinks - BEARS).max(0.0) * level.file.falls;
            if hurts > 0.0 {
                actions.write(Action::new(cast.player, Key::DAMAGE, hurts));
            }
            player.sinks = 0.0;
        }
    }
    if player.stepped < STRIDE {
        return;
    }
    player.stepped = 0.0;
    let s = &level.file.soldiers;
    let runs = figure.now.velocity.length() > RUNS;
    noises.write(Noise {
        place: at.translation,
        range: if runs { s.hears_run } else { s.hears_walk },
        source: Some(cast.player),
    });
}

/// Who was not hit for a while gets well.
pub(super) fn mend(
    level: Res<Level>,
    cast: Res<Cast>,
    clock: Res<LogicClock>,
    mut outputs: MessageReader<Output>,
    mut players: Query<(&mut Player, &Health)>,
    mut actions: MessageWriter<Action>,
) {
    let Ok((mut player, health)) = players.get_mut(cast.player) else {
        return;
    };
    let hurts = |output: &Output| output.source == cast.player && output.name == Key::HURT;
    if outputs.read().any(hurts) {
        player.unhurt = 0.0;
    }
    if player.unhurt >= level.file.rests && health.is_alive() && health.part() < 1.0 {
        let amount = level.file.mends * clock.delta;
        actions.write(Action::new(cast.player, Key::HEAL, amount));
    }
}

/// A torch is held to the beacon in reach.
pub(super) fn kindle(
    level: Res<Level>,
    cast: Res<Cast>,
    keys: Res<LevelKeys>,
    clock: Res<LogicClock>,
    input: Res<PlayerInput>,
    mut state: ResMut<LevelState>,
    players: Query<(&Transform, &Health), With<Player>>,
    mut beacons: Query<(Entity, &mut Beacon, &mut Lamp, &Transform), Without<Player>>,
    mut outputs: MessageWriter<Output>,
    mut noises: MessageWriter<Noise>,
) {
    let Ok((player, health)) = players.get(cast.player) else {
        return;
    };
    state.near = None;
    state.lit = 0;
    for (entity, mut beacon, mut lamp, at) in &mut beacons {
        if lamp.lit {
            state.lit += 1;
            continue;
        }
        let storey = (player.translation.y - MIDDLE - at.translation.y).abs() < STOREY;
        let near = storey && ground_of(at).distance(ground_of(player)) <= level.file.reach;
        if near {
            state.near = Some(entity);
        }
        if near && input.act && health.is_alive() {
            beacon.kindled += clock.delta;
        } else if beacon.kindled > 0.0 {
            beacon.kindled = (beacon.kindled - COOLS * clock.delta).max(0.0);
        }
        if beacon.kindled >= level.file.hold {
            lamp.lit = true;
            state.lit += 1;
            outputs.write(Output::new(entity, keys.kindled, ()));
            noises.write(Noise {
                place: at.translation,
                range: FLARE,
                source: None,
            });
        }
    }
}
