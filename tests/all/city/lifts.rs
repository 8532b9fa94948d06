//! Lifts carry whoever rides, and nobody is crushed or thrown; falls hurt.

use super::{above, roof};
use crate::support::game::{act, health, look, put, quiet, steps};
use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite::logic::parts::{Lift, LiftState};
use dolomite::logic::{Action, Button, Key};
use dolomite_game::bot::game::Game;
use dolomite_game::input::PlayerInput;
use dolomite_game::level::Verdict;
use dolomite_game::level::lifts::{Panel, RoofLift};
use dolomite_game::level::parts::{Cast, Numbered, ground_of};
use dolomite_game::level::town::PLATE;
use dolomite_game::play::figure::Figure;

fn lift(game: &mut Game, number: u32) -> Lift {
    let world = game.app.world_mut();
    let mut lifts = world.query_filtered::<(&Numbered, &Lift), With<RoofLift>>();
    let mut found = lifts.iter(world).filter(|(own, _)| own.0 == number);
    found.next().expect("it has a lift").1.clone()
}

#[test]
fn a_lift_is_called_ridden_and_sent_away() {
    let mut game = quiet("city", 1);
    let roof = roof(&game, 0);
    put(&mut game, roof.shaft, 0.5);
    steps(&mut game, PlayerInput::default(), 60);
    assert!(
        (above(&mut game) - 0.05).abs() < 0.03,
        "it stands on the plate"
    );
    let world = game.app.world();
    let button = game.state().button.expect("the button of the plate");
    assert_eq!(world.get::<Panel>(button), Some(&Panel::Rides));
    // Held for long it is pressed once.
    let mut highest = 0.0_f64;
    for step in 0..20 * 60 {
        game.step(if step < 90 {
            act()
        } else {
            PlayerInput::default()
        });
        highest = highest.max(above(&mut game));
    }
    let world = game.app.world_mut();
    let presses = world.get::<Button>(button).expect("it is there").presses;
    assert_eq!(presses, 1);
    let top = f64::from(roof.floors[1] - roof.floors[0]) + 0.05;
    assert!(
        (above(&mut game) - top).abs() < 0.05,
        "{}",
        above(&mut game)
    );
    assert!(
        highest < top + 0.05,
        "{highest}: it is carried, and not thrown"
    );
    // Over the bridge, without a fall.
    look(&mut game, -roof.out);
    let north = PlayerInput {
        walk: Vec2::Y,
        ..default()
    };
    for _ in 0..4 * 60 {
        game.step(north);
        assert!(above(&mut game) > top - 0.1, "it fell");
    }
    let player = game.app.world().resource::<Cast>().player;
    let at = game.app.world().get::<Transform>(player).expect("it is");
    let place = ground_of(at);
    assert!(place.distance(roof.middle()) < 4.5, "{place} on the roof");
    // The parapet holds whoever runs against it.
    for (way, count) in [(roof.along(), 180), (-roof.along(), 300), (-roof.out, 180)] {
        look(&mut game, way);
        steps(
            &mut game,
            PlayerInput {
                fast: true,
                jump: count % 7 == 0,
                ..north
            },
            count,
        );
        assert!(above(&mut game) > top - 0.1, "over the parapet");
    }
    // From below it is called down, and comes.
    put(&mut game, roof.before(), 0.0);
    steps(&mut game, PlayerInput::default(), 5);
    let button = game.state().button.expect("the button on the street");
    assert_eq!(game.app.world().get::<Panel>(button), Some(&Panel::Calls));
    steps(&mut game, act(), 1);
    steps(&mut game, PlayerInput::default(), 20 * 60);
    let lift = lift(&mut game, 0);
    assert_eq!(lift.state(), LiftState::Idle);
    assert!((lift.height() + PLATE.y - roof.floors[0]).abs() < 1e-3);
    assert!((health(&game) - 100.0).abs() < 1e-3, "nobody was hurt");
}

#[test]
fn who_stands_below_a_lift_that_comes_down_stays_on_the_ground() {
    let mut game = quiet("city", 1);
    let roof = roof(&game, 0);
    let world = game.app.world_mut();
    let mut lifts = world.query_filtered::<(&Numbered, Entity), With<RoofLift>>();
    let (_, entity) = lifts
        .iter(world)
        .find(|(number, _)| number.0 == 0)
        .expect("it has a lift");
    world.write_message(Action::new(entity, Key::CALL, 1));
    steps(&mut game, PlayerInput::default(), 20 * 60);
    put(&mut game, roof.shaft, 0.0);
    game.app
        .world_mut()
        .write_message(Action::new(entity, Key::CALL, 0));
    for _ in 0..20 * 60 {
        game.step(PlayerInput::default());
        let above = above(&mut game);
        assert!((0.0..0.5).contains(&above), "{above}");
        let world = game.app.world_mut();
        let figure = world.query::<&Figure>().single(world);
        let place = figure.expect("there is one figure").now.place;
        assert!(place.is_finite() && place.distance(roof.shaft.as_dvec2()) < 3.0);
    }
    // And walks away from there.
    look(&mut game, roof.out);
    let north = PlayerInput {
        walk: Vec2::Y,
        ..default()
    };
    steps(&mut game, north, 180);
    let world = game.app.world_mut();
    let figure = world.query::<&Figure>().single(world);
    let place = figure.expect("there is one figure").now.place.as_vec2();
    assert!(place.distance(roof.shaft) > 2.0, "{place}");
}

#[test]
fn a_fall_from_a_roof_hurts_and_a_leap_does_not() {
    let mut game = quiet("city", 1);
    let jump = PlayerInput {
        jump: true,
        ..default()
    };
    game.step(jump);
    steps(&mut game, PlayerInput::default(), 120);
    assert_eq!(health(&game), 100.0);
    let place = DVec2::new(50.0, -78.0).as_vec2();
    // From h metres one lands at sqrt(2 g h): 8.86 m/s from 4 m, which takes (8.86 - 7) · 18 = 33.
    put(&mut game, place, 4.0);
    steps(&mut game, PlayerInput::default(), 60);
    let hurt = 100.0 - health(&game);
    // It lands within a step, in which speed grows by 9.81 / 60 m/s, which take 2.9; the rest is rounding.
    assert!((hurt - 33.4).abs() < 3.1, "{hurt}");
    put(&mut game, place, 14.0);
    steps(&mut game, PlayerInput::default(), 150);
    assert_eq!(game.state().verdict, Some(Verdict::Fell));
}
