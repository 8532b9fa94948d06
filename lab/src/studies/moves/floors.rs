//! A flat floor of many triangles and many tiles, which must be as one plane.

use bevy::math::{DVec2, DVec3, Vec3};
use dolomite_collision::{
    Body, MoveOutcome, MoveSettings, Mover, Pose, Scratch, TreeSettings, TriangleMesh,
    TriangleTree, World, advance,
};
use dolomite_testkit::random::Random;

/// Cells of a tile, and their side, metres, which is no binary fraction.
const CELLS: u32 = 12;
const CELL: f32 = 0.37;

/// Tiles of a side of the floor.
const TILES: i32 = 4;

/// What happened on it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Floor {
    /// Steps that were made.
    pub steps: u64,
    /// The farthest of the foot from where it stood first, metres.
    pub height: f64,
    /// Steps after which it did not stand.
    pub flips: u64,
    /// The farthest of a step from its wish, metres.
    pub sideways: f64,
}

fn tile() -> TriangleTree {
    let side = CELLS + 1;
    let vertices = (0..side * side).map(|i| {
        let (x, z) = ((i % side) as f32 * CELL, (i / side) as f32 * CELL);
        Vec3::new(x, 0.0, z)
    });
    let triangles = (0..CELLS * CELLS).flat_map(|i| {
        let a = i / CELLS * side + i % CELLS;
        [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]]
    });
    let mesh = TriangleMesh::new(DVec3::ZERO, vertices.collect(), triangles.collect())
        .expect("a floor is finite");
    TriangleTree::new(mesh, TreeSettings::default())
}

/// Steps of up to 0.1 m in all directions around `origin`, over seams of triangles and of tiles.
pub fn walk(random: &mut Random, origin: DVec3, steps: u64) -> Floor {
    let tree = tile();
    let side = f64::from(CELLS as f32 * CELL);
    let tiles = (0..TILES).flat_map(|x| (0..TILES).map(move |z| [x, z]));
    let bodies: Vec<Body> = tiles
        .map(|tile| {
            let [x, z] = tile.map(|i| f64::from(i - TILES / 2) * side);
            Body::standing(&tree, Pose::at(origin + DVec3::new(x, 0.0, z)))
        })
        .collect();
    let world = World::new(&bodies);
    let settings = MoveSettings::default();
    let (mut scratch, mut outcome) = (Scratch::default(), MoveOutcome::default());
    let mut mover = Mover::new(origin + DVec3::Y * 0.95, DVec3::new(0.3, 0.9, 0.3));
    let mut step = |mover: &mut Mover, wish: DVec3| {
        advance(&world, mover, wish, &settings, &mut scratch, &mut outcome);
        outcome.grounded
    };
    step(&mut mover, DVec3::Y * -0.2);
    let height = mover.center.y;
    let mut floor = Floor::default();
    let mut wish = DVec3::ZERO;
    let border = side * f64::from(TILES / 2) - 1.0;
    for number in 0..steps {
        let at = DVec2::new(mover.center.x - origin.x, mover.center.z - origin.z);
        if number % 50 == 0 || at.abs().max_element() > border {
            let (x, z) = (random.signed_unit() * 0.1, random.signed_unit() * 0.1);
            wish = DVec3::new(x, 0.0, z);
            if at.x * x + at.y * z > 0.0 {
                wish = -wish;
            }
        }
        let before = mover.center;
        let stands = step(&mut mover, wish - DVec3::Y * 0.01);
        floor.steps += 1;
        floor.flips += u64::from(!stands);
        floor.height = floor.height.max((mover.center.y - height).abs());
        let off = mover.center - before - wish;
        floor.sideways = floor.sideways.max(DVec2::new(off.x, off.z).length());
    }
    floor
}
