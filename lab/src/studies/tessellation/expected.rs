//! Levels and counts that a patch has to have, written anew from OpenGL 4.6 core, 11.2.2, and
//! Vulkan 1.3, "Tessellation", in f64 and with the sums over rings that conformance tests use:
//! nothing here is shared with the stage.

use dolomite_tessellation::{Domain, Levels, Mode, Spacing, Tessellator};

/// A level after clamping and rounding, and its number of segments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clamped {
    /// Exact: every f32 is an f64.
    pub level: f64,
    /// The level rounded up to what the spacing allows.
    pub segments: u32,
}

/// What a patch comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Parameter space.
    pub domain: Domain,
    /// Of the sides; those that the domain does not have are 1.
    pub outer: [Clamped; 4],
    /// Along u and v; of triangles, twice the same; of isolines, 1.
    pub inner: [Clamped; 2],
}

const NONE: Clamped = Clamped {
    level: 1.0,
    segments: 1,
};

/// As the reference tessellator of Direct3D 11 reads a fractional level: to nearest, halves to even,
/// in steps of 2⁻¹⁶, and of those it takes half, rounded up.
fn quantized(level: f64) -> f64 {
    let steps = (level * 65_536.0).round_ties_even();
    (steps / 2.0).ceil() / 32_768.0
}

fn clamped(level: f32, spacing: Spacing, mode: Mode) -> Clamped {
    let (least, most) = match spacing {
        Spacing::Equal => (1.0, 64.0),
        Spacing::FractionalEven => (2.0, 64.0),
        Spacing::FractionalOdd => (1.0, 63.0),
    };
    let level = f64::from(level);
    // NaN is not above the least.
    let level = if level > least {
        level.min(most)
    } else {
        least
    };
    rounded(level, spacing, mode)
}

fn rounded(level: f64, spacing: Spacing, mode: Mode) -> Clamped {
    let level = match (spacing, mode) {
        (Spacing::Equal, _) => level.ceil(),
        (_, Mode::Exact) => level,
        (_, Mode::D3d) => quantized(level),
    };
    let segments = match spacing {
        Spacing::Equal => level,
        Spacing::FractionalEven => 2.0 * (level / 2.0).ceil(),
        Spacing::FractionalOdd => 2.0 * ((level - 1.0) / 2.0).ceil() + 1.0,
    };
    Clamped {
        level,
        segments: segments as u32,
    }
}

/// An inner level of 1 beside a greater one: "as though it were originally specified as 1 + ε", ε the
/// least step of the mode.
fn lifted(spacing: Spacing, mode: Mode) -> Clamped {
    let step = match mode {
        Mode::Exact => 1.0 + f64::from(f32::EPSILON),
        Mode::D3d => 1.0 + 1.0 / 65_536.0,
    };
    let least = if spacing == Spacing::FractionalEven {
        2.0
    } else {
        step
    };
    rounded(least, spacing, mode)
}

/// What a patch has to come to; `None` where one of its outer levels discards it.
#[must_use]
pub fn expected(tessellator: &Tessellator, levels: &Levels) -> Option<Expected> {
    let Tessellator {
        domain,
        spacing,
        mode,
        ..
    } = *tessellator;
    let sides = domain.outer_levels();
    if !levels.outer[..sides].iter().all(|level| *level > 0.0) {
        return None;
    }
    let mut outer = [NONE; 4];
    for (side, clamped_level) in outer.iter_mut().enumerate().take(sides) {
        let lines = domain == Domain::Isolines && side == 0;
        let spacing = if lines { Spacing::Equal } else { spacing };
        *clamped_level = clamped(levels.outer[side], spacing, mode);
    }
    let mut inner = match domain {
        Domain::Triangles => [clamped(levels.inner[0], spacing, mode); 2],
        Domain::Quads => levels.inner.map(|level| clamped(level, spacing, mode)),
        Domain::Isolines => [NONE; 2],
    };
    let ones = outer.iter().chain(&inner).all(|level| level.segments == 1);
    if !ones && domain != Domain::Isolines {
        for level in &mut inner {
            if level.segments == 1 {
                *level = lifted(spacing, mode);
            }
        }
    }
    Some(Expected {
        domain,
        outer,
        inner,
    })
}

impl Expected {
    /// Segments of the sides that the domain has.
    pub fn sides(&self) -> impl Iterator<Item = u32> + '_ {
        self.outer[..self.domain.outer_levels()]
            .iter()
            .map(|level| level.segments)
    }

    /// Whether every level is 1.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.domain != Domain::Isolines && self.inner.iter().all(|level| level.segments == 1)
    }

    /// Whether one of the edges folds back at its middle, as the 16.16 fixed point of mode `D3d` has
    /// it: an even level hardly above 6 or 30. The vertex that leaves the middle of n − 2 segments
    /// starts out at (n / 2 − 1) · ⌊65536 / (n − 2) + ½⌋, which is 32769 and 32775 there, while the
    /// new middle is at 32768.
    #[must_use]
    pub fn folds(&self, tessellator: &Tessellator) -> bool {
        let folds = |Clamped { level, segments }: &Clamped| {
            let [fewer, more] =
                [segments - 2, *segments].map(|n| (65_536.0 / f64::from(n)).round());
            let half = f64::from(segments / 2 - 1);
            let weight = (level - f64::from(segments - 2)) / 2.0;
            // Elsewhere the vertex that leaves its place is not the one next to the middle.
            matches!(segments, 8 | 32)
                && weight < 1.0
                && (half * (fewer * (1.0 - weight) + more * weight)).round() > 32_768.0
        };
        tessellator.mode == Mode::D3d
            && tessellator.spacing == Spacing::FractionalEven
            && match self.domain {
                Domain::Isolines => folds(&self.outer[1]),
                _ => {
                    let sides = self.domain.outer_levels();
                    self.outer[..sides].iter().chain(&self.inner).any(folds)
                }
            }
    }

    /// Vertices and primitives.
    #[must_use]
    pub fn counts(&self) -> [u32; 2] {
        let around: u32 = self.sides().sum();
        let [a, b] = self.inner.map(|level| level.segments);
        match self.domain {
            Domain::Isolines => {
                let [lines, detail] = [0, 1].map(|side| self.outer[side].segments);
                [lines * (detail + 1), lines * detail]
            }
            Domain::Triangles if self.is_plain() => [3, 1],
            Domain::Quads if self.is_plain() => [4, 2],
            Domain::Triangles => {
                let rings = (1..=a / 2).map(|k| a - 2 * k);
                let vertices: u32 = rings.clone().map(|m| if m == 0 { 1 } else { 3 * m }).sum();
                let triangles: u32 = rings.map(|m| if m == 1 { 4 } else { 6 * m }).sum();
                [around + vertices, around + triangles]
            }
            Domain::Quads => [
                around + (a - 1) * (b - 1),
                around + 2 * (a - 2) * (b - 2) + 2 * (a - 2) + 2 * (b - 2),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(domain: Domain, spacing: Spacing, levels: Levels) -> Option<[u32; 2]> {
        let tessellator = Tessellator {
            domain,
            spacing,
            ..Default::default()
        };
        expected(&tessellator, &levels).map(|expected| expected.counts())
    }

    #[test]
    fn known_counts() {
        let uniform = |domain, level| counts(domain, Spacing::Equal, Levels::uniform(level));
        assert_eq!(uniform(Domain::Triangles, 1.0), Some([3, 1]));
        assert_eq!(uniform(Domain::Triangles, 4.0), Some([19, 24]));
        assert_eq!(uniform(Domain::Triangles, 5.0), Some([27, 37]));
        assert_eq!(uniform(Domain::Quads, 1.0), Some([4, 2]));
        assert_eq!(uniform(Domain::Quads, 3.0), Some([16, 18]));
        assert_eq!(uniform(Domain::Isolines, 3.0), Some([12, 9]));
        assert_eq!(uniform(Domain::Quads, f32::NAN), None);
        assert_eq!(uniform(Domain::Isolines, -1.0), None);
    }

    #[test]
    fn a_level_that_does_not_count_discards_nothing() {
        let levels = Levels {
            outer: [2.0, 2.0, 2.0, f32::NAN],
            inner: [f32::NAN, -1.0],
        };
        assert_eq!(
            counts(Domain::Triangles, Spacing::Equal, levels),
            Some([7, 6])
        );
        assert_eq!(counts(Domain::Quads, Spacing::Equal, levels), None);
    }

    #[test]
    fn fixed_point_folds_hardly_above_6_and_30() {
        for (level, expected) in [
            (6.0, false),
            (6.000_05, true),
            (6.01, false),
            (14.000_1, false),
            (22.000_1, false),
            (30.0, false),
            (30.000_1, true),
            (30.006, true),
            (30.007, false),
            (62.000_1, false),
        ] {
            let tessellator = Tessellator {
                domain: Domain::Quads,
                spacing: Spacing::FractionalEven,
                mode: Mode::D3d,
                ..Default::default()
            };
            let levels = Levels::uniform(level);
            let found = super::expected(&tessellator, &levels).expect("positive");
            assert_eq!(found.folds(&tessellator), expected, "{level}");
            // The last row of inner vertices comes last.
            let (vertices, _) = tessellator.tessellate_fixed(&levels);
            let row = vertices.iter().rev().map(|vertex| vertex[0]);
            let row: Vec<u32> = row.take(found.inner[0].segments as usize - 1).collect();
            assert_eq!(row.is_sorted_by(|a, b| a >= b), !expected, "{level}");
        }
    }

    #[test]
    fn the_modes_part_where_a_level_is_hardly_above_an_integer() {
        let of = |mode| {
            let tessellator = Tessellator {
                spacing: Spacing::FractionalOdd,
                mode,
                ..Default::default()
            };
            expected(&tessellator, &Levels::uniform(1.0 + f32::EPSILON)).map(|e| e.counts())
        };
        assert_eq!(of(Mode::D3d), Some([3, 1]));
        assert_eq!(of(Mode::Exact), Some([12, 13]));
    }
}
