//! What is drawn in place of the ground, and its height at any place.

use super::camera::View;
use bevy::math::{DVec2, DVec3};
use bevy::platform::collections::HashSet;

/// A surface of triangles over the ground plane, no two above the same place.
pub trait Drawn: Send + Sync {
    /// The triangle at a place of the ground plane, with the place's barycentric coordinates; `None`
    /// where nothing is drawn.
    fn triangle(&self, xz: DVec2) -> Option<([DVec3; 3], [f64; 3])>;

    /// Height of the drawn triangle at a place, metres.
    fn height(&self, xz: DVec2) -> Option<f64> {
        let ([a, b, c], [u, v, w]) = self.triangle(xz)?;
        Some(a.y * u + b.y * v + c.y * w)
    }

    /// How many vertices are used by triangles that may be seen.
    fn vertices(&self) -> u64;

    /// How many triangles may be seen.
    fn triangles(&self) -> u64;
}

/// Coordinates (u, v, w) of a place in a triangle of the ground plane; `None` if it has no area.
#[must_use]
pub fn barycentric([a, b, c]: [DVec2; 3], xz: DVec2) -> Option<[f64; 3]> {
    let area = (b - a).perp_dot(c - a);
    if area == 0.0 {
        return None;
    }
    let u = (b - xz).perp_dot(c - xz) / area;
    let v = (c - xz).perp_dot(a - xz) / area;
    Some([u, v, 1.0 - u - v])
}

/// How far outside of a triangle a place may lie and still belong to it, in barycentric coordinates:
/// some 10⁶ roundings, so that places on a common side are not lost between two triangles.
const OUTSIDE: f64 = 1e-9;
/// Children of a node of the locator, and triangles of its leaves.
const FAN: usize = 4;

/// Most triangles that a method keeps in memory. With its vertices, the locator and what the bisection
/// remembers, a triangle takes some 100 to 200 bytes.
pub const MOST_TRIANGLES: usize = 24_000_000;

/// Vertices and triangles, with a tree of boxes that finds the triangle at a place.
///
/// The tree is full and flat: triangles in the order of their centres along a Morton curve, four to a
/// box, four boxes to the next.
#[derive(Debug)]
pub struct GroundMesh {
    /// World metres.
    pub positions: Vec<DVec3>,
    /// Indices into `positions`. Those without area on the ground plane cover nothing and are left
    /// out when the mesh is made.
    pub triangles: Vec<[u32; 3]>,
    /// Boxes, leaves first, then level by level to the root.
    levels: Vec<Vec<(DVec2, DVec2)>>,
    seen: (u64, u64),
}

impl GroundMesh {
    /// A mesh; what `view` cannot see is drawn but not counted.
    ///
    /// # Panics
    /// If an index lies beyond the positions.
    #[must_use]
    pub fn new(positions: Vec<DVec3>, mut triangles: Vec<[u32; 3]>, view: &View) -> Self {
        let corners = |t: &[u32; 3]| t.map(|k| positions[k as usize]);
        triangles.retain(|t| {
            let [a, b, c] = corners(t).map(|p| DVec2::new(p.x, p.z));
            (b - a).perp_dot(c - a) != 0.0
        });
        let mut used = HashSet::new();
        let mut seen = 0;
        for triangle in &triangles {
            if view.may_see(&corners(triangle)) {
                seen += 1;
                used.extend(*triangle);
            }
        }
        let centre = |t: &[u32; 3]| {
            let [a, b, c] = corners(t);
            let sum = a + b + c;
            DVec2::new(sum.x, sum.z) / 3.0
        };
        let low = triangles
            .iter()
            .map(centre)
            .fold(DVec2::INFINITY, DVec2::min);
        let high = triangles
            .iter()
            .map(centre)
            .fold(DVec2::NEG_INFINITY, DVec2::max);
        let scale = DVec2::splat(f64::from(u32::MAX)) / (high - low).max(DVec2::splat(1e-9));
        triangles.sort_by_cached_key(|t| {
            let at = (centre(t) - low) * scale;
            spread(at.x as u32) | spread(at.y as u32) << 1
        });
        let mut levels = vec![Vec::new()];
        for group in triangles.chunks(FAN) {
            let points = group.iter().flat_map(corners);
            levels[0].push(hull(points.map(|p| DVec2::new(p.x, p.z)).map(|p| (p, p))));
        }
        while levels[levels.len() - 1].len() > 1 {
            let below = &levels[levels.len() - 1];
            let above = below.chunks(FAN).map(|c| hull(c.iter().copied()));
            levels.push(above.collect());
        }
        Self {
            seen: (used.len() as u64, seen),
            positions,
            triangles,
            levels,
        }
    }

    /// Calls `found` with every triangle that covers a place and its coordinates there, until that
    /// returns true.
    fn visit(&self, xz: DVec2, mut found: impl FnMut([DVec3; 3], [f64; 3]) -> bool) {
        let mut stack = vec![(self.levels.len() - 1, 0)];
        while let Some((level, index)) = stack.pop() {
            let Some(&(low, high)) = self.levels[level].get(index) else {
                continue;
            };
            // As far outside as a triangle may own.
            let margin = (high - low) * OUTSIDE;
            if !(xz.cmpge(low - margin).all() && xz.cmple(high + margin).all()) {
                continue;
            }
            if level > 0 {
                stack.extend((0..FAN).map(|k| (level - 1, index * FAN + k)));
                continue;
            }
            for triangle in self.triangles.iter().skip(index * FAN).take(FAN) {
                let corners = triangle.map(|k| self.positions[k as usize]);
                let flat = corners.map(|p| DVec2::new(p.x, p.z));
                if let Some(at) = barycentric(flat, xz)
                    && at.iter().all(|&c| c >= -OUTSIDE)
                    && found(corners, at)
                {
                    return;
                }
            }
        }
    }

    /// Height of every triangle that covers a place: one, or several on a common side, which agree
    /// unless there is a crack.
    #[must_use]
    pub fn heights(&self, xz: DVec2) -> Vec<f64> {
        let mut heights = Vec::new();
        self.visit(xz, |[a, b, c], [u, v, w]| {
            heights.push(a.y * u + b.y * v + c.y * w);
            false
        });
        heights
    }
}

impl Drawn for GroundMesh {
    fn triangle(&self, xz: DVec2) -> Option<([DVec3; 3], [f64; 3])> {
        let mut result = None;
        self.visit(xz, |corners, at| {
            result = Some((corners, at));
            true
        });
        result
    }

    fn vertices(&self) -> u64 {
        self.seen.0
    }

    fn triangles(&self) -> u64 {
        self.seen.1
    }
}

/// The smallest box about boxes.
fn hull(boxes: impl Iterator<Item = (DVec2, DVec2)>) -> (DVec2, DVec2) {
    boxes.fold(
        (DVec2::INFINITY, DVec2::NEG_INFINITY),
        |(low, high), (l, h)| (low.min(l), high.max(h)),
    )
}

/// The bits of a number, a zero before each (G. Morton 1966).
fn spread(bits: u32) -> u64 {
    let mut x = u64::from(bits);
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        x = (x | x << shift) & mask;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::camera::Camera;
    use bevy::math::UVec2;
    use dolomite_testkit::random::Random;

    /// Looks straight down on all of it.
    fn above(visible: f64) -> View {
        above_at(0.0, visible)
    }

    fn above_at(x: f64, visible: f64) -> View {
        Camera {
            eye: DVec3::new(x, 1e4, 0.0),
            yaw: 0.0,
            pitch: -90.0_f64.to_radians(),
            roll: 0.0,
            fov_y: 1.0,
            size: UVec2::splat(100),
            near: 0.1,
            orthographic: Some(visible),
        }
        .view()
    }

    /// A fan of triangles of very different sizes, heights x + 2z.
    fn fan() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let at = |x: f64, z: f64| DVec3::new(x, x + 2.0 * z, z);
        let mut positions = vec![at(0.0, 0.0)];
        let mut triangles = Vec::new();
        for k in 0..40_u32 {
            let reach = 0.01 * 1.3_f64.powi(k as i32);
            positions.push(at(reach, 0.0));
            positions.push(at(0.0, reach));
            if k == 0 {
                triangles.push([0, 1, 2]);
            } else {
                let [a, b, c, d] = [2 * k - 1, 2 * k, 2 * k + 1, 2 * k + 2];
                triangles.extend([[a, c, b], [b, c, d]]);
            }
        }
        (positions, triangles)
    }

    #[test]
    fn the_triangle_at_a_place_is_the_one_that_brute_force_finds() {
        let (positions, triangles) = fan();
        let mesh = GroundMesh::new(positions.clone(), triangles.clone(), &above(1e4));
        assert_eq!((mesh.vertices(), mesh.triangles()), (81, 79));
        let mut random = Random::new(1);
        let (mut inside, mut outside) = (0, 0);
        for _ in 0..5000 {
            let reach = 0.01 * 1.3_f64.powf(41.0 * random.unit());
            let xz = DVec2::new(random.signed_unit(), random.signed_unit()) * reach;
            let brute = triangles.iter().any(|t| {
                let flat = t
                    .map(|k| positions[k as usize])
                    .map(|p| DVec2::new(p.x, p.z));
                barycentric(flat, xz).unwrap().iter().all(|&c| c >= 0.0)
            });
            match mesh.height(xz) {
                Some(height) => {
                    inside += 1;
                    assert!(brute);
                    assert!((height - (xz.x + 2.0 * xz.y)).abs() < 1e-9 * reach.max(1.0));
                }
                None => {
                    outside += 1;
                    assert!(!brute, "{xz}");
                }
            }
        }
        assert!(inside > 500 && outside > 500, "{inside} {outside}");
    }

    #[test]
    fn only_what_may_be_seen_is_counted_and_a_crack_has_two_heights() {
        let (mut positions, triangles) = fan();
        // x from 40 m to 60 m; corners reach 40 m from number 32 of 40 on.
        let part = GroundMesh::new(positions.clone(), triangles.clone(), &above_at(50.0, 20.0));
        assert!((10..20).contains(&part.triangles()), "{}", part.triangles());
        assert!(
            part.height(DVec2::splat(50.0)).is_some(),
            "drawn all the same"
        );
        // Split a side on one of its two triangles, and lift the new vertex.
        let middle = (positions[77] + positions[78]) / 2.0;
        positions.push(middle + DVec3::Y);
        let mut cracked = triangles.clone();
        let at = cracked.iter().position(|t| *t == [77, 79, 78]).unwrap();
        cracked[at] = [77, 79, 81];
        cracked.push([81, 79, 78]);
        let xz = DVec2::new(middle.x, middle.z);
        let gap = |mesh: &GroundMesh| {
            let heights = mesh.heights(xz);
            assert!(heights.len() >= 2);
            heights
                .iter()
                .fold(0.0_f64, |gap, h| gap.max((h - heights[0]).abs()))
        };
        let whole = GroundMesh::new(positions.clone(), triangles, &above(1e4));
        assert!(gap(&whole) < 1e-9);
        assert!(gap(&GroundMesh::new(positions, cracked, &above(1e4))) > 0.99);
    }

    #[test]
    fn nothing_is_drawn_by_an_empty_mesh() {
        let mesh = GroundMesh::new(Vec::new(), Vec::new(), &above(1.0));
        assert_eq!(mesh.height(DVec2::ZERO), None);
        let flat = vec![DVec3::ZERO, DVec3::Y, DVec3::X];
        let mesh = GroundMesh::new(flat, vec![[0, 1, 2]], &above(1.0));
        assert_eq!(mesh.triangles(), 0, "a wall has no area on the ground");
    }
}
