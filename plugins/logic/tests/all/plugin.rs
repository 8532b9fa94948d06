//! The plugin as a whole: what is absent runs nothing, what is bad harms nobody, threads change nothing.

use crate::support::{act, app, steps};
use bevy::MinimalPlugins;
use bevy::app::{App, FixedUpdate, PluginGroup, TaskPoolOptions, TaskPoolPlugin};
use bevy::ecs::prelude::*;
use bevy::ecs::schedule::Schedules;
use bevy::math::{Quat, UVec2, Vec2, Vec3};
use bevy::time::TimeUpdateStrategy;
use bevy::transform::components::Transform;
use dolomite_logic::action::DelayedActions;
use dolomite_logic::movement::{FlowField, FlowFields, WalkGrid, WalkGround, Walker};
use dolomite_logic::random::Random;
use dolomite_logic::rays::BoxRays;
use dolomite_logic::senses::{Ear, Memory, Noise, Sight, SightSettings, Visible};
use dolomite_logic::{
    Action, Asleep, Attention, AttentionSettings, BehaviourAppExt, Door, Focus, Health, Hitbox,
    Key, LeafBatch, Lift, LogicCounters, LogicPlugin, LogicSystems, LogicTimer, Mind, RayWorld,
    Status, Team, Values, Visitor, Weapon, Wire, Wires, Zone, state_hash,
};
use std::process::Command;
use std::sync::Arc;

/// Our systems in the schedule, and how many of them ever ran.
fn ran(app: &App) -> (usize, Vec<String>) {
    let schedules = app.world().resource::<Schedules>();
    let schedule = schedules.get(FixedUpdate).expect("it was run");
    let ours = schedule
        .systems()
        .expect("it was run")
        .filter(|(_, system)| system.name().to_string().contains("dolomite_logic::"));
    let all: Vec<_> = ours.collect();
    // Ticks of a run count from 0 on; a system that never ran has one that lies as far back as ticks go, which in
    // 32 bits is a large number.
    let ran = all
        .iter()
        .filter(|(_, system)| system.get_last_run().get() < 1 << 29);
    let names = ran.map(|(_, system)| system.name().to_string()).collect();
    (all.len(), names)
}

#[test]
fn without_components_no_system_runs() {
    let mut app = app();
    steps(&mut app, 70);
    let (count, names) = ran(&app);
    assert!(count >= 20, "{count} systems");
    assert_eq!(names, Vec::<String>::new());
    // One door: the door's system, the clock, and what wakes and counts.
    app.world_mut().spawn(Door::default());
    steps(&mut app, 2);
    let (_, names) = ran(&app);
    assert!(
        names.iter().any(|name| name.contains("door::run")),
        "{names:?}"
    );
    assert!(names.len() <= 5, "{names:?}");
    assert_eq!(app.world().resource::<LogicCounters>().entities, 1);
}

#[test]
fn who_is_far_is_worked_on_rarely_and_who_sleeps_until_an_action() {
    let mut app = app();
    app.insert_resource(AttentionSettings {
        near: 10.0,
        most: 16,
    });
    app.world_mut().spawn(Focus);
    let agent = |app: &mut App, x: f32| {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        app.world_mut().spawn((Attention::default(), place)).id()
    };
    let places = [0.0, 9.0, 15.0, 35.0, 1e6, f32::NAN];
    let agents = places.map(|x| agent(&mut app, x));
    steps(&mut app, 17);
    let every = agents.map(|a| {
        app.world()
            .get::<Attention>(a)
            .expect("the test made it so")
            .steps()
    });
    assert_eq!(every, [1, 1, 2, 4, 16, 16]);
    let far = app
        .world()
        .get::<Attention>(agents[3])
        .expect("the test made it so");
    assert_eq!((0..100).filter(|&step| far.is_due(step)).count(), 25);
    act(&mut app, agents[0], Key::SLEEP, ());
    steps(&mut app, 1);
    assert!(app.world().get::<Asleep>(agents[0]).is_some());
    assert_eq!(app.world().resource::<LogicCounters>().asleep, 1);
    act(&mut app, agents[0], Key::PRESS, ());
    act(&mut app, agents[1], Key::WAKE, ());
    steps(&mut app, 1);
    assert!(app.world().get::<Asleep>(agents[0]).is_none());
    // As rarely as one likes: doubling ends.
    app.world_mut().resource_mut::<AttentionSettings>().most = u32::MAX;
    steps(&mut app, 16);
    let nowhere = app.world().get::<Attention>(agents[5]);
    assert_eq!(nowhere.expect("the test made it so").steps(), u32::MAX);
}

#[test]
fn who_ends_in_the_step_in_which_it_is_put_to_sleep_harms_nobody() {
    let mut app = app();
    let who = app.world_mut().spawn(LogicTimer::every(1.0)).id();
    let end = move |mut commands: Commands| commands.entity(who).try_despawn();
    app.add_systems(FixedUpdate, end.before_ignore_deferred(LogicSystems::Begin));
    act(&mut app, who, Key::SLEEP, ());
    steps(&mut app, 2);
    assert!(app.world().get_entity(who).is_err());
}

#[test]
fn actions_on_everything_with_everything_harm_nobody() {
    let mut app = app();
    let gone = app.world_mut().spawn_empty().id();
    app.world_mut().despawn(gone);
    let timer = app
        .world_mut()
        .spawn((LogicTimer::every(f32::NAN), Values::default()))
        .id();
    for number in 0..60 {
        let Some(verb) = (0..60).map(key).nth(number).flatten() else {
            continue;
        };
        for target in [gone, timer, Entity::PLACEHOLDER] {
            act(&mut app, target, verb, f32::NAN);
            act(&mut app, target, verb, gone);
            act(&mut app, target, verb, i32::MAX);
        }
    }
    steps(&mut app, 3);
}

/// A built-in name by its number.
fn key(number: u32) -> Option<Key> {
    let names = dolomite_logic::Names::default();
    let all = [
        "press", "open", "call", "start", "damage", "fire", "progress", "on", "wake", "sleep",
    ];
    all.get(number as usize).and_then(|name| names.find(name))
}

/// A town in which all there is happens at once: hash after some steps.
fn town(threads: usize) -> u64 {
    let mut app = App::new();
    let pools = TaskPoolPlugin {
        task_pool_options: TaskPoolOptions::with_num_threads(threads),
    };
    app.add_plugins((MinimalPlugins.set(pools), LogicPlugin));
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    let mut random = Random::new(77);
    let mut grid =
        WalkGrid::flat(Vec2::splat(-100.0), 1.0, UVec2::splat(200)).expect("the test made it so");
    let blocks: Vec<[Vec3; 2]> = (0..60)
        .map(|_| {
            let low = Vec3::new(random.signed(95.0), 0.0, random.signed(95.0));
            [
                low,
                low + Vec3::new(4.0 + random.unit() * 9.0, 6.0, 4.0 + random.unit() * 9.0),
            ]
        })
        .collect();
    for [low, high] in &blocks {
        grid.block(*low, *high, 0.3);
    }
    let grid = Arc::new(grid);
    let goals = [Vec2::splat(-90.0), Vec2::splat(90.0)];
    let fields = goals.map(|goal| {
        let goal = grid.nearest_open(goal, 50).expect("open ground");
        Arc::new(FlowField::new(Arc::clone(&grid), &[goal]))
    });
    app.insert_resource(FlowFields(fields.to_vec()));
    app.insert_resource(RayWorld(Arc::new(BoxRays::new(blocks, 8.0))));
    app.insert_resource(SightSettings {
        every: 4,
        bodies: true,
        ..SightSettings::default()
    });
    app.add_leaf(
        "shoot",
        |mut batch: InMut<LeafBatch>,
         memories: Query<&Memory>,
         mut actions: MessageWriter<Action>,
         mut noises: MessageWriter<Noise>| {
            for (call, _) in batch.iter_mut() {
                let target = memories
                    .get(call.agent)
                    .ok()
                    .and_then(|memory| memory.traces().first()?.who);
                call.status = Status::Failure;
                if let Some(target) = target {
                    actions.write(Action::new(call.agent, Key::FIRE, target));
                    noises.write(Noise {
                        place: Vec3::ZERO,
                        range: 40.0,
                        source: Some(call.agent),
                    });
                }
            }
        },
    );
    let text = r#"(root: "r", values: {"n": 0}, trees: {"r": Choose([
        ([Of("alert", Rise(0.5, 1.0))], Sequence([Wait(0.1), Do("shoot")])),
        ([Always(0.2)], Repeat(Cooldown(0.5, Sequence([Set("n", 3), Say("bored")])))),
    ])})"#;
    let mind = app
        .add_behaviour("soldier", text)
        .expect("the test made it so");
    for i in 0..1500_u32 {
        let at = Vec2::new(random.signed(99.0), random.signed(99.0));
        let Some(at) = grid.nearest_open(at, 20) else {
            continue;
        };
        let place = Transform::from_xyz(at.x, 0.9, at.y)
            .with_rotation(Quat::from_rotation_y(random.signed(3.0)));
        let team = Team((i % 2) as u8);
        let parts = (
            Walker::new(at, (i % 2) as u16),
            place,
            team,
            Visitor::default(),
            Hitbox::default(),
        );
        let more = (
            Health::default(),
            Memory::default(),
            Sight::new(40.0, 1.0),
            Visible::default(),
            Ear::default(),
        );
        let weapon = Weapon {
            damage: 60.0,
            ..Weapon::default()
        };
        app.world_mut().spawn((
            parts,
            more,
            weapon,
            Mind::new(mind),
            Attention::every(1 + i % 3),
        ));
    }
    app.insert_resource(WalkGround(grid));
    app.world_mut().spawn(Zone::new(Vec3::splat(20.0)));
    let lift = app
        .world_mut()
        .spawn(Lift::new(vec![0.0, 5.0, 9.0]).expect("the test made it so"))
        .id();
    let mut wires = Vec::new();
    for floor in 0..3 {
        wires.push(
            Wire::new(Key::ELAPSED, lift, Key::CALL)
                .with(floor)
                .after(floor as f32),
        );
    }
    app.world_mut()
        .spawn((LogicTimer::every(3.0), Wires(wires)));
    steps(&mut app, 96);
    let hurt = {
        let mut query = app.world_mut().query::<&Health>();
        query
            .iter(app.world())
            .filter(|health| health.now < 100.0)
            .count()
    };
    assert!(hurt > 20, "{hurt}");
    state_hash(app.world_mut())
}

/// Pools of threads are one for a process: the hash of each number of threads comes from a process of its own.
#[test]
#[ignore = "asked by threads_change_nothing, with the number of threads"]
fn prints_its_hash() {
    let threads = std::env::var("DOLOMITE_THREADS")
        .ok()
        .and_then(|text| text.parse().ok());
    println!("hash {:016x}", town(threads.unwrap_or(1)));
}

#[test]
fn threads_change_nothing() {
    let hash = |threads: &str| {
        let output = Command::new(std::env::current_exe().expect("the test made it so"))
            .args([
                "--exact",
                "plugin::prints_its_hash",
                "--ignored",
                "--nocapture",
            ])
            .env("DOLOMITE_THREADS", threads)
            .output()
            .expect("the test made it so");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(
            output.status.success(),
            "{text} {}",
            String::from_utf8_lossy(&output.stderr)
        );
        let at = text.find("hash ").expect("it prints a hash");
        text[at..at + 21].to_owned()
    };
    let (one, two, four) = (hash("1"), hash("2"), hash("4"));
    println!("{one} {two} {four}");
    assert_eq!(one, two);
    assert_eq!(one, four);
}

#[test]
fn another_state_has_another_hash() {
    let mut app = app();
    let who = app
        .world_mut()
        .spawn((Values::with([(Key::ALERT, 0.5_f32)]), Transform::default()))
        .id();
    let first = state_hash(app.world_mut());
    assert_eq!(first, state_hash(app.world_mut()));
    let mut values = app
        .world_mut()
        .get_mut::<Values>(who)
        .expect("the test made it so");
    values
        .set(Key::ALERT, f32::from_bits(0.5_f32.to_bits() + 1).into())
        .expect("the test made it so");
    let second = state_hash(app.world_mut());
    assert_ne!(first, second);
    app.world_mut()
        .get_mut::<Transform>(who)
        .expect("the test made it so")
        .translation
        .x = 1e-30;
    assert_ne!(second, state_hash(app.world_mut()));
}

#[test]
fn an_action_that_waits_and_who_is_in_a_zone_are_of_the_state() {
    // Two apps with the same entities in the same places, in which other things came before.
    let state = |waits: bool, far: bool| {
        let mut app = app();
        let who = app.world_mut().spawn(Visitor::default()).id();
        let zone = app.world_mut().spawn(Zone::new(Vec3::ONE)).id();
        if waits {
            let action = Action::new(who, Key::WAKE, ());
            let mut delayed = app.world_mut().resource_mut::<DelayedActions>();
            delayed.send(1000, action);
        }
        if far {
            app.world_mut()
                .entity_mut(zone)
                .insert(Zone::new(Vec3::NEG_ONE));
        }
        steps(&mut app, 3);
        state_hash(app.world_mut())
    };
    let plain = state(false, false);
    assert_eq!(plain, state(false, false));
    assert_ne!(plain, state(true, false), "an action waits");
    assert_ne!(plain, state(false, true), "nobody is in the zone");
}
