//! The beginning of a level: its entities, and again after a defeat.

use std::f32::consts::TAU;
use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite::logic::parts::{Collector, LogicTimer};
use dolomite::logic::random::Random;
use dolomite::logic::senses::{Ear, Memory, Sight, SightSettings, Visible};
use dolomite::logic::{
    BehaviourError, DayClock, Health, Hitbox, Key, Lamp, Mind, Mission, Names, Objective, PickUp,
    Team, Weapon, Wire, Wires, Zone,
};

use super::arms::SHOULDER;
use super::day::light;
use super::parts::{
    Bandage, Beacon, Cast, Level, LevelKeys, LevelPart, LevelState, MIDDLE, Numbered, Player,
    Soldier, Wish,
};
use super::{gate, ground, lifts};
use crate::play::camera::FreeCamera;
use crate::play::figure::Figure;
use crate::play::jump::Jump;
use crate::scene::{CurrentScene, Pose};

/// The side of the player, and that of the soldiers.
const TEAMS: (Team, Team) = (Team(1), Team(2));

/// A bandage is taken from this far away, metres along each axis.
const TAKEN: Vec3 = Vec3::new(1.6, 2.0, 1.6);

/// The name that the behaviour of soldiers has.
const BEHAVIOUR: &str = "levels/soldier.ron";

/// What was there of a level is gone, and all of it is there as at first.
///
/// # Errors
/// [`BehaviourError`] where the behaviour of soldiers is wrong. Nothing is changed then.
pub fn begin(world: &mut World) -> Result<(), BehaviourError> {
    let level = world.resource::<Level>().clone();
    let mind = dolomite::logic::behaviour::add_behaviour(world, BEHAVIOUR, &level.behaviour)?;
    let mut parts = world.query_filtered::<Entity, (With<LevelPart>, Without<ChildOf>)>();
    for part in parts.iter(world).collect::<Vec<_>>() {
        world.entity_mut(part).despawn();
    }
    world.init_resource::<Names>();
    let keys = LevelKeys::new(&mut world.resource_mut::<Names>());
    world.insert_resource(keys);
    world.insert_resource(ground::rays(Arc::clone(&level.grid), &level.built));
    world.insert_resource(SightSettings::default());
    let file = &level.file;
    let stand = |at: (f32, f32), above: f32| {
        let at = Vec2::from(at);
        Vec3::new(at.x, level.grid.height(at) + above, at.y)
    };

    let mission = world.spawn((LevelPart, Mission::default())).id();
    let done = Wires(Vec::new());
    let need = file.beacons.len() as i32;
    let objective = world.spawn((LevelPart, Objective::new(need), done)).id();
    if let Some(mut mission) = world.get_mut::<Mission>(mission) {
        mission.objectives = vec![objective];
    }
    let late = Wires(vec![Wire::new(Key::ELAPSED, mission, Key::FAIL)]);
    let timer = (LevelPart, LogicTimer::once(file.seconds), late);
    let timer = world.spawn(timer).id();
    let clock = DayClock::new(file.hour, file.pace / 3600.0);
    let clock = world.spawn((LevelPart, clock)).id();

    let start = (file.start.0, file.start.1);
    let fell = Wires(vec![Wire::new(Key::DIED, mission, Key::FAIL)]);
    let player = world
        .spawn((
            Player::default(),
            Transform::from_translation(stand(start, MIDDLE)),
            TEAMS.0,
            Health::new(file.health),
            Hitbox::default(),
            Visible {
                offset: Vec3::Y * 0.4,
            },
            Collector,
            fell,
        ))
        .id();
    if let Some(w) = &file.weapon {
        world.entity_mut(player).insert(Weapon {
            damage: w.damage,
            speed: w.bolt,
            range: w.range,
            interval: w.every,
            rounds: Some(w.rounds),
            most: w.rounds,
            muzzle: SHOULDER,
            ..default()
        });
    }
    for (number, beacon) in (0..).zip(&file.beacons) {
        let roof = level.built.roofs.get(number as usize);
        let mut at = stand(beacon.at, 0.0);
        if let Some(Some(roof)) = roof {
            at.y = roof.floors[1];
        }
        let lit = Wires(vec![
            // Without the parameter that an output without one has, a wire hands on nothing.
            Wire::new(keys.kindled, objective, Key::PROGRESS).with(1),
        ]);
        world.spawn((
            Beacon {
                name: beacon.name.clone(),
                kindled: 0.0,
            },
            Numbered(number),
            Lamp::default(),
            Transform::from_translation(at),
            lit,
        ));
    }
    for (number, &at) in (0..).zip(&file.bandages.at) {
        let heals = Wire::new(Key::TAKEN, player, Key::HEAL).with(file.bandages.gives);
        world.spawn((
            Bandage,
            Numbered(number),
            PickUp::new(keys.bandages, 1),
            Zone::new(TAKEN),
            Transform::from_translation(stand(at, MIDDLE)),
            Wires(vec![heals]),
        ));
    }
    let mut random = Random::new(level.seed);
    for (number, patrol) in (0..).zip(&file.patrols) {
        let open = |&at: &(f32, f32)| {
            let at = Vec2::from(at);
            level.grid.nearest_open(at, 64).unwrap_or(at)
        };
        let mut round: Vec<Vec2> = patrol.way.iter().map(open).collect();
        // One goes around one way, another the other way; and they begin anywhere between two places.
        if random.below(2) == 1 {
            round.reverse();
        }
        let next = random.below(round.len() as u32) as usize;
        let last = round[(next + round.len() - 1) % round.len()];
        let between = last.lerp(round[next], random.unit());
        let at = level.grid.nearest_open(between, 64).unwrap_or(last);
        let s = &file.soldiers;
        let place = stand(at.into(), MIDDLE);
        let turn = Quat::from_rotation_y(random.unit() * TAU);
        let mut soldier = world.spawn((
            Soldier {
                round: round.into(),
                next,
                notice: 0.0,
                alarmed: false,
                calls: 0.0,
                wish: Wish::default(),
                way: Vec::new(),
                leads: None,
                patience: 0.0,
                velocity: Vec2::ZERO,
                random: Random::new(u64::from(random.bits())),
            },
            Numbered(number),
            Transform::from_translation(place).with_rotation(turn),
            TEAMS.1,
            Mind::new(mind),
            Sight::new(s.day, s.field.to_radians()),
            Ear::default(),
            Memory::default(),
            Weapon {
                damage: s.damage,
                speed: s.bolt,
                range: s.range * 1.5,
                interval: s.every,
                rounds: None,
                muzzle: SHOULDER,
                ..default()
            },
        ));
        // Nobody shoots at who is not shot at.
        if file.weapon.is_some() {
            soldier.insert((Health::new(s.bears), Hitbox::default()));
        }
    }
    let cast = Cast {
        player,
        mission,
        objective,
        timer,
        clock,
    };
    lifts::spawn(world, &level);
    gate::spawn(world, &level, &cast);
    world.insert_resource(LevelState {
        light: light(file.hour),
        ..default()
    });
    world.insert_resource(cast);
    // Nothing that was said to who is gone is heard by who is new.
    world
        .resource_mut::<dolomite::logic::parts::Shots>()
        .0
        .clear();
    let place = DVec2::new(f64::from(start.0), f64::from(start.1));
    put_figure(world, place, file.start.2.to_radians(), 0.0);
    Ok(())
}

/// Puts the figure somewhere, at rest, and the camera behind it. Where it is `above` the ground, metres, it falls onto
/// what is there.
pub fn put_figure(world: &mut World, place: DVec2, yaw: f32, above: f64) {
    let Some(terrain) = world.get_resource::<CurrentScene>() else {
        return;
    };
    let terrain = terrain.terrain.clone();
    let mut at = Figure::at(place, &terrain).facing(yaw);
    if above > 0.0 {
        at.now.jump = Jump::Air {
            lift: above,
            rise: 0.0,
        };
        at.before = at.now;
    }
    for mut figure in world.query::<&mut Figure>().iter_mut(world) {
        *figure = at;
    }
    let mut pose = Pose::behind(at.now.place, yaw, &terrain);
    pose.position.y += above;
    for mut camera in world.query::<&mut FreeCamera>().iter_mut(world) {
        camera.pose = pose;
        camera.velocity = Vec3::ZERO;
        camera.followed = None;
    }
}
