//! The outline of a patch: which vertices lie on which side, and which triangles join them to the
//! inner vertices.

use super::check::Patch;
use super::expected::{Expected, expected};
use dolomite_tessellation::{Domain, Levels, Mode, Tessellator};

/// A triangle by its coordinates (u and v; rule 8 asks for w), whatever their order.
pub type Corners = [u64; 3];

/// The items in order, to compare sets.
pub fn sorted<T: Ord>(mut items: Vec<T>) -> Vec<T> {
    items.sort_unstable();
    items
}

/// Which vertices of a patch lie on which side.
pub struct Outline {
    /// Levels and counts of the patch.
    pub expected: Expected,
    /// First vertex between the corners of each side, then the first inner vertex.
    pub starts: Vec<u32>,
}

impl Outline {
    /// `None` of a discarded patch and of one that has other counts than it should.
    pub fn of(tessellator: &Tessellator, levels: &Levels, patch: &Patch) -> Option<Self> {
        let expected = expected(tessellator, levels)?;
        let [vertices, primitives] = expected.counts();
        let indices = patch.1.triangles().as_flattened();
        if patch.0.len() != vertices as usize
            || patch.1.len() != primitives as usize
            || indices.iter().any(|index| *index >= vertices)
        {
            return None;
        }
        let mut starts = vec![expected.domain.outer_levels() as u32];
        for segments in expected.sides() {
            starts.push(starts[starts.len() - 1] + segments - 1);
        }
        Some(Self { expected, starts })
    }

    fn corners(&self) -> u32 {
        self.expected.domain.outer_levels() as u32
    }

    /// The vertices of a side, its corners first. It goes from corner `side` − 1 to corner `side`.
    pub fn side(&self, patch: &Patch, side: usize) -> Vec<[u32; 3]> {
        let corners = self.corners() as usize;
        let between = self.starts[side] as usize..self.starts[side + 1] as usize;
        let mut vertices = vec![patch.0[(side + corners - 1) % corners], patch.0[side]];
        vertices.extend_from_slice(&patch.0[between]);
        vertices
    }

    /// Whether a vertex lies off the outline.
    pub fn is_inner(&self, vertex: u32) -> bool {
        vertex >= self.starts[self.starts.len() - 1]
    }

    /// The sides that a vertex lies on, a bit each.
    pub fn sides_of(&self, vertex: u32) -> u32 {
        let corners = self.corners();
        if vertex < corners {
            return (1 << vertex) | (1 << ((vertex + 1) % corners));
        }
        let inner = self.starts.len() - 1;
        let side = (0..inner).find(|side| vertex < self.starts[side + 1]);
        side.map_or(0, |side| 1 << side)
    }

    /// Triangles without a vertex on the outline.
    pub fn interior(&self, patch: &Patch) -> Vec<Corners> {
        let triangles = patch.1.triangles().iter();
        let inner = triangles.filter(|t| t.iter().all(|vertex| self.is_inner(*vertex)));
        sorted(inner.map(|t| corners_of(patch, t)).collect())
    }

    /// Triangles between a side and the inner vertices next to it; `None` if a triangle joins two
    /// sides.
    pub fn strip(&self, patch: &Patch, side: usize, mode: Mode) -> Option<Vec<Corners>> {
        let mut strip = Vec::new();
        for triangle in patch.1.triangles() {
            let outer = triangle.iter().filter(|vertex| !self.is_inner(**vertex));
            let common = outer.map(|vertex| self.sides_of(*vertex));
            let Some(sides) = common.reduce(|a, b| a & b) else {
                continue;
            };
            let belongs = match sides.count_ones() {
                0 => return None,
                1 => sides == 1 << side,
                _ => sides & (1 << side) != 0 && self.runs_along(patch, triangle, side, mode),
            };
            if belongs {
                strip.push(corners_of(patch, triangle));
            }
        }
        Some(sorted(strip))
    }

    /// Of a triangle with one corner of the patch and two inner vertices: whether those run along
    /// `side`, not along the other side at that corner. Two inner vertices that coincide run along
    /// neither.
    fn runs_along(&self, patch: &Patch, triangle: &[u32; 3], side: usize, mode: Mode) -> bool {
        let domain = self.expected.domain;
        let Some(corner) = triangle.iter().find(|vertex| !self.is_inner(**vertex)) else {
            return false;
        };
        let inner: Vec<[u32; 3]> = triangle
            .iter()
            .filter(|vertex| self.is_inner(**vertex))
            .map(|vertex| patch.0[*vertex as usize])
            .collect();
        let [one, other] = inner[..] else {
            return false;
        };
        // The coordinate that is constant along a side.
        let apart = |side: usize| {
            let axis = if domain == Domain::Quads {
                side % 2
            } else {
                side
            };
            one[axis].abs_diff(other[axis])
        };
        let corner = *corner as usize;
        let sides = [corner, (corner + 1) % self.corners() as usize];
        let rest = sides[usize::from(sides[0] == side)];
        let rounding = match mode {
            Mode::Exact => 8,
            Mode::D3d => 8 << 8,
        };
        apart(rest) > rounding && apart(side) < apart(rest)
    }
}

fn corners_of(patch: &Patch, triangle: &[u32; 3]) -> Corners {
    let mut corners = triangle.map(|vertex| {
        let [u, v, _] = patch.0[vertex as usize];
        (u64::from(u) << 32) | u64::from(v)
    });
    corners.sort_unstable();
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_at_the_outline_is_in_one_strip() {
        for domain in [Domain::Triangles, Domain::Quads] {
            for (outer, inner) in [(1.0, 2.0), (1.0, 7.0), (4.0, 3.0), (9.0, 2.0), (5.0, 8.0)] {
                let levels = Levels {
                    outer: [outer, 1.0, 6.0, 2.0],
                    inner: [inner, 4.0],
                };
                let tessellator = Tessellator {
                    domain,
                    ..Default::default()
                };
                let patch = tessellator.tessellate_fixed(&levels);
                let outline = Outline::of(&tessellator, &levels, &patch).unwrap();
                let strips: usize = (0..domain.outer_levels())
                    .map(|side| outline.strip(&patch, side, Mode::Exact).unwrap().len())
                    .sum();
                let interior = outline.interior(&patch).len();
                assert_eq!(strips + interior, patch.1.len(), "{domain:?} {levels:?}");
            }
        }
    }
}
