//! Movers and Rapier's bodies push each other.

use super::*;
use bevy::math::DVec3;
use bevy::time::{Fixed, Time, Virtual};
use dolomite_collision::rapier::{MeetsMovers, Pusher};
use dolomite_collision::{
    CharacterBody, Collider, MoveState, MoveWish, TreeSettings, TriangleMesh, TriangleTree,
};

fn floor() -> Arc<TriangleTree> {
    let corner = |x: f64, z: f64| DVec3::new(x, 0.0, z) * 100.0;
    let (a, b, c, d) = (
        corner(-1.0, -1.0),
        corner(-1.0, 1.0),
        corner(1.0, 1.0),
        corner(1.0, -1.0),
    );
    let mesh =
        TriangleMesh::from_triangles(&[[a, b, c], [a, c, d]]).expect("both triangles have an area");
    Arc::new(TriangleTree::new(mesh, TreeSettings::default()))
}

/// A mover on a floor, and the same floor for Rapier.
fn with_mover(force: Option<f32>) -> (App, Entity) {
    let mut app = app();
    app.world_mut().spawn(ground_tiles(flat, 8));
    app.world_mut().spawn(Collider(floor()));
    let figure = (
        CharacterBody::default(),
        Transform::from_xyz(0.0, 0.901, 0.0),
    );
    let mover = app.world_mut().spawn(figure).id();
    if let Some(force) = force {
        app.world_mut().entity_mut(mover).insert(Pusher { force });
    }
    (app, mover)
}

fn walk(app: &mut App, mover: Entity, speed: f32, count: usize) {
    for _ in 0..count {
        let wish = Vec3::new(speed, -1.0, 0.0) / 64.0;
        app.world_mut()
            .get_mut::<MoveWish>(mover)
            .expect("the mover has a wish")
            .0 = wish;
        steps(app, 1);
    }
}

#[test]
fn a_mover_pushes_a_stone_as_hard_as_it_may() {
    let pushed = |force: Option<f32>| {
        let (mut app, mover) = with_mover(force);
        let stone = ball(&mut app, 0.5, Vec3::new(2.0, 0.5, 0.0), Vec3::ZERO);
        app.world_mut().entity_mut(stone).insert(MeetsMovers);
        walk(&mut app, mover, 2.0, 128);
        (place(&app, stone).x, place(&app, mover).x)
    };
    let (still, stopped) = pushed(None);
    assert!((still - 2.0).abs() < 1e-3, "nobody pushes: {still}");
    assert!(stopped < 1.3, "the stone is in the way: {stopped}");
    let (rolled, walked) = pushed(Some(400.0));
    assert!(rolled > 3.0, "{rolled}");
    assert!(walked > 2.0 && walked < rolled, "{walked} behind {rolled}");
    let (weak, _) = pushed(Some(1.0));
    assert!(weak < rolled - 0.3, "{weak} of {rolled}");
    // The mover's own stand-in touches the stone, but nothing pushes: no number is no more than nothing is.
    let nothing = pushed(Some(0.0));
    assert!(nothing.0 < weak, "{nothing:?} {weak}");
    for force in [-400.0, f32::NAN] {
        assert_eq!(pushed(Some(force)), nothing, "{force} N");
    }
}

/// Steps of an hour: who falls lands, whatever becomes of what Rapier moves, and the next step comes.
#[test]
fn steps_of_an_hour_are_survived() {
    const HOUR: Duration = Duration::from_secs(3600);
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, RapierBridgePlugin))
        .insert_resource(Time::<Fixed>::from_duration(HOUR))
        .insert_resource(TimeUpdateStrategy::ManualDuration(HOUR));
    // Frames of more than a quarter of a second are else cut short.
    app.world_mut()
        .resource_mut::<Time<Virtual>>()
        .set_max_delta(2 * HOUR);
    app.finish();
    app.cleanup();
    app.update();
    app.world_mut().spawn(ground_tiles(flat, 8));
    app.world_mut().spawn(Collider(floor()));
    let figure = (
        CharacterBody::default(),
        Pusher::default(),
        Transform::from_xyz(0.0, 5.0, 0.0),
    );
    let mover = app.world_mut().spawn(figure).id();
    let lies = cube(&mut app, 0.5, Vec3::new(20.0, 0.5, 0.0));
    ball(&mut app, 0.5, Vec3::new(-20.0, 9.0, 0.0), Vec3::splat(1e4));
    for step in 0..4 {
        let fall = -9.81 * HOUR.as_secs_f32() * HOUR.as_secs_f32();
        app.world_mut()
            .get_mut::<MoveWish>(mover)
            .expect("the mover has a wish")
            .0 = Vec3::Y * fall;
        app.update();
        let state = app.world().get::<MoveState>(mover).expect("it stays");
        assert!(state.grounded(), "{step}: {state:?}");
        assert!((place(&app, mover).y - 0.9).abs() < 1e-4, "{step}");
    }
    let at = place(&app, lies);
    assert!(at.is_finite(), "{at}");
}

#[test]
fn a_stone_that_movers_meet_no_more_is_walked_through() {
    let forget: [fn(&mut App, Entity); 2] = [
        |app, stone| {
            app.world_mut().entity_mut(stone).remove::<MeetsMovers>();
        },
        |app, stone| {
            app.world_mut().entity_mut(stone).remove::<RapierCollider>();
        },
    ];
    for forget in forget {
        let (mut app, mover) = with_mover(None);
        let stone = ball(&mut app, 0.5, Vec3::new(2.0, 0.5, 0.0), Vec3::ZERO);
        app.world_mut().entity_mut(stone).insert(MeetsMovers);
        walk(&mut app, mover, 2.0, 48);
        let stopped = place(&app, mover).x;
        assert!(stopped < 1.3, "the stone is in the way: {stopped}");
        forget(&mut app, stone);
        walk(&mut app, mover, 2.0, 128);
        let walked = place(&app, mover).x;
        assert!(walked > 3.0, "nothing is in the way: {walked}");
        assert!(app.world().get::<Collider>(stone).is_none());
    }
}

#[test]
fn a_mover_without_its_body_pushes_no_more() {
    let (mut app, mover) = with_mover(Some(400.0));
    let stone = ball(&mut app, 0.5, Vec3::new(2.0, 0.5, 0.0), Vec3::ZERO);
    app.world_mut().entity_mut(stone).insert(MeetsMovers);
    let touches = |app: &App| {
        let state = app.world().get::<MoveState>(mover).expect("it stays");
        state.contacts().any(|(entity, _)| entity == stone)
    };
    for _ in 0..128 {
        walk(&mut app, mover, 2.0, 1);
        if touches(&app) {
            break;
        }
    }
    assert!(touches(&app), "it walks into the stone");
    app.world_mut().entity_mut(mover).remove::<CharacterBody>();
    app.world_mut()
        .entity_mut(stone)
        .insert(Velocity::linear(Vec3::ZERO));
    let before = place(&app, stone).x;
    steps(&mut app, 64);
    let rolled = place(&app, stone).x - before;
    assert!(touches(&app) && rolled.abs() < 0.05, "{rolled}");
}

#[test]
fn a_stone_pushes_a_mover_and_does_not_pass_through() {
    let (mut app, mover) = with_mover(Some(400.0));
    let stone = ball(
        &mut app,
        0.5,
        Vec3::new(-3.0, 0.5, 0.0),
        Vec3::new(5.0, 0.0, 0.0),
    );
    app.world_mut().entity_mut(stone).insert(MeetsMovers);
    for _ in 0..128 {
        walk(&mut app, mover, 0.0, 1);
        let (stone, mover) = (place(&app, stone), place(&app, mover));
        assert!(stone.x < mover.x, "{stone} {mover}");
    }
    assert!(
        app.world()
            .get::<MoveState>(mover)
            .expect("it is there: the body is on the ground")
            .grounded()
    );
    // The stand-in goes with its mover.
    app.world_mut().entity_mut(mover).despawn();
    steps(&mut app, 2);
    let mut kinds = app.world_mut().query::<&RigidBody>();
    assert_eq!(kinds.iter(app.world()).count(), 1, "the stone alone");
}
