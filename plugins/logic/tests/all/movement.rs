//! Grids, fields, crowds, patrols.

use crate::support::{SECONDS, app, milliseconds, steps};
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::math::{IVec2, UVec2, Vec2, Vec3};
use bevy::transform::components::Transform;
use dolomite_logic::Asleep;
use dolomite_logic::movement::{
    FlowField, FlowFields, GridError, NEVER, Patrol, Route, RouteError, WalkCounters, WalkGrid,
    WalkGround, WalkLimits, WalkTimes, Walker,
};
use dolomite_logic::random::Random;
use std::sync::Arc;

fn pillars(side: u32, cell: f32, random: &mut Random) -> WalkGrid {
    let mut grid =
        WalkGrid::flat(Vec2::ZERO, cell, UVec2::splat(side)).expect("the test made it so");
    for _ in 0..side * side / 200 {
        let at = Vec2::new(random.unit(), random.unit()) * (side as f32 * cell);
        let (low, high) = (at.extend(0.0), (at + 3.0).extend(0.0));
        grid.block(
            Vec3::new(low.x, 0.0, low.y),
            Vec3::new(high.x, 3.0, high.y),
            0.0,
        );
    }
    grid
}

#[test]
fn slopes_water_and_walls_are_not_walked() {
    let height = |at: Vec2| {
        if at.x < 10.0 {
            0.0
        } else {
            (at.x - 10.0) * 2.0 - at.y * 0.1
        }
    };
    let limits = WalkLimits {
        slope: 1.0,
        water: -1.5,
    };
    let grid = WalkGrid::over(Vec2::ZERO, 1.0, UVec2::splat(20), limits, height)
        .expect("the test made it so");
    assert!(grid.is_open(Vec2::new(5.0, 5.0)));
    assert!(!grid.is_open(Vec2::new(15.0, 5.0)), "too steep");
    let sea = WalkGrid::over(Vec2::ZERO, 1.0, UVec2::splat(9), limits, |at| -at.x * 0.5)
        .expect("the test made it so");
    assert!(sea.is_open(Vec2::new(1.5, 1.5)) && !sea.is_open(Vec2::new(3.5, 1.5)));
    assert!((sea.height(Vec2::new(1.25, 2.0)) + 0.625).abs() < 1e-6);
    for outside in [
        Vec2::splat(-0.1),
        Vec2::splat(20.1),
        Vec2::NAN,
        Vec2::INFINITY,
    ] {
        assert!(!grid.is_open(outside), "{outside}");
    }
    let size = UVec2::splat(4);
    assert!(matches!(
        WalkGrid::flat(Vec2::ZERO, 0.0, size),
        Err(GridError::Cell { .. })
    ));
    assert!(matches!(
        WalkGrid::flat(Vec2::NAN, 1.0, size),
        Err(GridError::Cell { .. })
    ));
    assert!(matches!(
        WalkGrid::flat(Vec2::ZERO, 1.0, UVec2::new(0, 4)),
        Err(GridError::Size(_))
    ));
    assert!(matches!(
        WalkGrid::flat(Vec2::ZERO, 1.0, UVec2::MAX),
        Err(GridError::Size(_))
    ));
    let hole = |at: Vec2| if at.x > 2.0 { f32::NAN } else { 0.0 };
    let hole = WalkGrid::over(Vec2::ZERO, 1.0, size, WalkLimits::default(), hole);
    assert!(matches!(hole, Err(GridError::Height(_))));
}

#[test]
fn a_field_has_the_lengths_of_straight_lines_and_leads_around_walls() {
    let mut grid = WalkGrid::flat(Vec2::ZERO, 0.5, UVec2::splat(101)).expect("the test made it so");
    let goal = grid.middle(IVec2::splat(50));
    let open = FlowField::new(Arc::new(grid.clone()), &[goal]);
    let mut worst = 0.0_f32;
    for z in 0..101 {
        for x in 0..101 {
            let at = grid.middle(IVec2::new(x, z));
            let straight = at.distance(goal);
            let over = open.distance(at) - straight;
            // First order: the error grows with the logarithm of the distance over the cell.
            worst = worst.max(over / straight.max(5.0));
            assert!(over > -1e-3, "never shorter than straight: {over}");
        }
    }
    println!(
        "fast marching: at most {:.1} % longer than straight",
        worst * 100.0
    );
    assert!(worst < 0.1, "{worst}");
    // A wall with a gap at one end: everybody comes to the goal, over open cells alone.
    for z in 5..101 {
        grid.set(IVec2::new(60, z), false);
    }
    let field = FlowField::new(
        Arc::new(grid.clone()),
        &[goal, Vec2::NAN, Vec2::splat(-5.0)],
    );
    let mut at = grid.middle(IVec2::new(95, 95));
    let mut length = 0.0;
    for _ in 0..10_000 {
        let next = grid.step(at, at + field.way(at) * 0.05);
        length += next.distance(at);
        assert!(grid.is_open(next));
        at = next;
        if at.distance(goal) < 0.5 {
            break;
        }
    }
    assert!(at.distance(goal) < 0.5, "{at}");
    // Over the corner of the wall and back.
    let corner = Vec2::new(30.0, 2.5);
    let taut = grid.middle(IVec2::new(95, 95)).distance(corner) + corner.distance(goal);
    println!("around the wall: {:.3} of the shortest", length / taut);
    assert!(length / taut < 1.06, "{length} {taut}");
    let closed = FlowField::new(Arc::new(grid), &[]);
    assert_eq!(
        (closed.distance(goal), closed.way(goal)),
        (NEVER, Vec2::ZERO)
    );
}

fn crowd(count: usize, side: u32, seed: u64) -> App {
    let mut app = app();
    let mut random = Random::new(seed);
    let grid = Arc::new(pillars(side, 1.0, &mut random));
    let end = side as f32;
    let corners = [
        Vec2::new(1.5, 1.5),
        Vec2::new(end - 1.5, 1.5),
        Vec2::splat(end - 1.5),
        Vec2::new(1.5, end - 1.5),
    ];
    let fields: Vec<Arc<FlowField>> = corners
        .iter()
        .map(|goal| {
            let goal = grid
                .nearest_open(*goal, 50)
                .expect("open ground near the corner");
            Arc::new(FlowField::new(Arc::clone(&grid), &[goal]))
        })
        .collect();
    for i in 0..count {
        let at = loop {
            let at = Vec2::new(random.unit(), random.unit()) * end;
            if grid.is_open(at) {
                break at;
            }
        };
        app.world_mut().spawn(Walker::new(at, (i % 4) as u16));
    }
    app.insert_resource(WalkGround(grid))
        .insert_resource(FlowFields(fields));
    app
}

fn walkers(app: &mut App) -> Vec<Walker> {
    let mut query = app.world_mut().query::<&Walker>();
    query.iter(app.world()).copied().collect()
}

#[test]
fn two_who_meet_pass_each_other() {
    let mut app = app();
    let grid =
        Arc::new(WalkGrid::flat(Vec2::ZERO, 1.0, UVec2::new(40, 10)).expect("the test made it so"));
    let ends = [Vec2::new(38.5, 5.0), Vec2::new(1.5, 5.0)];
    let fields = ends.map(|end| Arc::new(FlowField::new(Arc::clone(&grid), &[end])));
    app.insert_resource(WalkGround(grid))
        .insert_resource(FlowFields(fields.to_vec()));
    let one = app.world_mut().spawn(Walker::new(ends[1], 0)).id();
    let other = app.world_mut().spawn(Walker::new(ends[0], 1)).id();
    let at = |app: &App, who| {
        app.world()
            .get::<Walker>(who)
            .expect("the test made it so")
            .place
    };
    let mut least = f32::INFINITY;
    for _ in 0..64 * 40 {
        app.update();
        least = least.min(at(&app, one).distance(at(&app, other)));
    }
    assert!(at(&app, one).x > 36.0 && at(&app, other).x < 4.0);
    // Radii of 0.3 m each.
    println!("nearest: {least} m");
    assert!(least > 0.59, "{least}");
}

#[test]
fn a_crowd_stays_on_open_ground_and_comes_nearer() {
    let mut app = crowd(3000, 128, 9);
    let mean = |app: &mut App| {
        let fields = app.world().resource::<FlowFields>().0.clone();
        let all = walkers(app);
        let sum: f64 = all
            .iter()
            .map(|w| f64::from(fields[usize::from(w.field)].distance(w.place)))
            .filter(|d| d.is_finite())
            .sum();
        sum / all.len() as f64
    };
    let before = mean(&mut app);
    for _ in 0..64 * 20 {
        app.update();
        let step = app.world().resource::<dolomite_logic::LogicClock>().step;
        if step.is_multiple_of(16) {
            let grid = Arc::clone(&app.world().resource::<WalkGround>().0);
            let outside = walkers(&mut app)
                .iter()
                .filter(|w| !grid.is_open(w.place))
                .count();
            assert_eq!(outside, 0);
        }
    }
    let after = mean(&mut app);
    println!("mean way to the goal: {before:.1} m, after 20 s {after:.1} m");
    assert!(after < before - 15.0, "{before} {after}");
}

#[test]
fn bad_walkers_and_a_crowd_in_one_place_do_no_harm() {
    let mut app = crowd(10, 32, 1);
    let bad = [
        Walker {
            place: Vec2::NAN,
            ..Walker::new(Vec2::ONE, 0)
        },
        Walker {
            velocity: Vec2::INFINITY,
            ..Walker::new(Vec2::splat(9.5), 0)
        },
        Walker {
            speed: f32::NAN,
            ..Walker::new(Vec2::splat(9.5), 0)
        },
        Walker {
            radius: f32::NAN,
            ..Walker::new(Vec2::splat(9.5), 0)
        },
        Walker {
            speed: 1e30,
            ..Walker::new(Vec2::splat(9.5), 0)
        },
        Walker::new(Vec2::splat(9.5), 999),
        Walker::new(Vec2::splat(1e9), 0),
    ];
    let bad = bad.map(|walker| app.world_mut().spawn(walker).id());
    for _ in 0..20_000 {
        app.world_mut().spawn(Walker::new(Vec2::splat(10.25), 0));
    }
    steps(&mut app, 8);
    for walker in walkers(&mut app)
        .iter()
        .filter(|w| w.place.is_finite() && w.place.x < 1e8)
    {
        let grid = &app.world().resource::<WalkGround>().0;
        assert!(grid.is_open(walker.place), "{walker:?}");
    }
    assert!(
        app.world()
            .get::<Walker>(bad[0])
            .expect("the test made it so")
            .place
            .is_nan()
    );
}

#[test]
fn ground_that_closes_lets_people_out_and_transforms_follow() {
    let mut app = app();
    let mut grid = WalkGrid::over(
        Vec2::ZERO,
        1.0,
        UVec2::splat(20),
        WalkLimits::default(),
        |at| at.x * 0.1,
    )
    .expect("the test made it so");
    let place = Vec2::new(10.5, 10.5);
    let who = app
        .world_mut()
        .spawn((Walker::new(place, 0), Transform::default()))
        .id();
    grid.block(Vec3::new(10.0, 0.0, 10.0), Vec3::new(12.5, 1.0, 10.9), 0.0);
    assert!(!grid.is_open(place));
    app.insert_resource(WalkGround(Arc::new(grid)));
    steps(&mut app, 128);
    let grid = &app.world().resource::<WalkGround>().0;
    let at = app
        .world()
        .get::<Walker>(who)
        .expect("the test made it so")
        .place;
    assert!(grid.is_open(at), "{at}");
    let seen = app
        .world()
        .get::<Transform>(who)
        .expect("the test made it so")
        .translation;
    assert_eq!((seen.x, seen.z), (at.x, at.y));
    assert!((seen.y - at.x * 0.1).abs() < 1e-5);
}

#[test]
fn patrols_go_around_at_an_even_speed() {
    let circle: Vec<Vec3> = (0..8)
        .map(|i| {
            let turn = bevy::math::Rot2::degrees(45.0 * i as f32);
            Vec3::new(turn.cos * 10.0, 1.0, turn.sin * 10.0)
        })
        .collect();
    let route = Arc::new(Route::new(circle.clone()).expect("the test made it so"));
    let around = std::f32::consts::TAU * 10.0;
    assert!(
        (route.length() / around - 1.0).abs() < 0.01,
        "{}",
        route.length()
    );
    assert!(
        circle
            .iter()
            .all(|point| (0..1000).any(|i| route.at(i as f32 * 0.0632).distance(*point) < 0.1))
    );
    let mut app = app();
    let guard = app
        .world_mut()
        .spawn(Patrol::new(Arc::clone(&route), 2.0))
        .id();
    let mut last = None;
    for _ in 0..640 {
        app.update();
        let at = *app
            .world()
            .get::<Transform>(guard)
            .expect("the test made it so");
        if let Some(last) = last.replace(at.translation) {
            let speed = at.translation.distance(last) / SECONDS;
            assert!((speed - 2.0).abs() < 0.05, "{speed}");
            let forward = at.rotation * Vec3::NEG_Z;
            assert!(forward.dot((at.translation - last).normalize()) > 0.99);
        }
    }
    app.world_mut()
        .get_mut::<Patrol>(guard)
        .expect("the test made it so")
        .speed = f32::NAN;
    steps(&mut app, 2);
    assert_eq!(Route::new(vec![Vec3::ONE]), Err(RouteError::Points(1)));
    assert_eq!(
        Route::new(vec![Vec3::ONE, Vec3::NAN]),
        Err(RouteError::NotFinite(1))
    );
    assert_eq!(Route::new(vec![Vec3::ONE; 3]), Err(RouteError::NoLength));
}

/// A hundred thousand: milliseconds by stage, bytes, and those who sleep.
#[test]
fn a_hundred_thousand_walk_and_sleepers_cost_nothing() {
    let mut app = crowd(100_000, 512, 3);
    steps(&mut app, 4);
    let mut all = Vec::new();
    let (wall, cpu) = milliseconds(10, || {
        app.update();
        all.push(*app.world().resource::<WalkTimes>());
    });
    let sum = |t: &WalkTimes| t.gather + t.flow + t.sort + t.avoid + t.go;
    all.sort_by(|a, b| sum(a).total_cmp(&sum(b)));
    let counters = *app.world().resource::<WalkCounters>();
    let bytes = size_of::<Walker>() as u64 + counters.bytes / u64::from(counters.walkers);
    println!(
        "100 000 walkers, a tick: {wall:.2} ms at least, {cpu:.2} ms of all cores; {:?}; {bytes} bytes an agent",
        all[0]
    );
    assert_eq!(counters.walkers, 100_000);
    // Every second one of those that are hindered, every fourth of the others.
    assert!(
        (25_000..=50_000).contains(&counters.steered),
        "{counters:?}"
    );
    assert!(bytes <= 200, "{bytes}");
    let entities: Vec<Entity> = {
        let mut query = app.world_mut().query_filtered::<Entity, With<Walker>>();
        query.iter(app.world()).collect()
    };
    for entity in entities {
        app.world_mut().entity_mut(entity).insert(Asleep);
    }
    steps(&mut app, 2);
    assert_eq!(app.world().resource::<WalkCounters>().walkers, 0);
    let (_, cpu) = milliseconds(200, || app.update());
    println!(
        "100 000 asleep, a tick: {cpu:.4} ms of all cores, {:.3} ns each",
        cpu * 10.0
    );
    // 5 ns each.
    assert!(cpu < 0.5, "{cpu}");
}
