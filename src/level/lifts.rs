//! Lifts to roofs: a plate, a bridge to the roof, and three buttons: on the street, on the bridge, on the plate.
//!
//! The lifts are those of `dolomite_logic`, which follow buttons by wires; their plates are blockers, which carry who
//! stands on them.

use bevy::prelude::*;
use dolomite::collision::Blocker;
use dolomite::logic::parts::Lift;
use dolomite::logic::{Action, Button, Health, Key, Value, Wire, Wires};

use super::parts::{Cast, Level, LevelPart, LevelState, MIDDLE, Numbered, Player, ground_of};
use super::town::{PLATE, Roof};
use crate::input::PlayerInput;

/// A button is pressed from no farther away than this, metres: an arm's length.
const ARM: f32 = 1.5;

/// And the button of a plate by whoever stands on it: from corner to corner, and as much higher or lower as the plate
/// is while it moves, metres.
const ON_PLATE: f32 = 2.6;

/// Seconds that a lift stands at a floor before it goes on.
const WAITS: f32 = 0.8;

/// Height of buttons above what one stands on, metres.
const BUTTON: f32 = 1.1;

/// A plate that goes up to a roof. Its [`Numbered`] is that of the beacon on that roof.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[require(LevelPart, Numbered)]
pub struct RoofLift {
    /// The button on the plate.
    pub cabin: Entity,
}

/// A button of a lift.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[require(LevelPart, Numbered)]
pub enum Panel {
    /// Calls the lift to the street, or up to the roof.
    Calls,
    /// On the plate: to the other floor.
    Rides,
}

/// A bridge, a rail or a wall of the level's own. Its half size is that of its [`Blocker`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[require(LevelPart)]
pub struct Wall;

/// Where the buttons of a roof's lift hang: on the street, on the bridge, and on the plate at a height of its top.
pub fn buttons(roof: &Roof, top: f32) -> [Vec3; 3] {
    let place = |inwards: f32, along: f32, y: f32| {
        let at = roof.shaft - roof.out * inwards + roof.along() * along;
        Vec3::new(at.x, y + BUTTON, at.y)
    };
    let side = PLATE.x;
    [
        place(0.0, side + 0.35, roof.floors[0]),
        place(side + 0.5, side - 0.12, roof.floors[1]),
        place(side - 0.1, -(side - 0.1), top),
    ]
}

/// Walls, bridges and lifts of a level.
pub(super) fn spawn(world: &mut World, level: &Level) {
    for [low, high] in &level.built.solids {
        world.spawn((
            Wall,
            Blocker {
                half_size: (*high - *low) / 2.0,
            },
            Transform::from_translation((*low + *high) / 2.0),
        ));
    }
    for (number, roof) in (0..).zip(&level.built.roofs) {
        let Some(roof) = roof else {
            continue;
        };
        let mut lift = roof.lift.clone();
        lift.waiting = WAITS;
        let cabin = world.spawn_empty().id();
        let place = Vec3::new(roof.shaft.x, lift.height(), roof.shaft.y);
        let lift = world.spawn((
            RoofLift { cabin },
            Numbered(number),
            lift,
            Blocker { half_size: PLATE },
            Transform::from_translation(place),
        ));
        let lift = lift.id();
        let wires = || Wires(vec![Wire::new(Key::PRESSED, lift, Key::CALL)]);
        let [low, high, on] = buttons(roof, roof.floors[0]);
        for (floor, place) in [(0, low), (1, high)] {
            let at = Transform::from_translation(place);
            let number = Numbered(number);
            world.spawn((Panel::Calls, number, Button::new(floor), at, wires()));
        }
        let at = Transform::from_translation(on);
        let mut cabin = world.entity_mut(cabin);
        let number = Numbered(number);
        cabin.insert((Panel::Rides, number, Button::new(1), at, wires()));
    }
}

/// The button of a plate goes with it, and leads to the other floor.
pub(super) fn carry(
    level: Res<Level>,
    lifts: Query<(&RoofLift, &Lift, &Numbered)>,
    mut buttons: Query<(&mut Button, &mut Transform)>,
) {
    for (parts, lift, number) in &lifts {
        let roof = level.built.roofs.get(number.0 as usize);
        let (Some(Some(roof)), Ok((mut button, mut at))) = (roof, buttons.get_mut(parts.cabin))
        else {
            continue;
        };
        let other = Value::Int(i32::from(lift.floor() == 0));
        if button.parameter != other {
            button.parameter = other;
        }
        let [.., place] = self::buttons(roof, lift.height() + PLATE.y);
        if at.translation != place {
            at.translation = place;
        }
    }
}

/// The player presses the button in reach: who stands on a plate that of the plate, else the nearest.
pub(super) fn press(
    level: Res<Level>,
    cast: Res<Cast>,
    input: Res<PlayerInput>,
    mut state: ResMut<LevelState>,
    mut players: Query<(&mut Player, &Transform, &Health)>,
    buttons: Query<(Entity, &Panel, &Numbered, &Transform), Without<Player>>,
    mut actions: MessageWriter<Action>,
) {
    let Ok((mut player, at, health)) = players.get_mut(cast.player) else {
        return;
    };
    let begins = input.act && !player.acts;
    if player.acts != input.act {
        player.acts = input.act;
    }
    // Hands are about as high as buttons hang.
    let hand = at.translation + Vec3::Y * (BUTTON - MIDDLE);
    let roof = |number: &Numbered| level.built.roofs.get(number.0 as usize)?.as_ref();
    let on_plate = |number| roof(number).is_some_and(|roof| roof.on_plate(ground_of(at)));
    let reached = buttons
        .iter()
        .map(|(button, panel, number, at)| {
            let calls = *panel == Panel::Calls;
            let far = at.translation.distance(hand);
            let near = far <= if calls { ARM } else { ON_PLATE };
            (near && (calls || on_plate(number)), calls, far, button)
        })
        .filter(|(near, ..)| *near)
        .min_by(|a, b| a.1.cmp(&b.1).then(a.2.total_cmp(&b.2)).then(a.3.cmp(&b.3)));
    state.button = reached.map(|(.., button)| button);
    // Who holds a torch to a beacon has no hand free.
    if let Some(button) = state.button
        && begins
        && health.is_alive()
        && state.near.is_none()
    {
        actions.write(Action {
            source: cast.player,
            ..Action::new(button, Key::PRESS, ())
        });
    }
}
