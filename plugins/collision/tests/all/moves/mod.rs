//! Movers on floors, slopes, steps, between walls and on what moves.

mod hostile;

use crate::support::meshes::{floor, soup};
use crate::support::random::{direction, place, size};
use bevy::math::{DQuat, DVec3, Vec3, Vec3Swizzles as _};
use bevy::tasks::{ComputeTaskPool, TaskPoolBuilder};
use dolomite_collision::motion::ITERATIONS;
use dolomite_collision::{
    Body, Ellipsoid, MoveError, MoveOutcome, MoveSettings, Mover, Pose, Scratch, TreeKind,
    TreeSettings, TriangleMesh, TriangleTree, World, advance, advance_all,
};
use dolomite_testkit::metrics::Hash64;
use dolomite_testkit::random::Random;

const FIGURE: DVec3 = DVec3::new(0.3, 0.9, 0.3);

fn tree(mesh: TriangleMesh) -> TriangleTree {
    TriangleTree::new(mesh, TreeSettings::default())
}

fn cuboid(center: [f64; 3], half: [f32; 3]) -> TriangleTree {
    tree(TriangleMesh::cuboid(center.into(), half.into()).expect("a valid box"))
}

struct Walker {
    mover: Mover,
    settings: MoveSettings,
    scratch: Scratch,
    outcome: MoveOutcome,
}

impl Walker {
    fn at(place: [f64; 3]) -> Self {
        Self {
            mover: Mover::new(place.into(), FIGURE),
            settings: MoveSettings::default(),
            scratch: Scratch::default(),
            outcome: MoveOutcome::default(),
        }
    }

    fn go(&mut self, bodies: &[Body], wish: DVec3) -> DVec3 {
        let world = World::new(bodies);
        advance(
            &world,
            &mut self.mover,
            wish,
            &self.settings,
            &mut self.scratch,
            &mut self.outcome,
        );
        assert_eq!(self.outcome.error, None);
        assert!(self.outcome.iterations <= ITERATIONS);
        self.mover.center
    }

    /// Depth into what is there, metres.
    fn depth(&self, body: &Body) -> f64 {
        depth(&self.mover, body)
    }
}

fn depth(mover: &Mover, body: &Body) -> f64 {
    // Where the mover is a unit sphere, by distances of f64: 1 − |nearest|, times the least radius.
    let ellipsoid = Ellipsoid::upright(body.after.inward(mover.center), mover.radii);
    let mut deepest = 0.0_f64;
    for triangle in body.tree.overlapping(&ellipsoid.into()) {
        let to_unit = ellipsoid.to_unit();
        let corners = body
            .tree
            .mesh()
            .corners(triangle)
            .map(|c| to_unit * (c - ellipsoid.center));
        let (point, _) = dolomite_collision::geometry::nearest_on_triangle(DVec3::ZERO, corners);
        deepest = deepest.max((1.0 - point.length()) * mover.radii.max_element());
    }
    deepest
}

#[test]
fn a_flat_floor_is_flat_over_its_seams() {
    let ground = tree(floor(60, 0.37, |_, _| 0.0));
    let bodies = [Body::fixed(&ground)];
    let mut walker = Walker::at([0.0, 1.5, 0.0]);
    let mut random = Random::new(51);
    for _ in 0..200 {
        walker.go(&bodies, DVec3::Y * -0.05);
    }
    assert!(walker.outcome.grounded);
    let height = walker.mover.center.y;
    // By the gap of a millionth of the radius.
    assert!((height - 0.9).abs() < 2e-6, "{height}");
    let mut wish = DVec3::X * 0.1;
    let mut sideways = 0.0_f64;
    for step in 0..20_000 {
        if step % 50 == 0 || walker.mover.center.xz().abs().max_element() > 10.0 {
            wish = direction(&mut random) * DVec3::new(0.1, 0.0, 0.1);
            if wish.dot(walker.mover.center) > 0.0 {
                wish = -wish;
            }
        }
        let before = walker.mover.center;
        let after = walker.go(&bodies, wish - DVec3::Y * 0.01);
        sideways = sideways.max(((after - before) - wish).xz().length());
        assert!(walker.outcome.grounded, "step {step}");
        assert!((after.y - height).abs() < 1e-5, "step {step}: {}", after.y);
    }
    assert!(sideways < 1e-12, "{sideways:e}");
}

#[test]
fn walls_creases_and_corners() {
    let ground = tree(floor(20, 1.0, |_, _| 0.0));
    let wall = cuboid([5.5, 2.0, 0.0], [0.5, 2.0, 9.0]);
    let other = cuboid([0.0, 2.0, 5.5], [9.0, 2.0, 0.5]);
    let bodies = [
        Body::fixed(&ground),
        Body::fixed(&wall),
        Body::fixed(&other),
    ];
    let mut walker = Walker::at([4.0, 0.95, 0.0]);
    walker.go(&bodies, DVec3::Y * -0.2);
    // Along the wall.
    for _ in 0..20 {
        walker.go(&bodies, DVec3::new(0.1, -0.05, 0.1));
    }
    let c = walker.mover.center;
    assert!((c.x - 4.7).abs() < 1e-5 && (c.z - 2.0).abs() < 1e-6, "{c}");
    // Into the corner, and no farther.
    for _ in 0..60 {
        walker.go(&bodies, DVec3::new(0.1, -0.05, 0.1));
    }
    let c = walker.mover.center;
    assert!((c - DVec3::new(4.7, 0.9, 4.7)).length() < 1e-5, "{c}");
    // And out again.
    walker.go(&bodies, DVec3::new(-0.5, -0.05, 0.0));
    assert!((walker.mover.center.x - 4.2).abs() < 1e-5);
}

#[test]
fn slopes_are_stood_on_or_slid_down() {
    for (rise, stays) in [(0.5, true), (1.1, true), (1.3, false), (3.0, false)] {
        let slope = tree(floor(40, 1.0, |x, _| x * rise));
        let bodies = [Body::fixed(&slope)];
        let mut walker = Walker::at([0.0, 3.0, 0.0]);
        for _ in 0..400 {
            walker.go(&bodies, DVec3::Y * -0.02);
        }
        let stood = walker.mover.center;
        assert_eq!(walker.outcome.grounded, stays, "{rise}");
        let later = walker.go(&bodies, DVec3::Y * -0.02);
        if stays {
            // It fell onto it straight, and does not creep.
            assert!(
                stood.x.abs() < 0.2 && later.distance(stood) < 1e-9,
                "{rise} {stood} {later}"
            );
        } else {
            assert!(stood.x < -1.0, "{rise}: {stood}");
        }
        // Up it, if it is not a wall.
        let mut walker = Walker::at([-9.0, -9.0 * f64::from(rise) + 2.0, 0.0]);
        for _ in 0..200 {
            walker.go(&bodies, DVec3::Y * -0.02);
        }
        let start = walker.mover.center;
        for _ in 0..20 {
            walker.go(&bodies, DVec3::new(0.1, -0.02, 0.0));
        }
        let climbed = walker.mover.center.y - start.y;
        assert_eq!(climbed > 0.5, stays, "{rise}: {climbed}");
    }
}

#[test]
fn steps_are_climbed_as_high_as_said() {
    for (height, climbs) in [
        (0.1, true),
        (0.3, true),
        (0.34, true),
        (0.5, false),
        (0.9, false),
    ] {
        let ground = tree(floor(20, 1.0, |_, _| 0.0));
        let step = cuboid([4.0, height / 2.0, 0.0], [2.0, height as f32 / 2.0, 5.0]);
        let bodies = [Body::fixed(&ground), Body::fixed(&step)];
        let mut walker = Walker::at([0.0, 0.91, 0.0]);
        walker.go(&bodies, DVec3::Y * -0.1);
        for count in 0..60 {
            walker.go(&bodies, DVec3::new(0.08, -0.02, 0.0));
            assert!(
                walker.outcome.grounded,
                "{height} {count} {}",
                walker.mover.center
            );
            assert!(walker.depth(&bodies[1]) < 1e-4);
        }
        let c = walker.mover.center;
        assert_eq!((c.y - 0.9 - height).abs() < 1e-3, climbs, "{height}: {c}");
        if climbs {
            // Down again, held to the ground all the way.
            for _ in 0..80 {
                walker.go(&bodies, DVec3::new(-0.08, -0.02, 0.0));
                if height <= 0.3 {
                    assert!(walker.outcome.grounded, "{height}");
                }
            }
            assert!((walker.mover.center.y - 0.9).abs() < 1e-3);
        }
    }
}

#[test]
fn a_jump_leaves_the_ground() {
    let ground = tree(floor(20, 1.0, |_, _| 0.0));
    let bodies = [Body::fixed(&ground)];
    let mut walker = Walker::at([0.0, 0.95, 0.0]);
    walker.go(&bodies, DVec3::Y * -0.1);
    assert!(walker.outcome.grounded);
    walker.go(&bodies, DVec3::Y * 0.05);
    assert!(!walker.outcome.grounded);
    assert!((walker.mover.center.y - 0.95).abs() < 1e-5);
    walker.go(&bodies, DVec3::Y * -0.03);
    assert!(!walker.outcome.grounded);
    walker.go(&bodies, DVec3::Y * -0.03);
    assert!(walker.outcome.grounded);
}

#[test]
fn lifts_carry_up_and_down() {
    let plate = cuboid([0.0, 0.0, 0.0], [2.0, 0.2, 2.0]);
    let mut random = Random::new(52);
    for ride in 0..300 {
        let mut walker = Walker::at([0.3, 1.11, -0.4]);
        let mut at = Pose::IDENTITY;
        let mut speed = direction(&mut random) * 10.0 * random.unit();
        walker.go(&[Body::standing(&plate, at)], DVec3::Y * -0.05);
        let mut offset = DVec3::new(0.3, 0.0, -0.4);
        for step in 0..60 {
            if step % 15 == 0 {
                speed = if random.below(2) == 0 {
                    -speed
                } else {
                    direction(&mut random) * 10.0
                };
            }
            // From 1 ms to 50 ms.
            let time = 0.001 + 0.049 * random.unit();
            let mut after = Pose::at(at.translation + speed * time);
            if ride % 3 == 0 {
                let turn = DQuat::from_axis_angle(DVec3::Y, time);
                after.rotation = turn * at.rotation;
                offset = turn * offset;
            }
            let body = Body {
                tree: &plate,
                before: at,
                after,
            };
            walker.go(&[body], DVec3::Y * (-9.81 * time * time));
            at = after;
            assert!(
                walker.outcome.grounded && !walker.outcome.crushed,
                "{ride} {step}"
            );
            let gap = walker.mover.center.y - at.translation.y - 1.1;
            assert!(gap.abs() < 1e-3, "{ride} {step}: {gap}");
            let drift = walker.mover.center - at.translation - offset;
            assert!(drift.xz().length() < 1e-6, "{ride} {step}: {drift}");
        }
    }
}

#[test]
fn what_moves_pushes_and_crushes() {
    let ground = tree(floor(20, 1.0, |_, _| 0.0));
    let piston = cuboid([0.0, 0.0, 0.0], [0.5, 2.0, 2.0]);
    let wall = cuboid([5.5, 2.0, 0.0], [0.5, 2.0, 9.0]);
    let mut walker = Walker::at([2.0, 0.91, 0.0]);
    let mut x = 0.0;
    let mut crushed = 0;
    for _ in 0..40 {
        let before = Pose::at(DVec3::new(x, 1.0, 0.0));
        // 15 m a second, and in one step more than its own thickness.
        x += 0.25;
        let after = Pose::at(DVec3::new(x.min(4.4), 1.0, 0.0));
        let bodies = [
            Body::fixed(&ground),
            Body::fixed(&wall),
            Body {
                tree: &piston,
                before: Pose::at(DVec3::new(before.translation.x.min(4.4), 1.0, 0.0)),
                after,
            },
        ];
        walker.go(&bodies, DVec3::Y * -0.01);
        let c = walker.mover.center;
        assert!(c.x < 4.71 && c.x > after.translation.x, "{c} {x}");
        if after.translation.x + 0.5 + 0.3 < 4.69 {
            assert!(c.x - after.translation.x > 0.8 - 1e-4, "{c}");
            assert!(!walker.outcome.crushed, "{x}");
        }
        crushed += u32::from(walker.outcome.crushed);
    }
    assert!(crushed > 0);
}

/// Between walls that are too near, who is crushed is told by the largest radius: a depth is known in parts of the
/// radii, and along the shortest of them it would be told too late.
#[test]
fn crushed_is_told_by_the_largest_radius() {
    // A mover of radius 0.3 m across, in a gap that is narrower by `less` of that on each side. Moved out of one wall
    // it is in the other by twice that.
    let crushed = |radii: [f64; 3], less: f64| {
        let wall = |side: f64| {
            cuboid(
                [side * (0.3 * (1.0 - less) + 0.5), 0.0, 0.0],
                [0.5, 3.0, 3.0],
            )
        };
        let (left, right) = (wall(-1.0), wall(1.0));
        let bodies = [Body::fixed(&left), Body::fixed(&right)];
        let mut walker = Walker::at([0.0; 3]);
        walker.mover.radii = radii.into();
        walker.go(&bodies, DVec3::ZERO);
        assert!(
            walker.outcome.casts > 16,
            "it is moved out as often as may be"
        );
        let deepest = walker.depth(&bodies[0]).max(walker.depth(&bodies[1]));
        // What is said agrees with the depth that all else is judged by.
        assert_eq!(
            walker.outcome.crushed,
            deepest > 1e-4,
            "{radii:?} {less}: {deepest:e}"
        );
        walker.outcome.crushed
    };
    // 0.06 mm along the normal: of a ball that is nothing, of one three times as high as wide it may be 0.18 mm.
    assert!(!crushed([0.3; 3], 1e-4));
    assert!(crushed([0.3, 0.9, 0.3], 1e-4));
    assert!(!crushed([0.3, 0.9, 0.3], 4e-5));
    assert!(crushed([0.3; 3], 4e-4));
}

/// Who is pushed and has nowhere to go is crushed, and who has is not.
#[test]
fn a_push_crushes_who_has_nowhere_to_go() {
    let piston = cuboid([0.0; 3], [0.5, 2.0, 2.0]);
    let wall = cuboid([2.0, 0.0, 0.0], [0.5, 2.0, 2.0]);
    let pushed = |bodies: &[Body]| {
        let mut walker = Walker::at([1.0, 0.0, 0.0]);
        walker.go(bodies, DVec3::ZERO);
        walker.outcome.crushed
    };
    let moving = Body {
        tree: &piston,
        before: Pose::at(DVec3::new(0.0, 0.0, 0.0)),
        after: Pose::at(DVec3::new(0.6, 0.0, 0.0)),
    };
    // 0.4 m on, of which the wall leaves 0.2.
    assert!(!pushed(&[moving]));
    assert!(pushed(&[moving, Body::fixed(&wall)]));
    let less = Body {
        after: Pose::at(DVec3::new(0.39, 0.0, 0.0)),
        ..moving
    };
    assert!(!pushed(&[less, Body::fixed(&wall)]));
}
