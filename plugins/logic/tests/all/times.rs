//! Times that are long, endless, or none.

use crate::support::{act, app, said, steps};
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::transform::components::Transform;
use dolomite_logic::parts::Shots;
use dolomite_logic::{
    Button, Collector, DayClock, Key, LogicTimer, Names, PickUp, Weapon, Wire, Wires,
};

/// Of 60 steps a second: no f32 is a sixtieth.
const STEP: f32 = 1.0 / 60.0;

/// After how many steps a timer elapses.
fn lasts(mut timer: LogicTimer, step: f32) -> Option<u32> {
    (1..1_000_000).find(|_| timer.advance(step))
}

#[test]
fn an_hour_and_a_week_of_small_steps_are_as_long_as_they_say() {
    let hour = lasts(LogicTimer::once(3600.0), STEP).expect("it elapses");
    assert!(hour.abs_diff(216_000) <= 2, "{hour}");
    // The last hundred seconds of a week, where f32 has a digit for each sixteenth of a second.
    let mut week = LogicTimer::once(604_800.0);
    week.passed = 604_700.0;
    let last = lasts(week, 1.0 / 64.0).expect("it elapses");
    assert!(last.abs_diff(6400) <= 4, "{last}");
}

#[test]
fn a_day_in_its_own_time_goes_as_fast_as_the_sun() {
    let mut day = DayClock::new(16.0, 1.0 / 3600.0);
    for _ in 0..60 * 3600 {
        day.advance(STEP);
    }
    assert!((day.hour - 17.0).abs() < 1e-3, "{}", day.hour);
    let mut back = DayClock::new(0.5, -1.0 / 3600.0);
    for _ in 0..60 * 3600 {
        back.advance(STEP);
    }
    assert!((back.hour - 23.5).abs() < 1e-3, "{}", back.hour);
}

#[test]
fn what_is_endless_does_not_end_at_once() {
    let mut app = app();
    let last = app.world_mut().spawn(Button::default()).id();
    let wire = Wire::new(Key::PRESSED, last, Key::PRESS).after(f32::INFINITY);
    let button = Button {
        pause: f32::INFINITY,
        ..Button::default()
    };
    let wires = Wires(vec![wire]);
    let first = app.world_mut().spawn((button, wires)).id();
    for _ in 0..100 {
        act(&mut app, first, Key::PRESS, ());
        steps(&mut app, 1);
    }
    assert_eq!(said(&mut app), [(first, Key::PRESSED)]);
}

#[test]
fn a_weapon_whose_times_are_no_numbers_does_not_shoot() {
    for (interval, reload) in [
        (f32::NAN, 2.0),
        (f32::INFINITY, 2.0),
        (0.2, f32::NAN),
        (0.2, f32::INFINITY),
    ] {
        let mut app = app();
        let weapon = Weapon {
            interval,
            reload,
            ..Weapon::default()
        };
        let weapon = app.world_mut().spawn(weapon).id();
        act(&mut app, weapon, Key::FIRE, Vec3::X);
        steps(&mut app, 1);
        assert!(app.world().resource::<Shots>().0.is_empty());
        assert_eq!(said(&mut app), []);
    }
}

#[test]
fn what_is_there_again_at_once_is_there_in_the_next_step() {
    let mut app = app();
    let coins = app.world_mut().resource_mut::<Names>().intern("coins");
    let at = |x: f32| Transform::from_xyz(x, 0.0, 0.0);
    let mut spawn = |again: f32| {
        let again = Some(again);
        let one = PickUp {
            again,
            ..PickUp::new(coins, 1)
        };
        app.world_mut().spawn((one, at(0.0))).id()
    };
    let zero = spawn(0.0);
    let never = [f32::NAN, -1.0, f32::INFINITY].map(&mut spawn);
    app.world_mut().spawn((Collector, at(0.0)));
    steps(&mut app, 1);
    let there = |app: &bevy::app::App, one: Entity| {
        app.world().get::<PickUp>(one).expect("it has one").there
    };
    assert!(!there(&app, zero));
    steps(&mut app, 1);
    assert!(there(&app, zero));
    steps(&mut app, 100);
    assert!(never.iter().all(|one| !there(&app, *one)));
}
