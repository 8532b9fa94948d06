//! What the bot sees: what is on the screen of a player, and on the map.

use bevy::prelude::*;
use dolomite::logic::parts::{Lift, LiftState};
use dolomite::logic::senses::Sight;
use dolomite::logic::{Health, Lamp, PickUp, RayWorld, Weapon};

use crate::level::Level;
use crate::level::lifts::RoofLift;
use crate::level::parts::{Bandage, Beacon, Cast, LevelState, Numbered, Soldier, ground_of};
use crate::level::town::PLATE;
use crate::play::camera::FreeCamera;
use crate::play::figure::Figure;

/// It shoots at who sees it and is nearer than this, metres.
pub(super) const SHOOTS: f32 = 24.0;

/// What it sees.
pub(super) struct Sees {
    pub(super) place: Vec2,
    /// Metres above the ground.
    pub(super) above: f32,
    pub(super) yaw: f32,
    pub(super) health: f32,
    pub(super) hunters: Vec<Vec2>,
    pub(super) others: Vec<Vec2>,
    pub(super) sight: f32,
    pub(super) beacon: Option<Vec2>,
    pub(super) bandage: Option<Vec2>,
}

/// What it sees of a city.
pub(super) struct Town {
    /// Of each roof's lift: the height of its plate's top, and whether it moves.
    pub(super) lifts: Vec<Option<(f32, bool)>>,
    /// Beacons that do not burn: number and place.
    pub(super) dark: Vec<(usize, Vec2)>,
    /// Way out, once it is open.
    pub(super) exit: Option<Vec2>,
    /// Who is after it and in sight.
    pub(super) target: Option<Vec2>,
    pub(super) loaded: bool,
}

/// What it sees.
pub(super) fn look(world: &mut World) -> Option<Sees> {
    let cast = *world.get_resource::<Cast>()?;
    let health = world.get::<Health>(cast.player)?.part();
    let figure = world.query::<&Figure>().iter(world).next()?.now;
    let place = figure.place.as_vec2();
    let above = figure.jump.lift() as f32;
    let yaw = world.query::<&FreeCamera>().iter(world).next()?.pose.yaw;
    let mut soldiers = world.query::<(&Soldier, &Transform, &Sight)>();
    let (mut hunters, mut others) = (Vec::new(), Vec::new());
    for (soldier, at, _) in soldiers.iter(world) {
        let list = if soldier.alarmed {
            &mut hunters
        } else {
            &mut others
        };
        list.push(ground_of(at));
    }
    let sights = soldiers.iter(world).map(|(.., sight)| sight.range);
    let sight = sights.fold(0.0, f32::max);
    let nearest = |best: Option<Vec2>, at: Vec2| match best {
        Some(best) if best.distance(place) <= at.distance(place) => Some(best),
        _ => Some(at),
    };
    let mut beacons = world.query_filtered::<(&Lamp, &Transform), With<Beacon>>();
    let beacon = beacons
        .iter(world)
        .filter(|(lamp, _)| !lamp.lit)
        .map(|(_, at)| ground_of(at))
        .fold(None, nearest);
    let mut bandages = world.query_filtered::<(&PickUp, &Transform), With<Bandage>>();
    let bandage = bandages
        .iter(world)
        .filter(|(one, _)| one.there)
        .map(|(_, at)| ground_of(at))
        .filter(|at| at.distance(place) < 200.0)
        .fold(None, nearest);
    Some(Sees {
        place,
        above,
        yaw,
        health,
        hunters,
        others,
        sight,
        beacon,
        bandage,
    })
}

/// What it sees of a city.
pub(super) fn see(world: &mut World, sees: &Sees, level: &Level) -> Town {
    let mut lifts = vec![None; level.built.roofs.len()];
    let mut query = world.query_filtered::<(&Numbered, &Lift), With<RoofLift>>();
    for (number, lift) in query.iter(world) {
        let moves = lift.state() == LiftState::Moving;
        if let Some(known) = lifts.get_mut(number.0 as usize) {
            *known = Some((lift.height() + PLATE.y, moves));
        }
    }
    let mut beacons = world.query_filtered::<(&Numbered, &Lamp, &Transform), With<Beacon>>();
    let mut dark: Vec<_> = beacons
        .iter(world)
        .filter(|(_, lamp, _)| !lamp.lit)
        .map(|(number, _, at)| (number.0 as usize, ground_of(at)))
        .collect();
    dark.sort_by_key(|(number, _)| *number);
    let open = world.resource::<LevelState>().open;
    let gate = level.built.gate.filter(|_| open);
    let exit = gate.map(|gate| Vec2::new(gate.beyond.0.x, gate.beyond.0.z));
    let weapon = world
        .get_resource::<Cast>()
        .and_then(|cast| world.get::<Weapon>(cast.player));
    let loaded = weapon.is_some_and(|weapon| weapon.rounds != Some(0));
    let eye = Vec3::new(
        sees.place.x,
        level.grid.height(sees.place) + sees.above + 1.4,
        sees.place.y,
    );
    let rays = world.get_resource::<RayWorld>().cloned();
    let mut soldiers = world.query::<(&Numbered, &Soldier, &Transform)>();
    let target = soldiers
        .iter(world)
        .filter(|(_, soldier, at)| {
            let near = at.translation.distance(eye) < SHOOTS;
            let seen = || {
                let rays = rays.as_ref();
                rays.is_none_or(|rays| rays.0.cast(eye, at.translation).is_none())
            };
            soldier.alarmed && near && seen()
        })
        .map(|(number, _, at)| (at.translation.distance(eye), number, ground_of(at)))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(b.1)))
        .map(|(.., at)| at);
    Town {
        lifts,
        dark,
        exit,
        target,
        loaded,
    }
}
