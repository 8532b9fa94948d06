//! The town that recordings are played in: soldiers of two sides who walk, see, hear and shoot, lifts and doors.

use std::sync::Arc;

use bevy::ecs::entity::Entity;
use bevy::ecs::message::MessageWriter;
use bevy::ecs::system::{InMut, Query};
use bevy::math::{Quat, UVec2, Vec2, Vec3};
use bevy::tasks::{ComputeTaskPool, TaskPoolBuilder};
use bevy::transform::components::Transform;
use dolomite_logic::movement::{FlowField, FlowFields, WalkGrid, WalkGround, Walker};
use dolomite_logic::random::Random;
use dolomite_logic::rays::BoxRays;
use dolomite_logic::senses::{Ear, Memory, Noise, Sight, SightSettings, Visible};
use dolomite_logic::{
    Action, Attention, BehaviourAppExt, Door, Health, Hitbox, Key, LeafBatch, Lift, LogicTimer,
    Mind, Names, RayWorld, Status, Team, Value, Visitor, Weapon, Wire, Wires, Zone, state_hash,
};

use super::Recording;
use crate::studies::agents::stepping::app;

/// Soldiers of the town.
const SOLDIERS: u32 = 1000;

/// Parts that recordings may name: soldiers, doors, lifts.
pub const PARTS: u32 = SOLDIERS + 20;

/// Half of a side, metres.
const HALF: f32 = 100.0;

/// What became of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Played {
    /// Of the whole state.
    pub hash: u64,
    /// Soldiers that are hurt.
    pub hurt: usize,
}

const MIND: &str = r#"(root: "r", values: {"n": 0}, trees: {"r": Choose([
    ([Of("alert", Rise(0.5, 1.0))], Sequence([Wait(0.1), Do("shoot")])),
    ([Always(0.2)], Repeat(Cooldown(0.5, Sequence([Set("n", 3), Say("bored")])))),
])})"#;

fn shoot(
    mut batch: InMut<LeafBatch>,
    memories: Query<(&Memory, &Transform)>,
    mut actions: MessageWriter<Action>,
    mut noises: MessageWriter<Noise>,
) {
    for (call, _) in batch.iter_mut() {
        call.status = Status::Failure;
        let Ok((memory, place)) = memories.get(call.agent) else {
            continue;
        };
        if let Some(target) = memory.traces().first().and_then(|trace| trace.who) {
            actions.write(Action::new(call.agent, Key::FIRE, target));
            noises.write(Noise {
                place: place.translation,
                range: 40.0,
                source: Some(call.agent),
            });
        }
    }
}

/// Plays a recording with so many threads, if no pool of threads is there yet.
pub fn play(recording: &Recording, threads: usize) -> Played {
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(threads).build());
    let mut app = app();
    let mut random = Random::new(recording.seed);
    let mut grid = WalkGrid::flat(Vec2::splat(-HALF), 1.0, UVec2::splat(200))
        .expect("a grid of this size is one");
    let blocks: Vec<[Vec3; 2]> = (0..60)
        .map(|_| {
            let low = Vec3::new(random.signed(90.0), 0.0, random.signed(90.0));
            let size = Vec3::new(3.0 + random.unit() * 9.0, 4.0, 3.0 + random.unit() * 9.0);
            [low, low + size]
        })
        .collect();
    for [low, high] in &blocks {
        grid.block(*low, *high, 0.4);
    }
    let grid = Arc::new(grid);
    let fields = [Vec2::splat(-90.0), Vec2::splat(90.0)].map(|goal| {
        let goals: Vec<Vec2> = grid.nearest_open(goal, 50).into_iter().collect();
        Arc::new(FlowField::new(Arc::clone(&grid), &goals))
    });
    app.insert_resource(FlowFields(fields.to_vec()))
        .insert_resource(RayWorld(Arc::new(BoxRays::new(blocks, 8.0))))
        .insert_resource(SightSettings {
            every: 4,
            bodies: true,
            ..SightSettings::default()
        })
        .add_leaf("shoot", shoot);
    let mind = app
        .add_behaviour("soldier", MIND)
        .expect("the text is a behaviour");
    let mut parts: Vec<Entity> = Vec::new();
    for number in 0..SOLDIERS {
        let at = Vec2::new(random.signed(99.0), random.signed(99.0));
        let at = grid.nearest_open(at, 50).unwrap_or(at);
        let place = Transform::from_xyz(at.x, 0.9, at.y)
            .with_rotation(Quat::from_rotation_y(random.signed(3.0)));
        let body = (
            Walker::new(at, (number % 2) as u16),
            place,
            Team((number % 2) as u8),
            Visitor::default(),
            Hitbox::default(),
            Health::default(),
        );
        let senses = (
            Memory::default(),
            Sight::new(40.0, 1.0),
            Visible::default(),
            Ear::default(),
        );
        let weapon = Weapon {
            damage: 60.0,
            ..Weapon::default()
        };
        let soldier = (
            body,
            senses,
            weapon,
            Mind::new(mind),
            Attention::every(1 + number % 3),
        );
        parts.push(app.world_mut().spawn(soldier).id());
    }
    app.insert_resource(WalkGround(grid));
    app.world_mut().spawn(Zone::new(Vec3::splat(20.0)));
    for number in 0..PARTS - SOLDIERS {
        let part = if number % 2 == 0 {
            app.world_mut().spawn(Door::default()).id()
        } else {
            let lift = Lift::new(vec![0.0, 5.0, 9.0]).expect("floors that rise");
            let lift = app.world_mut().spawn(lift).id();
            let wire = |floor: i32| {
                Wire::new(Key::ELAPSED, lift, Key::CALL)
                    .with(floor)
                    .after(floor as f32)
            };
            let wires = Wires((0..3).map(wire).collect());
            app.world_mut().spawn((LogicTimer::every(3.0), wires));
            lift
        };
        parts.push(part);
    }
    let mut actions = recording.actions.iter().peekable();
    for step in 0..recording.steps {
        while let Some(action) = actions.next_if(|action| action.step <= step) {
            let verb = app.world_mut().resource_mut::<Names>().intern(&action.verb);
            let Some(target) = parts.get(action.who as usize) else {
                continue;
            };
            let number = match action.number {
                None => Value::None,
                // A floor.
                Some(number) if verb == Key::CALL => Value::Int(number as i32 % 4),
                Some(number) => Value::Float(number),
            };
            app.world_mut()
                .write_message(Action::new(*target, verb, number));
        }
        app.update();
    }
    let mut healths = app.world_mut().query::<&Health>();
    let hurt = healths
        .iter(app.world())
        .filter(|health| health.now < 100.0)
        .count();
    Played {
        hash: state_hash(app.world_mut()),
        hurt,
    }
}
