//! Movers on ground of `dolomite_terrain`, under `MinimalPlugins`.

use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::math::{DVec2, DVec3, Vec3, Vec3Swizzles as _, ops};
use bevy::time::{Fixed, Time, TimeUpdateStrategy};
use bevy::transform::components::Transform;
use dolomite_collision::ground::{GroundTiles, OnDrawnGround, bytes_of_tiles, tiles_made};
use dolomite_collision::{
    Body, CharacterBody, CollisionCounters, CollisionPlugin, MeetsMovers, MoveOutcome,
    MoveSettings, MoveState, MoveWish, Mover, Scratch, TreeSettings, TriangleMesh, TriangleTree,
    World as Bodies, advance,
};
use dolomite_terrain::{DrawnAnswer, Ground, GroundProbe, GroundRect, GroundSample};
use std::any::Any;
use std::sync::Arc;
use std::time::Duration;

/// Waves of half a metre, and a step within a rectangle.
struct Hills {
    raised: f64,
    within: GroundRect,
}

impl Hills {
    const fn new(raised: f64, within: GroundRect) -> Self {
        Self { raised, within }
    }

    fn waves() -> Arc<dyn Ground> {
        let nowhere = DVec2::splat(1e7);
        Arc::new(Self::new(0.0, GroundRect::new(nowhere, nowhere)))
    }
}

impl Ground for Hills {
    fn sample(&self, xz: DVec2) -> GroundSample {
        let [x, z] = [0.4 * xz.x, 0.3 * xz.y].map(|turn| turn as f32);
        let [sin, cos] = [ops::sin, ops::cos].map(|of| [of(x), of(z)].map(f64::from));
        let waves = 0.5 * sin[0] * cos[1];
        let raised = if self.within.contains(xz) {
            self.raised
        } else {
            0.0
        };
        GroundSample {
            height: waves + raised,
            gradient: DVec2::new(0.2 * cos[0] * cos[1], -0.15 * sin[0] * sin[1]),
        }
    }

    fn changed_rects(&self, before: &dyn Ground) -> Option<Vec<GroundRect>> {
        let before = before.as_any()?.downcast_ref::<Self>()?;
        Some(vec![self.within, before.within])
    }

    fn as_any(&self) -> Option<&dyn Any> {
        Some(self)
    }
}

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, CollisionPlugin));
    let step = Duration::from_millis(16);
    app.insert_resource(Time::<Fixed>::from_duration(step));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
    // The first frame takes no time.
    app.update();
    app
}

fn tiles(ground: Arc<dyn Ground>, cells: u32) -> GroundTiles {
    GroundTiles::new(ground, 0.5, cells).expect("half a metre is a power of two")
}

fn step(app: &mut App, mover: Entity, wish: Vec3) -> MoveState {
    let mut wished = app.world_mut().get_mut::<MoveWish>(mover);
    wished.as_mut().expect("a mover has one").0 = wish;
    app.update();
    let state = app.world().get::<MoveState>(mover);
    state.expect("a mover has one").clone()
}

fn walker(app: &mut App, at: Vec3) -> Entity {
    let mover = (CharacterBody::default(), Transform::from_translation(at));
    app.world_mut().spawn(mover).id()
}

/// Down as fast as one falls in a step, and on.
const WALK: Vec3 = Vec3::new(0.09, -0.05, 0.04);

/// From the tiles of an app: one mesh of the same samples over the whole way.
fn unbroken(ground: &GroundTiles, from: DVec2, side: i32) -> TriangleTree {
    let step = f64::from(ground.step());
    let first = (from / step).floor().as_ivec2();
    let mut triangles = Vec::new();
    for z in 0..side {
        for x in 0..side {
            let cell = first + bevy::math::IVec2::new(x, z);
            let corner = |dx: i32, dz: i32| {
                let at = (cell + bevy::math::IVec2::new(dx, dz)).as_dvec2() * step;
                let height = (ground.ground().height(at) * 65_536.0).round() / 65_536.0;
                DVec3::new(at.x, height, at.y)
            };
            let [nw, ne] = [corner(0, 0), corner(1, 0)];
            let [sw, se] = [corner(0, 1), corner(1, 1)];
            if ground.diagonals().falls(cell) {
                triangles.extend([[nw, sw, se], [nw, se, ne]]);
            } else {
                triangles.extend([[nw, sw, ne], [ne, sw, se]]);
            }
        }
    }
    let mesh = TriangleMesh::from_triangles(&triangles).expect("near its own place");
    TriangleTree::new(mesh, TreeSettings::default())
}

#[test]
fn a_walk_over_borders_of_tiles_is_that_over_one_mesh() {
    for start in [DVec3::new(3.0, 2.0, 5.0), DVec3::new(1e5, 2.0, -1e5)] {
        let mut app = app();
        let ground = tiles(Hills::waves(), 4);
        let tree = unbroken(&ground, start.xz() - 3.0, 120);
        app.world_mut().spawn((ground.clone(), MeetsMovers));
        let mover = walker(&mut app, start.as_vec3());
        let radii = CharacterBody::default().radii.as_dvec3();
        let mut reference = Mover::new(start.as_vec3().as_dvec3(), radii);
        let bodies = [Body::fixed(&tree)];
        let (mut scratch, mut outcome) = (Scratch::default(), MoveOutcome::default());
        let mut stood = 0;
        for k in 0..500 {
            let state = step(&mut app, mover, WALK);
            let settings = MoveSettings::default();
            let world = Bodies::new(&bodies);
            let wish = WALK.as_dvec3();
            advance(
                &world,
                &mut reference,
                wish,
                &settings,
                &mut scratch,
                &mut outcome,
            );
            let apart = state.center.distance(reference.center);
            // Both start from the same place, on triangles of the same corners: what is left is the rounding of meshes
            // with different origins, 1e-5 m at 60 m from one.
            assert!(apart < 1e-4, "{start}, step {k}: {apart} m apart");
            assert_eq!(state.grounded(), outcome.grounded, "{start}, step {k}");
            stood += u32::from(state.grounded());
            let surface = ground.surface(state.center.xz()).unwrap();
            assert!(state.center.y > surface + 0.85, "{start}, step {k}");
        }
        assert!(stood > 450, "{stood}");
        assert!(tiles_made(app.world()) > 30);
    }
}

#[test]
fn only_tiles_that_have_changed_are_made_anew_and_who_is_below_is_put_onto_them() {
    let mut app = app();
    let ground = tiles(Hills::waves(), 8);
    let entity = app.world_mut().spawn((ground.clone(), MeetsMovers)).id();
    let mover = walker(&mut app, Vec3::new(1.0, 3.0, 1.0));
    for _ in 0..90 {
        step(&mut app, mover, Vec3::NEG_Y * 0.05);
    }
    assert!(app.world().get::<MoveState>(mover).unwrap().grounded());
    let made = tiles_made(app.world());
    let set = |app: &mut App, ground: Hills| {
        let mut tiles = app.world_mut().get_mut::<GroundTiles>(entity).unwrap();
        tiles.set_ground(Arc::new(ground));
    };
    // Elsewhere: nothing is made anew.
    let far = GroundRect::new(DVec2::splat(500.0), DVec2::splat(501.0));
    set(&mut app, Hills::new(3.0, far));
    step(&mut app, mover, Vec3::ZERO);
    assert_eq!(tiles_made(app.world()), made);
    // Below its feet, by more than its height.
    let here = GroundRect::new(DVec2::new(0.25, 0.25), DVec2::new(1.75, 1.75));
    set(&mut app, Hills::new(3.0, here));
    step(&mut app, mover, Vec3::ZERO);
    assert_eq!(tiles_made(app.world()), made + 1, "one tile of 4 m");
    let state = step(&mut app, mover, Vec3::NEG_Y * 0.05);
    assert!(state.grounded() && state.center.y > 3.0, "{}", state.center);
}

#[test]
fn tiles_go_with_who_needs_them_and_nothing_is_kept_without_a_mover() {
    let mut app = app();
    app.world_mut()
        .spawn((tiles(Hills::waves(), 8), MeetsMovers));
    app.update();
    assert_eq!(bytes_of_tiles(app.world()), 0);
    let mover = walker(&mut app, Vec3::new(1.0, 1.0, 1.0));
    step(&mut app, mover, Vec3::ZERO);
    let few = bytes_of_tiles(app.world());
    assert!(few > 1000);
    for _ in 0..400 {
        step(&mut app, mover, Vec3::new(1.0, -0.05, 0.0));
    }
    let walked = bytes_of_tiles(app.world());
    // 120 steps of a metre are kept, of tiles of 4 m, two to three wide; all 400 would be 100 wide.
    assert!(walked > few && walked < 40 * few, "{few}, then {walked}");
    assert!(app.world().resource::<CollisionCounters>().bodies < 16);
    app.world_mut().despawn(mover);
    app.update();
    assert_eq!(bytes_of_tiles(app.world()), 0);
}

#[test]
fn ground_without_the_marker_is_not_met_and_heights_that_are_none_are() {
    struct Holes;
    impl Ground for Holes {
        fn sample(&self, _: DVec2) -> GroundSample {
            GroundSample {
                height: f64::NAN,
                gradient: DVec2::ZERO,
            }
        }
    }
    let fallen = |marked: bool, ground: Arc<dyn Ground>| {
        let mut app = app();
        let entity = app.world_mut().spawn(tiles(ground, 8)).id();
        if marked {
            app.world_mut().entity_mut(entity).insert(MeetsMovers);
        }
        let mover = walker(&mut app, Vec3::new(1.0, 2.0, 1.0));
        for _ in 0..60 {
            step(&mut app, mover, Vec3::NEG_Y * 0.05);
        }
        app.world().get::<MoveState>(mover).unwrap().center.y
    };
    assert!(fallen(false, Hills::waves()) < -0.9);
    assert!(fallen(true, Hills::waves()) > 0.8);
    // A hole would let it fall.
    assert!((fallen(true, Arc::new(Holes)) - 0.9).abs() < 1e-3);
}

#[test]
fn a_mover_is_drawn_on_what_was_drawn_and_walks_as_if_it_were_not() {
    let mut app = app();
    let ground = tiles(Hills::waves(), 8);
    app.world_mut().spawn((ground.clone(), MeetsMovers));
    let start = Vec3::new(1.0, 1.5, 1.0);
    let plain = walker(&mut app, start);
    let drawn = walker(&mut app, start);
    app.world_mut()
        .entity_mut(drawn)
        .insert(OnDrawnGround::default());
    let bound = 0.04;
    let mut raised = 0_u32;
    for k in 0..300 {
        let at = app.world().get::<MoveState>(drawn).unwrap().center;
        // What a camera drew a step ago: the true plane, 3 cm off, up and down in turns.
        let mut sample = Hills::waves().sample(at.xz());
        let off = if k / 50 % 2 == 0 { 0.03 } else { -0.03 };
        sample.height += off;
        app.world_mut().get_mut::<GroundProbe>(drawn).unwrap().drawn = Some(DrawnAnswer {
            sample,
            place: at.xz(),
            bound,
            frame: k,
        });
        app.world_mut().get_mut::<MoveWish>(plain).unwrap().0 = WALK;
        let state = step(&mut app, drawn, WALK);
        let other = app.world().get::<MoveState>(plain).unwrap();
        assert_eq!(state.center, other.center, "step {k}");
        let on = app.world().get::<OnDrawnGround>(drawn).unwrap().raised;
        let place = app.world().get::<Transform>(drawn).unwrap().translation;
        let expected = state.center.y + on;
        assert!((f64::from(place.y) - expected).abs() < 1e-6, "step {k}");
        if state.grounded() {
            raised += u32::from(on * off > 0.0);
            let truth = Hills::waves().height(state.center.xz());
            let missed = (ground.surface(state.center.xz()).unwrap() - truth).abs();
            // The round foot on slopes that differ by what samples of half a metre miss of them.
            assert!(on.abs() <= bound + missed + 0.01, "step {k}: {on}");
        } else {
            assert_eq!(on, 0.0, "in the air, step {k}");
        }
    }
    assert!(raised > 200, "{raised}");
}
