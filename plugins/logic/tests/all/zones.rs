//! Zones: who comes and goes, however fast, and what becomes of zones themselves.

use crate::support::{app, said, steps};
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::math::{DVec3, Vec3};
use bevy::transform::components::Transform;
use dolomite_logic::parts::{ZoneKind, ZoneMessage, crossing};
use dolomite_logic::random::Random;
use dolomite_logic::{Collector, Key, Names, PickUp, Values, Visitor, Zone};

fn zone(app: &mut App, x: f32, half: f32) -> Entity {
    let place = Transform::from_xyz(x, 0.0, 0.0);
    let zone = Zone::new(Vec3::splat(half));
    app.world_mut().spawn((zone, place)).id()
}

fn resize(app: &mut App, zone: Entity, half: Vec3) {
    let mut zone = app.world_mut().get_mut::<Zone>(zone);
    zone.as_mut().expect("the test made it so").half_size = half;
}

#[test]
fn a_zone_that_is_new_or_changes_its_size_says_who_is_in_it() {
    let mut app = app();
    let place = Transform::from_xyz(3.0, 0.0, 0.0);
    app.world_mut().spawn((Visitor::default(), place));
    steps(&mut app, 2);
    let (new, off) = (zone(&mut app, 3.0, 1.0), zone(&mut app, 0.0, 1.0));
    steps(&mut app, 2);
    assert_eq!(said(&mut app), [(new, Key::ENTERED)]);
    resize(&mut app, off, Vec3::splat(5.0));
    steps(&mut app, 2);
    assert_eq!(said(&mut app), [(off, Key::ENTERED)], "it grew");
    resize(&mut app, off, Vec3::splat(4.0));
    steps(&mut app, 2);
    assert_eq!(said(&mut app), [], "who stays in it has not left");
    resize(&mut app, off, Vec3::splat(2.0));
    steps(&mut app, 2);
    assert_eq!(said(&mut app), [(off, Key::LEFT)], "it shrank");
    for size in [Vec3::NEG_ONE, Vec3::NAN, Vec3::INFINITY] {
        resize(&mut app, new, size);
        steps(&mut app, 2);
        assert_eq!(said(&mut app), [(new, Key::LEFT)], "{size} holds nobody");
        resize(&mut app, new, Vec3::ONE);
        steps(&mut app, 2);
        assert_eq!(said(&mut app), [(new, Key::ENTERED)], "after {size}");
    }
}

#[test]
fn a_zone_that_is_nowhere_is_where_it_was() {
    let mut app = app();
    app.world_mut().spawn(Visitor::default());
    let zone = zone(&mut app, 0.0, 1.0);
    steps(&mut app, 1);
    assert_eq!(said(&mut app), [(zone, Key::ENTERED)]);
    for (x, expected) in [
        (f32::NAN, None),
        (9.0, Some(Key::LEFT)),
        (f32::NAN, None),
        (0.5, Some(Key::ENTERED)),
    ] {
        let mut at = app.world_mut().get_mut::<Transform>(zone);
        at.as_mut().expect("the test made it so").translation.x = x;
        steps(&mut app, 2);
        let expected: Vec<_> = expected.map(|name| (zone, name)).into_iter().collect();
        assert_eq!(said(&mut app), expected, "{x}");
    }
}

#[test]
fn what_comes_to_lie_where_somebody_stands_is_taken() {
    let mut app = app();
    let coins = app.world_mut().resource_mut::<Names>().intern("coins");
    let who = app.world_mut().spawn(Collector).id();
    steps(&mut app, 3);
    app.world_mut().spawn(PickUp::new(coins, 3));
    steps(&mut app, 1);
    let values = app.world().get::<Values>(who);
    assert_eq!(values.expect("it has some").read::<i32>(coins), Some(3));
}

#[test]
fn who_or_what_is_gone_has_left() {
    let mut app = app();
    let zone = app.world_mut().spawn(Zone::new(Vec3::ONE)).id();
    let who = app.world_mut().spawn(Visitor::default()).id();
    app.world_mut()
        .spawn((Zone::new(Vec3::NAN), Transform::default()));
    app.world_mut()
        .spawn((Visitor::default(), Transform::from_translation(Vec3::NAN)));
    app.update();
    assert_eq!(said(&mut app), [(zone, Key::ENTERED)]);
    app.world_mut().despawn(who);
    steps(&mut app, 2);
    assert_eq!(said(&mut app), [(zone, Key::LEFT)]);
    // A zone that moves over somebody is entered as well.
    let who = app
        .world_mut()
        .spawn((Visitor::default(), Transform::from_xyz(5.0, 0.0, 0.0)))
        .id();
    app.update();
    app.world_mut()
        .get_mut::<Transform>(zone)
        .expect("the test made it so")
        .translation
        .x = 10.0;
    app.update();
    assert_eq!(said(&mut app), [(zone, Key::ENTERED), (zone, Key::LEFT)]);
    app.world_mut().despawn(who);
}

#[test]
fn zone_messages_of_a_step_come_in_order() {
    let mut app = app();
    let (far, near) = (zone(&mut app, 9.0, 1.0), zone(&mut app, 5.0, 1.0));
    let who = app.world_mut().spawn(Visitor::default()).id();
    app.update();
    app.world_mut()
        .get_mut::<Transform>(who)
        .expect("the test made it so")
        .translation
        .x = 16.0;
    app.update();
    let messages = app
        .world_mut()
        .resource_mut::<Messages<ZoneMessage>>()
        .drain()
        .collect::<Vec<_>>();
    let all: Vec<_> = messages
        .iter()
        .map(|m| (m.zone, m.kind, m.time * 16.0))
        .collect();
    let (enter, leave) = (ZoneKind::Enter, ZoneKind::Leave);
    assert_eq!(
        all,
        [
            (near, enter, 4.0),
            (near, leave, 6.0),
            (far, enter, 8.0),
            (far, leave, 10.0)
        ]
    );
}

/// A million steps of 0.1 to 1000 m/s through boxes: entries and exits take turns, and come in the order that f64 has.
#[test]
fn zones_miss_nobody_and_count_nobody_twice() {
    let mut random = Random::new(11);
    let (mut events, mut passed) = (0_u32, 0_u32);
    for _ in 0..20_000 {
        let place = |random: &mut Random| {
            DVec3::new(
                f64::from(random.signed(4.0)),
                f64::from(random.signed(4.0)),
                f64::from(random.signed(4.0)),
            )
        };
        let half = place(&mut random).abs();
        let mut at = place(&mut random);
        let mut inside = at.abs().cmple(half).all();
        for _ in 0..50 {
            // Metres a step, from 0.1 m/s to 1000 m/s, mostly towards the box.
            let speed = 0.1 * f64::from(bevy::math::ops::powf(10_000.0, random.unit())) / 64.0;
            let aim = (place(&mut random) - at).normalize_or(DVec3::X);
            let next = at + aim * speed;
            let found = crossing(at, next, half, false);
            let mut time = 0.0;
            for (kind, when) in found.into_iter().flatten() {
                events += 1;
                assert!((time..=1.0).contains(&when), "{when} after {time}");
                time = when;
                assert_eq!(
                    kind == ZoneKind::Enter,
                    !inside,
                    "entries and exits take turns"
                );
                inside = !inside;
                // The reference: there the way is on the box's side, in f64.
                let over = (at.lerp(next, when).abs() - half).max_element();
                assert!(over.abs() < 1e-9, "{over}");
            }
            passed += u32::from(found[1].is_some());
            assert_eq!(inside, next.abs().cmple(half).all());
            // A thousand places on the way are outside, or there was an event.
            if found[0].is_none() && !inside {
                for part in 0..8 {
                    let middle = at.lerp(next, f64::from(part) / 8.0);
                    assert!(!middle.abs().cmplt(half - 1e-9).all(), "missed");
                }
            }
            at = next;
        }
    }
    println!("{events} events, {passed} of them passages within a step");
    assert!(events > 40_000 && passed > 1000, "{events} {passed}");
}
