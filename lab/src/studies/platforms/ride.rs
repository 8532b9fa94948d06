//! One mover on one lift.

use bevy::math::{DQuat, DVec2, DVec3, Vec3};
use dolomite_collision::motion::GAP;
use dolomite_collision::{
    Body, MoveOutcome, MoveSettings, Mover, Pose, Scratch, TreeKind, TreeSettings, TriangleMesh,
    TriangleTree, World,
};
use dolomite_testkit::places::{direction, size};
use dolomite_testkit::random::Random;

/// Steps of a ride.
pub const STEPS: u32 = 32;

/// The fastest lift, metres a second.
pub const FASTEST: f64 = 10.0;

/// What lifts do.
pub const KINDS: [&str; 6] = [
    "up",
    "down",
    "diagonal",
    "reversing",
    "turning",
    "1e5 m away, diagonal",
];

/// What became of a ride.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ride {
    /// The largest distance of the foot from the lift, metres.
    pub gap: f64,
    /// How deep it was in it, metres.
    pub depth: f64,
    /// Steps after which it did not stand on the lift.
    pub falls: u32,
    /// How far it is at the end from where the lift and its own walk lead, level, metres.
    pub beside: f64,
    /// Sweeps and queries.
    pub casts: u32,
    /// Bits of where it is.
    pub bits: u64,
}

/// Trees of lifts, by their half size: a metre, and of two shapes more.
pub fn lifts() -> Vec<(Vec3, TriangleTree)> {
    let sizes = [
        Vec3::new(1.0, 0.1, 1.0),
        Vec3::new(2.0, 1.0, 0.75),
        Vec3::new(4.0, 0.02, 3.0),
    ];
    let settings = TreeSettings {
        kind: TreeKind::List,
        ..TreeSettings::default()
    };
    let tree = |half: Vec3| {
        let mesh = TriangleMesh::cuboid(DVec3::ZERO, half).expect("lifts have a size");
        (half, TriangleTree::new(mesh, settings))
    };
    sizes.map(tree).to_vec()
}

/// Who makes one step of a mover: [`dolomite_collision::advance`], and in a test who does it wrongly.
pub type Advance = fn(&World, &mut Mover, DVec3, &MoveSettings, &mut Scratch, &mut MoveOutcome);

/// Rides. Steps take 1/240 to 1/15 s, each its own; the mover stands or walks on the lift at up to 3 m/s.
pub fn ride(
    random: &mut Random,
    kind: usize,
    (half, tree): &(Vec3, TriangleTree),
    scratch: &mut Scratch,
    outcome: &mut MoveOutcome,
    advance: Advance,
) -> Ride {
    let origin = match kind {
        5 => direction(random) * 1e5,
        _ => direction(random) * 20.0,
    };
    let speed = random.unit() * FASTEST;
    let mut velocity = match kind {
        0 => DVec3::Y * speed,
        1 => -DVec3::Y * speed,
        3 => DVec3::Y * speed * [1.0, -1.0][random.below(2)],
        _ => direction(random) * speed,
    };
    let turn = match kind {
        4 => random.signed_unit() * 3.0,
        _ => 0.0,
    };
    let radii = DVec3::new(
        size(random, 0.15, 0.4),
        size(random, 0.4, 1.0),
        size(random, 0.15, 0.4),
    );
    let half = half.as_dvec3();
    let walks = random.below(2) == 0;
    // Where it stands, seen from the lift.
    let part = 0.5;
    let mut at = DVec2::new(
        random.signed_unit() * half.x * part,
        random.signed_unit() * half.z * part,
    );
    let mut pose = Pose::at(origin);
    let top = |pose: &Pose| pose.translation.y + half.y;
    let foot = radii.y * (1.0 + GAP);
    let start = pose.outward(DVec3::new(at.x, half.y, at.y)) + DVec3::Y * foot;
    let mut mover = Mover::new(start, radii);
    let mut ride = Ride::default();
    let settings = MoveSettings::default();
    // The first step is for coming to stand.
    for step in 0..=STEPS {
        let seconds = size(random, 1.0 / 240.0, 1.0 / 15.0);
        if kind == 3 && random.below(6) == 0 {
            velocity = -velocity;
        }
        let before = pose;
        if step > 0 {
            pose = Pose {
                translation: pose.translation + velocity * seconds,
                rotation: (DQuat::from_rotation_y(turn * seconds) * pose.rotation).normalize(),
            };
        }
        let mut walk = DVec2::ZERO;
        if walks && step > 0 {
            let goal = DVec2::new(
                random.signed_unit() * half.x * part,
                random.signed_unit() * half.z * part,
            );
            walk = (goal - at).clamp_length_max(3.0 * seconds);
            at += walk;
        }
        let wish =
            pose.rotation * DVec3::new(walk.x, 0.0, walk.y) - DVec3::Y * (9.81 * seconds * seconds);
        let bodies = [Body {
            tree,
            before,
            after: pose,
        }];
        let world = World::new(&bodies);
        advance(&world, &mut mover, wish, &settings, scratch, outcome);
        ride.casts += outcome.casts;
        if step == 0 {
            continue;
        }
        ride.falls += u32::from(!outcome.grounded || mover.stands_on != Some(0));
        let gap = mover.center.y - radii.y - top(&pose);
        ride.gap = ride.gap.max(gap);
        ride.depth = ride.depth.max(-gap);
    }
    let expected = pose.outward(DVec3::new(at.x, half.y, at.y));
    let beside = mover.center - expected;
    ride.beside = DVec2::new(beside.x, beside.z).length();
    ride.bits = mover
        .center
        .to_array()
        .iter()
        .fold(0, |bits, x| bits ^ x.to_bits().rotate_left(7));
    ride
}
