//! The triangles of one quad patch, from the levels of its edges: the twin of
//! `shaders/src/tessellation/pattern.wgsl`, integer for integer.
//!
//! A patch has an inner grid of `a` × `b` segments, of which only the part off the outline is
//! made: (a − 1)(b − 1) inner vertices. Four strips join it to the four sides, whose vertices
//! belong to the edges. A strip walks both of its polylines in the order of their segments'
//! midpoints (the merge path of Green, McColl and Bader, "GPU merge path", 2012), so that any
//! triangle of it can be found on its own, in O(log n).

use crate::layout::MAX_LEVEL;

/// Segments of one side: of its only edge, or of its two edges (halves of the side).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// Segments of the first edge, at least 1.
    pub first: u32,
    /// Segments of the second edge; 0 where the side has one edge only.
    pub second: u32,
}

impl Side {
    /// Segments of the whole side.
    pub const fn level(self) -> u32 {
        self.first + self.second
    }

    /// Midpoint of segment `i` along the side, as a fraction (numerator, denominator).
    fn midpoint(self, i: u32) -> (u32, u32) {
        if self.second == 0 {
            (2 * i + 1, 2 * self.first)
        } else if i < self.first {
            (2 * i + 1, 4 * self.first)
        } else {
            (2 * self.second + 2 * (i - self.first) + 1, 4 * self.second)
        }
    }
}

/// Inner segments along x and z for the levels of the sides (0 and 1 along x, 2 and 3 along z).
///
/// (1, 1) only where every side has one segment: then the patch is two triangles.
pub fn inner_levels(sides: [Side; 4]) -> [u32; 2] {
    let levels = sides.map(Side::level);
    if levels == [1; 4] {
        return [1, 1];
    }
    [
        levels[0].max(levels[1]).clamp(2, MAX_LEVEL),
        levels[2].max(levels[3]).clamp(2, MAX_LEVEL),
    ]
}

/// Number of inner vertices of a patch.
pub const fn inner_vertices([a, b]: [u32; 2]) -> u32 {
    (a - 1) * (b - 1)
}

/// Number of triangles of a patch; as OpenGL's count for the same levels.
pub fn triangle_count(sides: [Side; 4], [a, b]: [u32; 2]) -> u32 {
    if a == 1 {
        return 2;
    }
    let outer: u32 = sides.iter().map(|side| side.level()).sum();
    2 * (a - 2) * (b - 2) + 2 * (a - 2) + 2 * (b - 2) + outer
}

/// A vertex of a patch, by who owns it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatchVertex {
    /// Inner grid vertex (i, j), 1 ≤ i < a, 1 ≤ j < b.
    Inner(u32, u32),
    /// Vertex `1` of side `0`, from 0 to the side's level inclusive.
    Outer(u32, u32),
}

/// Whether midpoint `i` of the side comes before midpoint `j` of the inner polyline, whose inner
/// vertices k = 0.. stand at (1 + k) / a.
fn outer_first(side: Side, i: u32, j: u32, a: u32) -> bool {
    let (n, d) = side.midpoint(i);
    n * (2 * a) <= (2 * j + 3) * d
}

/// Triangle `t` of the strip along side `s`: counter-clockwise seen from +Y.
pub fn strip_triangle(s: u32, side: Side, [a, b]: [u32; 2], t: u32) -> [PatchVertex; 3] {
    let along = if s < 2 { a } else { b };
    let outer_count = side.level();
    let inner_count = along - 2;
    let (mut low, mut high) = (t.saturating_sub(inner_count), t.min(outer_count));
    while low < high {
        let middle = (low + high) / 2;
        if outer_first(side, middle, t - 1 - middle, along) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    let (i, j) = (low, t - low);
    let inner = |k: u32| match s {
        0 => PatchVertex::Inner(1 + k, 1),
        1 => PatchVertex::Inner(1 + k, b - 1),
        2 => PatchVertex::Inner(1, 1 + k),
        _ => PatchVertex::Inner(a - 1, 1 + k),
    };
    let take_outer = j >= inner_count || (i < outer_count && outer_first(side, i, j, along));
    let [p, q, r] = if take_outer {
        [
            PatchVertex::Outer(s, i),
            inner(j),
            PatchVertex::Outer(s, i + 1),
        ]
    } else {
        [PatchVertex::Outer(s, i), inner(j), inner(j + 1)]
    };
    // Sides 1 and 2 are mirror images of sides 0 and 3.
    if s == 1 || s == 2 {
        [p, r, q]
    } else {
        [p, q, r]
    }
}

/// Triangle `t` of a patch, counter-clockwise seen from +Y: the inner grid first, then the strips
/// of sides 0 to 3.
pub fn triangle(sides: [Side; 4], inner: [u32; 2], t: u32) -> [PatchVertex; 3] {
    use PatchVertex::{Inner, Outer};
    let [a, b] = inner;
    if a == 1 {
        // Corners (0,0), (1,0), (0,1), (1,1) as ends of the sides along x.
        return if t == 0 {
            [Outer(0, 0), Outer(1, 0), Outer(0, 1)]
        } else {
            [Outer(0, 1), Outer(1, 0), Outer(1, 1)]
        };
    }
    let grid = 2 * (a - 2) * (b - 2);
    if t < grid {
        let cell = t / 2;
        let (i, j) = (1 + cell % (a - 2), 1 + cell / (a - 2));
        return if t.is_multiple_of(2) {
            [Inner(i, j), Inner(i, j + 1), Inner(i + 1, j)]
        } else {
            [Inner(i + 1, j), Inner(i, j + 1), Inner(i + 1, j + 1)]
        };
    }
    let mut rest = t - grid;
    for (s, side) in (0_u32..).zip(sides) {
        let along = if s < 2 { a } else { b };
        let count = side.level() + along - 2;
        if rest < count || s == 3 {
            return strip_triangle(s, side, inner, rest);
        }
        rest -= count;
    }
    unreachable!("the loop returns at side 3")
}
