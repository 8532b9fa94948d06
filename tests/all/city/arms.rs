//! Bolts hit who is aimed at, and no house lets one through.

use super::{before_a_soldier, rounds};
use crate::support::game::{look, quiet, steps};
use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite::logic::Health;
use dolomite_game::bot::game::Game;
use dolomite_game::input::PlayerInput;
use dolomite_game::level::begin;
use dolomite_game::level::parts::Fallen;

#[test]
fn two_bolts_fell_a_soldier_and_there_are_twelve() {
    let mut game = quiet("city", 2);
    let soldier = before_a_soldier(&mut game, 12.0);
    let fire = PlayerInput {
        fire: true,
        ..default()
    };
    let mut shots = 0;
    for _ in 0..5 * 60 {
        game.step(fire);
        shots = shots.max(12 - rounds(&game));
        if game.app.world().get::<Fallen>(soldier).is_some() {
            break;
        }
    }
    assert!(game.app.world().get::<Fallen>(soldier).is_some());
    // Who is hit turns and walks: a third bolt may be needed.
    assert!((2..=4).contains(&shots), "{shots}");
    assert_eq!(game.state().fallen, 1);
    let place = |game: &Game| {
        let at = game.app.world().get::<Transform>(soldier);
        at.expect("it lies there").translation
    };
    let fell = place(&game);
    steps(&mut game, fire, 20 * 60);
    assert_eq!(place(&game), fell, "who fell goes nowhere");
    assert_eq!(rounds(&game), 0);
    // Shots are heard, and others may have come and been hit; nobody falls twice.
    let world = game.app.world_mut();
    let lying = world.query::<&Fallen>().iter(world).count();
    assert_eq!(game.state().fallen as usize, lying);
}

#[test]
fn no_bolt_passes_a_house() {
    let mut game = quiet("city", 2);
    let soldier = before_a_soldier(&mut game, 12.0);
    // On the other side of the block: houses stand between.
    let world = game.app.world_mut();
    let mut at = world
        .get_mut::<Transform>(soldier)
        .expect("it is somewhere");
    (at.translation.x, at.translation.z) = (32.0, 44.0);
    begin::put_figure(world, DVec2::new(0.5, 44.0), 0.0, 0.0);
    look(&mut game, Vec2::X);
    let fire = PlayerInput {
        fire: true,
        ..default()
    };
    for _ in 0..10 {
        // It stays there.
        let world = game.app.world_mut();
        let mut at = world
            .get_mut::<Transform>(soldier)
            .expect("it is somewhere");
        (at.translation.x, at.translation.z) = (32.0, 44.0);
        steps(&mut game, fire, 30);
    }
    assert!(rounds(&game) < 12, "it shot");
    let health = game.app.world().get::<Health>(soldier).expect("it lives");
    assert_eq!(health.part(), 1.0);
}
