//! Thousands of movers at once, on all cores: the same to the bit on any number of cores.

use bevy::math::{DVec3, Vec3};
use dolomite_collision::{
    Body, MoveOutcome, MoveSettings, Mover, TreeSettings, TriangleMesh, TriangleTree, World,
    advance_all,
};
use dolomite_testkit::metrics::Hash64;
use dolomite_testkit::random::Random;

/// How many there are.
pub const MOVERS: usize = 4096;

/// Steps that they take.
pub const STEPS: usize = 60;

/// Cells of a side of the ground, and their side, metres.
const CELLS: u32 = 80;
const CELL: f64 = 0.5;

/// Heights in no order, up to 0.4 m.
fn ground(random: &mut Random) -> Option<TriangleTree> {
    let side = CELLS + 1;
    let half = f64::from(CELLS) * CELL * 0.5;
    let at = |i: u32| (f64::from(i) * CELL - half) as f32;
    let vertices = (0..side * side)
        .map(|i| Vec3::new(at(i % side), (random.unit() * 0.4) as f32, at(i / side)))
        .collect();
    let triangles = (0..CELLS * CELLS).flat_map(|i| {
        let a = i / CELLS * side + i % CELLS;
        [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]]
    });
    let mesh = TriangleMesh::new(DVec3::ZERO, vertices, triangles.collect()).ok()?;
    Some(TriangleTree::new(mesh, TreeSettings::default()))
}

/// A hash of where all of them are in the end, and of what became of each; and how many stand.
pub fn hash(random: &mut Random) -> (u64, usize) {
    let Some(tree) = ground(random) else {
        return (0, 0);
    };
    let bodies = [Body::fixed(&tree)];
    let world = World::new(&bodies);
    let mut movers: Vec<Mover> = (0..MOVERS)
        .map(|_| {
            let (x, z) = (random.signed_unit() * 15.0, random.signed_unit() * 15.0);
            Mover::new(DVec3::new(x, 1.5, z), DVec3::new(0.3, 0.9, 0.3))
        })
        .collect();
    let wishes: Vec<DVec3> = (0..MOVERS)
        .map(|_| {
            let (x, z) = (random.signed_unit() * 0.06, random.signed_unit() * 0.06);
            DVec3::new(x, -0.05, z)
        })
        .collect();
    let mut outcomes = vec![MoveOutcome::default(); MOVERS];
    for _ in 0..STEPS {
        let settings = MoveSettings::default();
        advance_all(&world, &mut movers, &wishes, &settings, &mut outcomes);
    }
    let mut hash = Hash64::default();
    for (mover, outcome) in movers.iter().zip(&outcomes) {
        for x in mover.center.to_array() {
            hash.add(x.to_bits());
        }
        let said = u64::from(outcome.grounded) + 2 * u64::from(outcome.iterations);
        hash.add(said + 16 * u64::from(outcome.casts));
    }
    let standing = outcomes.iter().filter(|outcome| outcome.grounded).count();
    (hash.finish(), standing)
}
