//! Shots: swept, stopped by walls, hit and spare whom they say.

use crate::support::{act, app, said, steps};
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::math::{DVec3, Vec3};
use bevy::transform::components::Transform;
use dolomite_logic::parts::{Shot, Shots};
use dolomite_logic::rays::BoxRays;
use dolomite_logic::{Health, Hitbox, Key, RayWorld, Team, Weapon};
use std::sync::Arc;

fn get<C: Component + Clone>(app: &App, entity: Entity) -> C {
    app.world().get::<C>(entity).expect("it has one").clone()
}

fn duel(app: &mut App, weapon: Weapon, wall: bool) -> (Entity, Entity) {
    if wall {
        let low = Vec3::new(45.0, -9.0, -9.0);
        let rays = BoxRays::new([[low, Vec3::new(45.1, 9.0, 9.0)]], 8.0);
        app.insert_resource(RayWorld(Arc::new(rays)));
    }
    let shooter = (weapon, Team(1), Hitbox::default());
    let shooter = app.world_mut().spawn(shooter).id();
    let place = Transform::from_xyz(90.0, 0.0, 0.0);
    let target = (Health::default(), Team(2), Hitbox::default(), place);
    let target = app.world_mut().spawn(target).id();
    app.update();
    act(app, shooter, Key::FIRE, target);
    (shooter, target)
}

#[test]
fn shots_sweep_and_walls_stop_them() {
    for speed in [30.0, 400.0, 1e5, f32::INFINITY] {
        for wall in [false, true] {
            let mut app = app();
            let weapon = Weapon {
                speed,
                gravity: 0.0,
                ..Weapon::default()
            };
            let (_, target) = duel(&mut app, weapon, wall);
            steps(&mut app, 64 * 4);
            let left = get::<Health>(&app, target).now;
            assert_eq!(left, if wall { 100.0 } else { 75.0 }, "{speed} {wall}");
            assert!(app.world().resource::<Shots>().0.is_empty());
        }
    }
}

#[test]
fn shots_spare_the_own_team_fall_and_run_out() {
    let mut app = app();
    let weapon = Weapon {
        rounds: Some(2),
        interval: 0.0,
        ..Weapon::default()
    };
    let (shooter, target) = duel(&mut app, weapon, false);
    let place = Transform::from_xyz(30.0, 0.0, 0.0);
    let friend = (Health::default(), Team(1), Hitbox::default(), place);
    let friend = app.world_mut().spawn(friend).id();
    // 90 m at 400 m/s are 0.225 s, in which a shot falls 0.25 m: it hits the capsule of 0.9 m.
    steps(&mut app, 64);
    assert_eq!(get::<Health>(&app, friend).now, 100.0);
    assert_eq!(get::<Health>(&app, target).now, 75.0);
    for toward in [Vec3::ZERO, Vec3::NAN] {
        act(&mut app, shooter, Key::FIRE, toward);
    }
    act(&mut app, shooter, Key::FIRE, Vec3::NEG_X);
    steps(&mut app, 2);
    act(&mut app, shooter, Key::FIRE, Vec3::NEG_X);
    steps(&mut app, 1);
    let names: Vec<Key> = said(&mut app).iter().map(|said| said.1).collect();
    assert!(names.ends_with(&[Key::EMPTY]), "{names:?}");
    act(&mut app, shooter, Key::RELOAD, ());
    steps(&mut app, 1);
    assert_eq!(get::<Weapon>(&app, shooter).rounds, Some(30));
    // Bad numbers: no shot.
    steps(&mut app, 64 * 3);
    app.world_mut()
        .get_mut::<Weapon>(shooter)
        .expect("the test made it so")
        .range = f32::NAN;
    act(&mut app, shooter, Key::FIRE, Vec3::X);
    steps(&mut app, 1);
    assert!(app.world().resource::<Shots>().0.is_empty());
}

#[test]
fn a_shot_turns_at_the_top_of_its_way() {
    let mut app = app();
    let weapon = Weapon {
        speed: 10.0,
        gravity: 64.0,
        ..Weapon::default()
    };
    let shooter = app.world_mut().spawn(weapon).id();
    act(&mut app, shooter, Key::FIRE, Vec3::Y);
    // A metre a second slower in each step.
    steps(&mut app, 10);
    let top = app.world().resource::<Shots>().0[0];
    assert_eq!(top.velocity.y, 0.0);
    steps(&mut app, 3);
    let falls = app.world().resource::<Shots>().0[0];
    assert!(falls.velocity.y == -3.0 && falls.place.y < top.place.y);
    // Nothing turns what has no weight.
    app.world_mut().resource_mut::<Shots>().0[0] = Shot {
        velocity: DVec3::ZERO,
        gravity: 0.0,
        ..falls
    };
    steps(&mut app, 1);
    assert!(app.world().resource::<Shots>().0.is_empty());
}

#[test]
fn a_body_without_a_height_is_hit_by_nothing() {
    for (height, left) in [(-5.0, 100.0), (0.0, 100.0), (1.8, 75.0)] {
        let mut app = app();
        let (_, target) = duel(&mut app, Weapon::default(), false);
        let body = Hitbox::new(0.3, height);
        app.world_mut().entity_mut(target).insert(body);
        steps(&mut app, 64);
        assert_eq!(get::<Health>(&app, target).now, left, "{height}");
    }
}
