//! Rooms that are closed and full of what is hard to move among.

use bevy::math::{DQuat, DVec3, Vec3};
use dolomite_collision::geometry::nearest_on_triangle;
use dolomite_collision::motion::{GAP, ITERATIONS, allowed};
use dolomite_collision::{
    Body, Ellipsoid, MoveOutcome, MoveSettings, Mover, Scratch, TreeSettings, TriangleMesh,
    TriangleTree, World,
};
use dolomite_testkit::metrics::Hash64;
use dolomite_testkit::places::{direction, place, size};
use dolomite_testkit::random::Random;

/// Half of the size of a room, metres.
const HALF: f64 = 4.0;

/// Moves in a room.
pub const MOVES: usize = 1500;

/// Of so many moves one may say that it is crushed: triangles that stand in no order leave gaps that are too narrow.
pub const CRUSHED_OF: u64 = 1000;

/// What rooms are full of.
pub const KINDS: [&str; 6] = [
    "large triangles",
    "small triangles",
    "creases of 1 to 179 degrees",
    "terrain with T-junctions",
    "needles",
    "1e5 m away, large triangles",
];

/// What happened in rooms.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Moves made.
    pub moves: u64,
    /// Moves that ended outside.
    pub tunnels: u64,
    /// The deepest that a mover was in a triangle at the end of a move, but of those that say that they are crushed.
    pub depth: f64,
    /// Moves that said so.
    pub crushed: u64,
    /// Moves that went nowhere although what they touched allows a way.
    pub stuck: u64,
    /// Moves that are not finite.
    pub wrong: u64,
    /// Most advances of a slide.
    pub iterations: u32,
    /// Sweeps and queries.
    pub casts: u64,
    /// Of all ends.
    pub hash: Hash64,
}

impl Tally {
    /// Of both.
    pub fn join(&mut self, other: &Self) {
        self.moves += other.moves;
        self.tunnels += other.tunnels;
        self.depth = self.depth.max(other.depth);
        self.crushed += other.crushed;
        self.stuck += other.stuck;
        self.wrong += other.wrong;
        self.iterations = self.iterations.max(other.iterations);
        self.casts += other.casts;
        self.hash.add(other.hash.finish());
    }

    /// Whether what is asked for is held.
    pub fn holds(&self) -> bool {
        self.tunnels == 0
            && self.stuck == 0
            && self.wrong == 0
            && self.depth <= 1e-4
            && self.crushed * CRUSHED_OF <= self.moves
            && self.iterations <= ITERATIONS
    }
}

fn soup(random: &mut Random, count: usize, size: f64) -> Vec<[DVec3; 3]> {
    (0..count)
        .map(|_| {
            let center = place(random, HALF - 0.5);
            [(); 3].map(|()| center + place(random, size))
        })
        .collect()
}

/// Wedges that are open upwards or to a side, by any angle.
fn creases(random: &mut Random) -> Vec<[DVec3; 3]> {
    let wedges = (0..8).map(|_| {
        let along = direction(random) * 2.0;
        let out = direction(random).reject_from(along).normalize_or(DVec3::Y);
        let angle = (1.0 + 178.0 * random.unit()).to_radians();
        let turned = |angle: f64| DQuat::from_axis_angle(along.normalize(), angle) * out * 2.0;
        let middle = place(random, HALF - 1.0);
        let (a, b) = (middle - along, middle + along);
        let wall = |way: DVec3| [[a, b, b + way], [a, b + way, a + way]];
        [wall(turned(angle * 0.5)), wall(turned(-angle * 0.5))]
    });
    wedges.flatten().flatten().collect()
}

/// Ground with steps, of which one half has twice as many triangles as the other, without sharing their corners.
fn terrain(random: &mut Random) -> Vec<[DVec3; 3]> {
    let heights: Vec<f64> = (0..17 * 17)
        .map(|_| random.signed_unit() * 0.5 - 3.0)
        .collect();
    let at = |x: usize, z: usize| {
        let half = |i: usize| i as f64 * 0.5 - HALF;
        DVec3::new(half(x), heights[x * 17 + z], half(z))
    };
    let mut triangles = Vec::new();
    for x in 0..16 {
        let step = if x < 8 { 2 } else { 1 };
        for z in (0..16).step_by(step).filter(|_| x % step == 0) {
            let (nw, ne) = (at(x, z), at(x + step, z));
            let (sw, se) = (at(x, z + step), at(x + step, z + step));
            triangles.extend([[nw, sw, ne], [sw, se, ne]]);
        }
    }
    triangles
}

fn needles(random: &mut Random) -> Vec<[DVec3; 3]> {
    (0..60)
        .map(|_| {
            let a = place(random, HALF - 1.0);
            let along = direction(random) * size(random, 0.5, 4.0);
            [
                a,
                a + along,
                a + along * random.unit() + place(random, 1e-5),
            ]
        })
        .collect()
}

/// Depth in a body, metres: by distances of f64 where the mover is a unit sphere, times the largest radius.
fn depth(mover: &Mover, tree: &TriangleTree) -> f64 {
    let ellipsoid = Ellipsoid::upright(mover.center, mover.radii);
    let to_unit = ellipsoid.to_unit();
    let mut deepest = 0.0_f64;
    for triangle in tree.overlapping(&ellipsoid.into()) {
        let corners = tree
            .mesh()
            .corners(triangle)
            .map(|c| to_unit * (c - mover.center));
        let (point, _) = nearest_on_triangle(DVec3::ZERO, corners);
        deepest = deepest.max((1.0 - point.length()) * mover.radii.max_element());
    }
    deepest
}

/// Who makes one step of a mover: [`dolomite_collision::advance`], and in a test who does it wrongly.
pub type Advance = fn(&World, &mut Mover, DVec3, &MoveSettings, &mut Scratch, &mut MoveOutcome);

/// [`MOVES`] wishes of any length to 10 m in a room of a kind.
pub fn room(random: &mut Random, kind: usize, advance: Advance) -> Tally {
    let triangles = match kind {
        0 | 5 => soup(random, 40, 1.5),
        1 => soup(random, 60, 0.2),
        2 => creases(random),
        3 => terrain(random),
        _ => needles(random),
    };
    let shift = match kind {
        5 => DVec3::new(1e5, 1e5, -1e5),
        _ => DVec3::ZERO,
    };
    let tree = |mesh| TriangleTree::new(mesh, TreeSettings::default());
    let moved: Vec<_> = triangles.iter().map(|t| t.map(|c| c + shift)).collect();
    let walls = TriangleMesh::cuboid(shift, Vec3::splat(HALF as f32)).map(tree);
    let clutter = TriangleMesh::from_triangles(&moved).map(tree);
    let (Ok(walls), Ok(clutter)) = (walls, clutter) else {
        return Tally {
            wrong: 1,
            ..Tally::default()
        };
    };
    let bodies = [Body::fixed(&walls), Body::fixed(&clutter)];
    let world = World::new(&bodies);
    let settings = MoveSettings {
        step_height: [0.0, 0.35][random.below(2)],
        ..MoveSettings::default()
    };
    let radii = DVec3::new(
        size(random, 0.1, 0.5),
        size(random, 0.1, 0.9),
        size(random, 0.1, 0.5),
    );
    let mut mover = Mover::new(shift + place(random, 3.0), radii);
    let (mut scratch, mut outcome) = (Scratch::default(), MoveOutcome::default());
    // Out of what it was put into.
    advance(
        &world,
        &mut mover,
        DVec3::ZERO,
        &settings,
        &mut scratch,
        &mut outcome,
    );
    let mut tally = Tally::default();
    for _ in 0..MOVES {
        let wish = direction(random) * size(random, 1e-4, 10.0);
        let from = mover.center;
        advance(
            &world,
            &mut mover,
            wish,
            &settings,
            &mut scratch,
            &mut outcome,
        );
        let end = mover.center;
        tally.moves += 1;
        tally.casts += u64::from(outcome.casts);
        tally.iterations = tally.iterations.max(outcome.iterations);
        tally.wrong += u64::from(!end.is_finite() || outcome.error.is_some());
        tally.tunnels += u64::from((end - shift).abs().max_element() >= HALF);
        tally.crushed += u64::from(outcome.crushed);
        if !outcome.crushed {
            tally.depth = tally
                .depth
                .max(depth(&mover, &walls))
                .max(depth(&mover, &clutter));
        }
        let went = end.distance(from);
        if went < 1e-6 * wish.length() {
            let normals: Vec<DVec3> = outcome.contacts.iter().map(|touch| touch.normal).collect();
            // Who stands is not pulled down, and slopes that are too steep are walls: only ways without up count.
            let free = allowed(wish, &normals);
            let climbs = outcome.contacts.iter().any(|touch| {
                let level = touch.normal.y;
                level > 0.0 && level < settings.walkable
            });
            let stands = outcome.grounded && wish.y <= 0.0;
            // What is left of a wish that is shorter than the gap may lead no farther than into the gap, which is kept.
            let least = (1e-3 * wish.length()).max(2.0 * GAP * radii.max_element());
            tally.stuck += u64::from(free.length() > least && !climbs && !stands);
        }
        for x in end.to_array() {
            tally.hash.add(x.to_bits());
        }
    }
    tally
}

#[cfg(test)]
mod tests {
    use super::*;
    use dolomite_collision::advance;

    fn tally(kind: usize, go: Advance) -> Tally {
        room(&mut Random::new(3), kind, go)
    }

    /// Each count sees what it is there for.
    #[test]
    fn wrong_movers_are_seen() {
        for kind in [0, 5] {
            assert!(tally(kind, advance).holds());
            let through: Advance = |_, mover, wish, _, _, outcome| {
                *outcome = MoveOutcome::default();
                mover.center += wish;
            };
            assert!(tally(kind, through).tunnels > 1000);
            let still: Advance = |_, _, _, _, _, outcome| *outcome = MoveOutcome::default();
            assert!(tally(kind, still).stuck > 1000);
            // Down onto what it stands on, and a fifth of a millimetre into it.
            let deep: Advance = |world, mover, wish, settings, scratch, outcome| {
                advance(world, mover, wish, settings, scratch, outcome);
                if outcome.grounded {
                    mover.center.y -= 2e-4;
                }
            };
            let deep = tally(kind, deep);
            assert!(deep.depth > 1e-4 && !deep.holds(), "{deep:?}");
            let nowhere: Advance = |_, mover, _, _, _, _| mover.center = DVec3::NAN;
            assert!(tally(kind, nowhere).wrong > 1000);
            let often: Advance = |_, _, _, _, _, outcome| outcome.iterations = 4;
            assert!(!tally(kind, often).holds());
            // Who calls everybody crushed excuses any depth.
            let crushed: Advance = |world, mover, wish, settings, scratch, outcome| {
                advance(world, mover, wish, settings, scratch, outcome);
                outcome.crushed = true;
            };
            assert!(!tally(kind, crushed).holds());
        }
    }
}
