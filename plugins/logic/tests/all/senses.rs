//! Who sees and hears whom, beside what all rays say.

use crate::support::{app, milliseconds, steps};
use bevy::ecs::prelude::*;
use bevy::math::{Quat, Vec3, ops};
use bevy::transform::components::Transform;
use dolomite_logic::random::Random;
use dolomite_logic::rays::{BoxRays, Rays};
use dolomite_logic::senses::{
    Ear, Memory, Noise, Sight, SightCounters, SightSettings, TRACES, Visible, in_field,
};
use dolomite_logic::{Asleep, Hitbox, Key, RayWorld, Team, Values};
use std::sync::Arc;

fn turned(x: f32, z: f32, yaw: f32) -> Transform {
    Transform::from_xyz(x, 0.9, z).with_rotation(Quat::from_rotation_y(yaw))
}

#[test]
fn an_enemy_is_seen_in_front_in_range_and_not_behind_a_wall() {
    let mut app = app();
    let wall = [Vec3::new(-5.0, 0.0, -20.0), Vec3::new(5.0, 5.0, -19.0)];
    app.insert_resource(RayWorld(Arc::new(BoxRays::new([wall], 8.0))));
    let guard = app
        .world_mut()
        .spawn((
            Sight::default(),
            Memory::default(),
            Team(1),
            turned(0.0, 0.0, 0.0),
        ))
        .id();
    let enemy = |app: &mut bevy::app::App, x: f32, z: f32, team: u8| {
        app.world_mut()
            .spawn((Visible::default(), Team(team), turned(x, z, 0.0)))
            .id()
    };
    let front = enemy(&mut app, 0.0, -10.0, 2);
    let friend = enemy(&mut app, 1.0, -10.0, 1);
    let hidden = enemy(&mut app, 0.0, -30.0, 2);
    let behind = enemy(&mut app, 0.0, 10.0, 2);
    let far = enemy(&mut app, 40.0, -59.0, 2);
    let nowhere = enemy(&mut app, f32::NAN, 0.0, 2);
    steps(&mut app, 12);
    let sees = |app: &bevy::app::App, who| {
        app.world()
            .get::<Sight>(guard)
            .expect("the test made it so")
            .sees(who)
    };
    assert!(sees(&app, front));
    for other in [friend, hidden, behind, far, nowhere] {
        assert!(!sees(&app, other));
    }
    let values = app
        .world()
        .get::<Values>(guard)
        .expect("the test made it so");
    assert_eq!(values.read::<Entity>(Key::TARGET), Some(front));
    // Between two looks it fades for up to six steps, of 1280 in which all is forgotten.
    assert!(values.number(Key::ALERT) > 1.0 - 6.5 / 1280.0);
    // It comes out from behind the wall, and is seen within 100 ms.
    app.world_mut()
        .get_mut::<Transform>(hidden)
        .expect("the test made it so")
        .translation
        .x = 12.0;
    steps(&mut app, 6);
    assert!(sees(&app, hidden));
    // What is remembered fades.
    for gone in [front, hidden] {
        app.world_mut().despawn(gone);
    }
    steps(&mut app, 64 * 10);
    let alert = app
        .world()
        .get::<Values>(guard)
        .expect("the test made it so")
        .number(Key::ALERT);
    assert!((0.4..0.6).contains(&alert), "{alert}");
    steps(&mut app, 64 * 11);
    assert!(
        app.world()
            .get::<Memory>(guard)
            .expect("the test made it so")
            .traces()
            .is_empty()
    );
    assert_eq!(
        app.world()
            .get::<Values>(guard)
            .expect("the test made it so")
            .number(Key::ALERT),
        0.0
    );
}

#[test]
fn bodies_hide_where_they_are_asked_to() {
    let mut app = app();
    app.insert_resource(SightSettings {
        every: 1,
        bodies: true,
        ..SightSettings::default()
    });
    let guard = app
        .world_mut()
        .spawn((Sight::default(), turned(0.0, 0.0, 0.0)))
        .id();
    let (near, far) = (turned(0.0, -5.0, 0.0), turned(0.0, -9.0, 0.0));
    let eye = Visible {
        offset: Vec3::Y * 0.7,
    };
    let front = app.world_mut().spawn((eye, Hitbox::default(), near)).id();
    let back = app.world_mut().spawn((eye, Hitbox::default(), far)).id();
    steps(&mut app, 3);
    let sight = app
        .world()
        .get::<Sight>(guard)
        .expect("the test made it so");
    assert!(sight.sees(front) && !sight.sees(back));
}

#[test]
fn noises_are_heard_less_through_walls_wake_and_are_remembered() {
    let mut app = app();
    let wall = [Vec3::new(-9.0, 0.0, 4.0), Vec3::new(9.0, 9.0, 5.0)];
    app.insert_resource(RayWorld(Arc::new(BoxRays::new([wall], 8.0))));
    let ear = |app: &mut bevy::app::App, z: f32| {
        app.world_mut()
            .spawn((Ear::default(), Team(1), Asleep, turned(0.0, z, 0.0)))
            .id()
    };
    let [open, walled, far] = [-8.0, 12.0, -30.0].map(|z| ear(&mut app, z));
    let place = Vec3::new(0.0, 0.9, 0.0);
    for range in [20.0, f32::NAN, -3.0] {
        app.world_mut().write_message(Noise {
            place,
            range,
            source: None,
        });
    }
    app.world_mut().write_message(Noise {
        place: Vec3::NAN,
        range: 9.0,
        source: None,
    });
    steps(&mut app, 2);
    let traces = |app: &bevy::app::App, who| {
        app.world()
            .get::<Memory>(who)
            .expect("the test made it so")
            .traces()
            .len()
    };
    assert_eq!(
        (traces(&app, open), traces(&app, walled), traces(&app, far)),
        (1, 0, 0)
    );
    assert!(app.world().get::<Asleep>(open).is_none());
    assert!(app.world().get::<Asleep>(far).is_some());
    // A friend's noise is none.
    app.world_mut().write_message(Noise {
        place,
        range: 90.0,
        source: Some(open),
    });
    steps(&mut app, 2);
    assert_eq!(traces(&app, far), 0);
}

#[test]
fn a_memory_keeps_the_surest() {
    let mut memory = Memory::default();
    for i in 0..20 {
        memory.note(None, Vec3::X * 10.0 * i as f32, (i + 1) as f32 / 20.0);
    }
    memory.note(None, Vec3::NAN, 1.0);
    memory.note(None, Vec3::ZERO, f32::NAN);
    assert_eq!(memory.traces().len(), TRACES);
    assert_eq!(memory.traces()[0].certainty, 1.0);
    assert!(
        memory
            .traces()
            .is_sorted_by(|a, b| a.certainty >= b.certainty)
    );
    memory.note(None, Vec3::X * 190.0, 0.2);
    assert_eq!(memory.traces().len(), TRACES, "the same noise, less sure");
    memory.fades = f32::NAN;
    memory.fade(0.01);
    assert!(memory.traces().is_empty());
}

/// Soldiers of two sides among blocks, who walk and turn: who sees whom, beside a ray for each pair in the field.
#[test]
fn ten_thousand_soldiers_see_as_all_rays_say() {
    let count = 10_000_u32;
    let half = 500.0;
    let mut random = Random::new(5);
    let blocks: Vec<[Vec3; 2]> = (0..800)
        .map(|_| {
            let low = Vec3::new(random.signed(half), 0.0, random.signed(half));
            let size = Vec3::new(
                5.0 + random.unit() * 20.0,
                3.0 + random.unit() * 9.0,
                5.0 + random.unit() * 20.0,
            );
            [low, low + size]
        })
        .collect();
    let rays = Arc::new(BoxRays::new(blocks, 10.0));
    let mut app = app();
    app.insert_resource(RayWorld(Arc::clone(&rays) as Arc<dyn Rays>));
    let soldiers: Vec<(Entity, Vec3, f32)> = (0..count)
        .map(|i| {
            let (x, z, yaw) = (
                random.signed(half),
                random.signed(half),
                random.signed(std::f32::consts::PI),
            );
            let parts = (
                Sight::default(),
                Visible::default(),
                Team((i % 2) as u8),
                turned(x, z, yaw),
            );
            let speed = Vec3::new(random.signed(1.5), 0.0, random.signed(1.5));
            (app.world_mut().spawn(parts).id(), speed, random.signed(0.2))
        })
        .collect();
    let (mut most_rays, mut sight_ms) = (0, Vec::new());
    let mut walk = |app: &mut bevy::app::App| {
        for (entity, speed, turn) in &soldiers {
            let mut transform = app
                .world_mut()
                .get_mut::<Transform>(*entity)
                .expect("the test made it so");
            transform.translation += *speed / 64.0;
            transform.rotation *= Quat::from_rotation_y(*turn / 64.0);
        }
        sight_ms.push(milliseconds(1, || app.update()));
        most_rays = most_rays.max(app.world().resource::<SightCounters>().rays);
    };
    for _ in 0..24 {
        walk(&mut app);
    }
    // The reference: every pair of enemies.
    let all: Vec<(Entity, Vec3, Vec3, u8)> = soldiers
        .iter()
        .map(|(entity, ..)| {
            let at = app
                .world()
                .get::<Transform>(*entity)
                .expect("the test made it so");
            let team = app
                .world()
                .get::<Team>(*entity)
                .expect("the test made it so")
                .0;
            (*entity, at.translation, at.rotation * Vec3::NEG_Z, team)
        })
        .collect();
    let cos = ops::cos(std::f32::consts::FRAC_PI_3);
    let (mut in_reach, mut seen, mut wrong) = (0_u64, 0_u64, 0_u64);
    for (entity, place, forward, team) in &all {
        let eye = *place + Vec3::Y * 0.7;
        let sight = app
            .world()
            .get::<Sight>(*entity)
            .expect("the test made it so");
        let sees: Vec<Entity> = sight.seen().collect();
        for (other, to, _, enemy) in &all {
            if team == enemy {
                continue;
            }
            let reach = in_field(eye, *forward, 60.0, cos, *to);
            let truth = reach && rays.cast(eye, *to).is_none();
            let ours = sees.binary_search(other).is_ok();
            in_reach += u64::from(reach);
            seen += u64::from(truth);
            wrong += u64::from(truth != ours);
        }
    }
    let least = sight_ms
        .iter()
        .fold(f64::INFINITY, |least, ms| least.min(ms.0));
    let cpu = sight_ms.iter().map(|ms| ms.1).sum::<f64>() / sight_ms.len() as f64;
    let pairs = u64::from(count) * u64::from(count) / 2;
    println!(
        "{in_reach} of {pairs} pairs in reach, {seen} seen, {wrong} wrong ({:.3} % of those in reach); \
         at most {most_rays} rays a step ({:.4} % of all pairs); a step {least:.2} ms at least, {cpu:.2} ms of all cores",
        wrong as f64 / in_reach as f64 * 100.0,
        f64::from(most_rays) / pairs as f64 * 100.0,
    );
    assert!(seen > 20_000 && seen < in_reach);
    assert!(wrong as f64 / pairs as f64 <= 0.001);
    // In a twelfth of a second a pair in reach rarely changes.
    assert!(
        wrong as f64 / in_reach as f64 <= 0.05,
        "{wrong} of {in_reach}"
    );
    assert!(f64::from(most_rays) <= pairs as f64 * 0.01);
}
