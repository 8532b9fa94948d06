//! Where the vertices of an edge lie. The CPU reference of `shaders/src/stage/place.wgsl`.
//!
//! A fractional level f with n segments (n − 2 < f ≤ n) blends the edge of n − 2 equal segments with
//! that of n: vertex p of n lies at (1 − g) i / (n − 2) + g p / n with g = (f − (n − 2)) / 2, where i
//! is its place among the n − 2. In each half one vertex is new; it grows out of its neighbour. Which
//! one follows the ruler function (as in the Direct3D 11 functional specification, "Fractional
//! Partitioning"), so that growing levels split the segments in a fixed order.

use super::level::Level;
use super::{Mode, Spacing};

/// 1.0 in the units of places and coordinates, 2⁻²⁴.
pub const UNIT: u32 = 1 << 24;

/// An edge that is ready to place its vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Number of segments.
    pub segments: u32,
    /// Weight g of the n segments against n − 2, in units of 2⁻²⁴; [`UNIT`] at a whole level.
    pub weight: u32,
}

impl Edge {
    /// The edge of a level.
    #[must_use]
    pub const fn new(level: Level, spacing: Spacing) -> Self {
        let segments = level.segments(spacing);
        let weight = match spacing {
            Spacing::Equal => UNIT,
            // In units of 2^-23 the difference f - (n - 2), halved into units of 2^-24: no shift.
            // f = n = 1 gives 2 units of one: the weight of a whole level.
            _ => (level.0 + 2 * super::level::ONE) - segments * super::level::ONE,
        };
        Self { segments, weight }
    }

    /// Where vertex `p` of 0 to n lies, in units of 2⁻²⁴: `place(n − p) == UNIT − place(p)`.
    #[must_use]
    pub fn place(self, p: u32, mode: Mode) -> u32 {
        let mirrored = self.segments - p;
        if p == mirrored {
            return UNIT / 2;
        }
        let j = p.min(mirrored);
        let place = match mode {
            Mode::Exact => self.scaled(j, 1, 1),
            Mode::D3d => self.reference(j) << 8,
        };
        if p < mirrored { place } else { UNIT - place }
    }

    /// `times` / `parts` of the place of vertex `j` ≤ n / 2, rounded to nearest in units of 2⁻²⁴;
    /// `times` and `parts` up to 2 and 3.
    ///
    /// With both terms over one denominator the place is (2²⁴ i n − b) / (n (n − 2)), where
    /// b = 2 j w if the vertex keeps its place i = j and −(n − 2 j) w if it moves up to i = j − 1.
    /// Long division by n − 2 and then by n keeps every number below 2³².
    pub(super) fn scaled(self, j: u32, times: u32, parts: u32) -> u32 {
        let n = self.segments;
        if n <= 2 || self.weight == UNIT {
            return rounded(times * j * UNIT, parts * n);
        }
        let moved = j > self.split();
        let i = j - u32::from(moved);
        let whole = times * i * UNIT;
        let divisor = parts * (n - 2);
        let (quotient, rest) = (whole / divisor, (whole % divisor) * n);
        let shift = times * self.weight;
        if moved {
            quotient + rounded(rest + (n - 2 * j) * shift, divisor * n)
        } else {
            // Rounded like the sum above: to nearest, halves up; rest and less % divisor are both
            // smaller than the divisor.
            let less = 2 * j * shift;
            let divisor = divisor * n;
            let twice = 2 * (rest as i32 - (less % divisor) as i32) + divisor as i32;
            let step = (twice >= 2 * divisor as i32) as u32;
            quotient - less / divisor + step - (twice < 0) as u32
        }
    }

    /// As the 16.16 fixed-point reference places vertex `j` < n / 2, in units of 2⁻¹⁶.
    fn reference(self, j: u32) -> u32 {
        if self.weight == UNIT {
            return j * reciprocal(self.segments);
        }
        let i = j - u32::from(j > self.split());
        let weight = self.weight >> 8;
        let fewer = i * reciprocal(self.segments - 2) * ((1 << 16) - weight);
        (fewer + j * reciprocal(self.segments) * weight + (1 << 15)) >> 16
    }

    /// Last vertex of the half that keeps its number when the edge grows from n − 2 to n segments.
    const fn split(self) -> u32 {
        let half = self.segments / 2 - 1;
        if half == 0 {
            return 0;
        }
        2 * (half - (1 << half.ilog2())) + 1
    }
}

/// 65536 / n, rounded to nearest.
const fn reciprocal(n: u32) -> u32 {
    (65_536 + n / 2) / n
}

/// a / b rounded to nearest, halves up.
const fn rounded(a: u32, b: u32) -> u32 {
    (a / b) + (2 * (a % b) >= b) as u32
}
