//! The plugin in an app without a window: walkers, blockers, lifts, triggers, and an app without any of them.

use crate::support::meshes::floor;
use bevy::MinimalPlugins;
use bevy::app::{App, FixedUpdate};
use bevy::ecs::message::Messages;
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::time::{Fixed, Time, TimeUpdateStrategy};
use bevy::transform::components::Transform;
use dolomite_collision::{
    BetweenSteps, Blocker, CharacterBody, Collider, CollisionCounters, CollisionPlugin,
    CollisionSystems, MoveState, MoveWish, TreeSettings, TriangleTree, Trigger, TriggerKind,
    TriggerMessage,
};
use std::sync::Arc;
use std::time::Duration;

/// One fixed step an update.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, CollisionPlugin));
    app.add_plugins(CollisionPlugin);
    let step = Duration::from_millis(16);
    app.insert_resource(Time::<Fixed>::from_duration(step));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
    app.update();
    app
}

fn ground(app: &mut App) {
    let tree = TriangleTree::new(floor(20, 1.0, |_, _| 0.0), TreeSettings::default());
    app.world_mut().spawn(Collider(Arc::new(tree)));
}

fn walk(app: &mut App, walker: Entity, wish: Vec3, steps: usize) {
    for _ in 0..steps {
        app.world_mut().entity_mut(walker).insert(MoveWish(wish));
        app.update();
        assert_eq!(
            app.world().get::<MoveWish>(walker),
            Some(&MoveWish(Vec3::ZERO))
        );
    }
}

fn place(app: &App, entity: Entity) -> Vec3 {
    app.world()
        .get::<Transform>(entity)
        .expect("it was spawned with one")
        .translation
}

#[test]
fn a_walker_stands_and_slides_along_a_blocker() {
    let mut app = app();
    ground(&mut app);
    app.world_mut().spawn((
        Blocker {
            half_size: Vec3::new(0.5, 2.0, 3.0),
        },
        Transform::from_xyz(2.5, 1.0, 0.0),
    ));
    let walker = app
        .world_mut()
        .spawn((CharacterBody::default(), Transform::from_xyz(0.0, 1.0, 0.0)))
        .id();
    walk(&mut app, walker, Vec3::new(0.0, -0.02, 0.0), 10);
    assert!(app.world().get::<MoveState>(walker).unwrap().grounded());
    walk(&mut app, walker, Vec3::new(0.1, -0.02, 0.05), 30);
    let at = place(&app, walker);
    assert!((at - Vec3::new(1.7, 0.9, 1.5)).length() < 1e-4, "{at}");
    let counters = *app.world().resource::<CollisionCounters>();
    assert_eq!((counters.moves, counters.bodies), (1, 2));
    assert!(counters.casts > 1 && counters.bytes > 1000);
    // Moved by somebody else, it goes on from there.
    app.world_mut()
        .get_mut::<Transform>(walker)
        .unwrap()
        .translation = Vec3::new(-3.0, 2.0, 0.0);
    walk(&mut app, walker, Vec3::new(0.0, -0.1, 0.0), 20);
    assert!((place(&app, walker) - Vec3::new(-3.0, 0.9, 0.0)).length() < 1e-4);
    // What is no ellipsoid says so, and does not move.
    app.world_mut()
        .get_mut::<CharacterBody>(walker)
        .unwrap()
        .radii = Vec3::ZERO;
    walk(&mut app, walker, Vec3::X, 1);
    assert!(
        app.world()
            .get::<MoveState>(walker)
            .unwrap()
            .error()
            .is_some()
    );
    assert!((place(&app, walker).x + 3.0).abs() < 1e-6);
}

#[test]
fn a_lift_carries() {
    let mut app = app();
    let lift = app
        .world_mut()
        .spawn((
            Blocker {
                half_size: Vec3::new(2.0, 0.1, 2.0),
            },
            Transform::default(),
        ))
        .id();
    let walker = app
        .world_mut()
        .spawn((
            CharacterBody::default(),
            Transform::from_xyz(0.0, 1.02, 0.0),
        ))
        .id();
    walk(&mut app, walker, Vec3::Y * -0.05, 3);
    assert_eq!(
        app.world().get::<MoveState>(walker).unwrap().stands_on,
        Some(lift)
    );
    for _ in 0..50 {
        app.world_mut()
            .get_mut::<Transform>(lift)
            .unwrap()
            .translation += Vec3::new(0.1, 0.16, 0.05);
        walk(&mut app, walker, Vec3::Y * -0.003, 1);
    }
    let (at, below) = (place(&app, walker), place(&app, lift));
    assert!((at - below - Vec3::Y).length() < 1e-3, "{at} {below}");
}

fn drain(app: &mut App) -> Vec<TriggerMessage> {
    app.world_mut()
        .resource_mut::<Messages<TriggerMessage>>()
        .drain()
        .collect()
}

#[test]
fn triggers_report_in_order() {
    let mut app = app();
    let box_at = |app: &mut App, x: f32| {
        let trigger = Trigger {
            half_size: Vec3::splat(0.5),
        };
        app.world_mut()
            .spawn((trigger, Transform::from_xyz(x, 0.0, 0.0)))
            .id()
    };
    let (far, near) = (box_at(&mut app, 5.0), box_at(&mut app, 2.0));
    let mover = app.world_mut().spawn(CharacterBody::default()).id();
    walk(&mut app, mover, Vec3::X, 1);
    assert_eq!(drain(&mut app), []);
    // Into the near one: its side at 1.5 is touched at 1.2, a fifth of the step.
    walk(&mut app, mover, Vec3::X, 1);
    let messages = drain(&mut app);
    assert_eq!(messages.len(), 1);
    assert_eq!(
        (messages[0].trigger, messages[0].kind),
        (near, TriggerKind::Enter)
    );
    assert!((messages[0].time - 0.2).abs() < 1e-6 && (messages[0].place.x - 1.2).abs() < 1e-6);
    walk(&mut app, mover, Vec3::X * 0.1, 1);
    assert_eq!(drain(&mut app)[0].kind, TriggerKind::Stay);
    // Out of it and through the far one, at 500 m a second.
    walk(&mut app, mover, Vec3::X * 7.9, 1);
    let messages: Vec<_> = drain(&mut app)
        .iter()
        .map(|m| (m.trigger, m.kind))
        .collect();
    let expected = [
        (near, TriggerKind::Leave),
        (far, TriggerKind::Enter),
        (far, TriggerKind::Leave),
    ];
    assert_eq!(messages, expected);
    walk(&mut app, mover, Vec3::X, 1);
    assert_eq!(drain(&mut app), []);
}

/// Put into a trigger it is in it at once, and not when it touches the wall from inside on its way out.
#[test]
fn who_begins_within_enters_at_once() {
    let mut app = app();
    let trigger = Trigger {
        half_size: Vec3::splat(2.0),
    };
    app.world_mut().spawn(trigger);
    let mover = app.world_mut().spawn(CharacterBody::default()).id();
    walk(&mut app, mover, Vec3::X * 5.0, 1);
    let told = drain(&mut app);
    assert_eq!(told.len(), 2, "{told:?}");
    assert_eq!((told[0].kind, told[0].time), (TriggerKind::Enter, 0.0));
    assert_eq!(told[0].place, bevy::math::DVec3::ZERO);
    assert_eq!(told[1].kind, TriggerKind::Leave);
    // Its side is 0.3 m behind its centre.
    assert!((told[1].time - 0.46).abs() < 1e-6, "{told:?}");
    // A trigger that comes about it, which it touches from inside but does not leave.
    let trigger = Trigger {
        half_size: Vec3::splat(2.0),
    };
    app.world_mut()
        .spawn((trigger, Transform::from_xyz(5.0, 0.0, 0.0)));
    walk(&mut app, mover, Vec3::X * 2.0, 1);
    let told = drain(&mut app);
    assert_eq!(told.len(), 1, "{told:?}");
    assert_eq!((told[0].kind, told[0].time), (TriggerKind::Enter, 0.0));
}

/// What a mover was told stays where its body is taken away, and counts no more.
#[test]
fn a_body_that_is_gone_is_not_counted() {
    let mut app = app();
    let movers = [(); 2].map(|()| app.world_mut().spawn(CharacterBody::default()).id());
    walk(&mut app, movers[0], Vec3::X, 1);
    assert_eq!(app.world().resource::<CollisionCounters>().moves, 2);
    app.world_mut()
        .entity_mut(movers[1])
        .remove::<CharacterBody>();
    walk(&mut app, movers[0], Vec3::X, 1);
    assert_eq!(app.world().resource::<CollisionCounters>().moves, 1);
}

/// A trigger that is gone was left, though it was the last of all.
#[test]
fn who_is_in_the_last_trigger_leaves_it_with_it() {
    let mut app = app();
    let trigger = app.world_mut().spawn(Trigger::default()).id();
    let mover = app.world_mut().spawn(CharacterBody::default()).id();
    walk(&mut app, mover, Vec3::ZERO, 1);
    let kinds =
        |app: &mut App| -> Vec<_> { drain(app).iter().map(|m| (m.trigger, m.kind)).collect() };
    assert_eq!(kinds(&mut app), [(trigger, TriggerKind::Enter)]);
    app.world_mut().despawn(trigger);
    walk(&mut app, mover, Vec3::ZERO, 1);
    assert_eq!(kinds(&mut app), [(trigger, TriggerKind::Leave)]);
    walk(&mut app, mover, Vec3::ZERO, 1);
    assert_eq!(kinds(&mut app), []);
}

/// A lift goes up while nobody is there: who comes then stands beside its way, and is not hit by it.
#[test]
fn what_moved_while_there_was_no_mover_pushes_nobody() {
    let mut app = app();
    let lift = Blocker {
        half_size: Vec3::new(2.0, 0.1, 2.0),
    };
    let lift = app.world_mut().spawn((lift, Transform::default())).id();
    let first = app
        .world_mut()
        .spawn((CharacterBody::default(), Transform::from_xyz(0.0, 1.1, 0.0)))
        .id();
    walk(&mut app, first, Vec3::ZERO, 2);
    app.world_mut().despawn(first);
    for _ in 0..10 {
        app.world_mut()
            .get_mut::<Transform>(lift)
            .expect("it is there")
            .translation
            .y += 1.0;
        app.update();
    }
    let counters = *app.world().resource::<CollisionCounters>();
    assert_eq!(counters, CollisionCounters::default(), "nothing is kept");
    let second = app
        .world_mut()
        .spawn((CharacterBody::default(), Transform::from_xyz(0.0, 5.0, 0.0)))
        .id();
    walk(&mut app, second, Vec3::ZERO, 1);
    assert_eq!(place(&app, second), Vec3::new(0.0, 5.0, 0.0));
}

/// Steps of a lift, seen from within them.
#[derive(Resource, Default)]
struct Seen(Vec<f32>);

/// Four frames a step: a lift is drawn a quarter of its step farther in each, and steps know nothing of it.
#[test]
fn what_steps_move_is_drawn_between_them() {
    const STEP: f32 = 0.5;
    let mut app = app();
    app.init_resource::<Seen>();
    let lift = |mut lifts: Query<&mut Transform, With<Blocker>>, mut seen: ResMut<Seen>| {
        for mut place in &mut lifts {
            seen.0.push(place.translation.x);
            place.translation.x += STEP;
        }
    };
    app.add_systems(FixedUpdate, lift.before(CollisionSystems::Gather));
    let quarter = Duration::from_millis(4);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(quarter));
    let lift = app
        .world_mut()
        .spawn((Blocker::default(), BetweenSteps::default()))
        .id();
    // Two steps, of which the second is drawn at its start.
    let drawn: Vec<f32> = (0..24)
        .map(|_| {
            app.update();
            place(&app, lift).x
        })
        .collect();
    let steps = drawn.windows(2).skip(8);
    for pair in steps {
        assert!((pair[1] - pair[0] - STEP / 4.0).abs() < 1e-5, "{drawn:?}");
    }
    let seen = app.world().resource::<Seen>().0.clone();
    let expected: Vec<f32> = (0..seen.len()).map(|step| step as f32 * STEP).collect();
    assert!(seen.len() >= 5, "{seen:?}");
    assert_eq!(seen, expected);
    let state = *app.world().get::<BetweenSteps>(lift).expect("it stays");
    let now = state.now().expect("there were steps").translation.x;
    assert!((now - seen.len() as f32 * STEP).abs() < 1e-6 && place(&app, lift).x < now);
    // Put elsewhere outside of a step it is there at once, and goes on from there.
    let put = |app: &mut App| {
        let mut place = app.world_mut().get_mut::<Transform>(lift);
        place.as_mut().expect("it stays").translation.x = 100.0;
    };
    put(&mut app);
    for _ in 0..8 {
        app.update();
        let x = place(&app, lift).x;
        assert!((100.0..101.0).contains(&x), "{x}");
    }
    assert!(place(&app, lift).x > 100.0);
}

/// What ran is asked of a system that would see it.
#[derive(Resource, Default)]
struct Ran(u32);

#[test]
fn without_components_nothing_runs() {
    let mut app = app();
    app.init_resource::<Ran>();
    let count = |mut ran: ResMut<Ran>, counters: Res<CollisionCounters>| {
        ran.0 += u32::from(counters.is_changed() && !counters.is_added());
    };
    app.add_systems(FixedUpdate, count.after(CollisionSystems::Trigger));
    for _ in 0..5 {
        app.update();
    }
    assert_eq!(app.world().resource::<Ran>().0, 0);
    ground(&mut app);
    app.update();
    assert_eq!(
        app.world().resource::<Ran>().0,
        0,
        "ground alone moves nothing"
    );
    assert_eq!(app.world().resource::<CollisionCounters>().bytes, 0);
    app.world_mut().spawn(CharacterBody::default());
    app.update();
    app.update();
    assert!(app.world().resource::<Ran>().0 > 0);
}
