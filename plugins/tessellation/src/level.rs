//! From the levels that a control function wrote to the levels that count: discard, clamp, round
//! (OpenGL 4.6 core, 11.2.2.1; Vulkan 1.3, "Tessellator Spacing"). The CPU reference of
//! `shaders/src/stage/level.wgsl`.
//!
//! Numbers are read by their bits: NaN, infinities and denormals mean the same on a GPU that
//! flushes or assumes them away.

use super::{Domain, Mode, Spacing};

/// Most segments of an edge.
pub const MAX_SEGMENTS: u32 = 64;

/// What a control function writes for one patch. Entries that the domain does not have are ignored.
///
/// An outer level of the domain that is NaN, zero or negative discards the patch; inner levels
/// never do. Others are clamped to [1, 64] (equal), [2, 64] (even) or [1, 63] (odd).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// Of the sides: u = 0, v = 0, u = 1 (triangles: w = 0), v = 1. Isolines: lines, segments.
    pub outer: [f32; 4],
    /// Along u and along v; triangles use the first.
    pub inner: [f32; 2],
}

impl Levels {
    /// The same level everywhere.
    #[must_use]
    pub const fn uniform(level: f32) -> Self {
        Self {
            outer: [level; 4],
            inner: [level; 2],
        }
    }
}

/// A level after clamping and rounding, in units of 2⁻²³, from 1 to 64.
///
/// 2⁻²³ holds every f32 in that range exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Level(pub u32);

/// Level 1.
pub const ONE: u32 = 1 << 23;

impl Level {
    /// Number of segments: the level rounded up to an integer, even integer or odd integer.
    #[must_use]
    pub const fn segments(self, spacing: Spacing) -> u32 {
        match spacing {
            Spacing::Equal => self.0.div_ceil(ONE),
            Spacing::FractionalEven => 2 * self.0.div_ceil(2 * ONE),
            Spacing::FractionalOdd => 2 * (self.0 + ONE).div_ceil(2 * ONE) - 1,
        }
    }
}

/// Least and greatest level.
const fn bounds(spacing: Spacing) -> [u32; 2] {
    match spacing {
        Spacing::Equal => [ONE, 64 * ONE],
        Spacing::FractionalEven => [2 * ONE, 64 * ONE],
        Spacing::FractionalOdd => [ONE, 63 * ONE],
    }
}

/// Clamps and rounds a level that is a number; NaN and what is not positive gives the least.
fn clamp(level: f32, spacing: Spacing, mode: Mode) -> Level {
    let bits = level.to_bits();
    let [least, greatest] = bounds(spacing);
    // From 1.0 up to infinity, positive: exponent at least 127, not a NaN.
    if !(0x3f80_0000..=0x7f80_0000).contains(&bits) {
        return Level(least);
    }
    let exponent = (bits >> 23) - 127;
    if exponent >= 6 {
        return Level(greatest);
    }
    let fixed = ((bits & (ONE - 1)) | ONE) << exponent;
    let rounded = match (spacing, mode) {
        (Spacing::Equal, _) => fixed.div_ceil(ONE) * ONE,
        (_, Mode::Exact) => fixed,
        (_, Mode::D3d) => quantized(fixed),
    };
    Level(rounded.clamp(least, greatest))
}

/// As the reference tessellator rounds a fractional level: to nearest even in 16.16, of which it
/// takes half, rounded up.
const fn quantized(fixed: u32) -> u32 {
    let nearest = (fixed + 63 + ((fixed >> 7) & 1)) >> 7;
    nearest.div_ceil(2) << 8
}

/// An outer level; `None` where it discards the patch.
#[must_use]
pub fn outer(level: f32, spacing: Spacing, mode: Mode) -> Option<Level> {
    let bits = level.to_bits();
    // Positive, denormals and infinity too, but no NaN.
    ((1..=0x7f80_0000).contains(&bits)).then(|| clamp(level, spacing, mode))
}

/// The inner levels: clamped, then lifted above 1 where anything else is above 1.
#[must_use]
pub fn inner(
    levels: [f32; 2],
    outer: &[Level; 4],
    domain: Domain,
    spacing: Spacing,
    mode: Mode,
) -> [Level; 2] {
    let clamped = clamp_inner(levels, domain, spacing, mode);
    lift_inner(clamped, &outer[..domain.outer_levels()], spacing, mode)
}

/// The inner levels, clamped, not yet lifted.
#[must_use]
pub fn clamp_inner(levels: [f32; 2], domain: Domain, spacing: Spacing, mode: Mode) -> [Level; 2] {
    let [u, v] = levels.map(|level| clamp(level, spacing, mode));
    [u, if domain == Domain::Triangles { u } else { v }]
}

/// Lifts clamped inner levels above 1 where they or the levels of the sides are above 1.
#[must_use]
pub fn lift_inner(inner: [Level; 2], sides: &[Level], spacing: Spacing, mode: Mode) -> [Level; 2] {
    if sides.iter().chain(&inner).any(|level| level.0 > ONE) {
        let least = above_one(spacing, mode);
        inner.map(|level| level.max(least))
    } else {
        inner
    }
}

/// A clamped level lowered to `share` / 1024 of it, clamped and rounded again; as `lower` in
/// `work.wgsl`.
#[must_use]
pub fn lower(level: Level, share: u32, spacing: Spacing, mode: Mode) -> Level {
    if share == WHOLE_SHARE || level.0 == 0 {
        return level;
    }
    // At most 2^29: no carry is lost.
    let lowered = ((level.0 >> 9) * share) >> 1;
    let rounded = match (spacing, mode) {
        (Spacing::Equal, _) => lowered.div_ceil(ONE) * ONE,
        (_, Mode::Exact) => lowered,
        (_, Mode::D3d) => lowered.div_ceil(256) * 256,
    };
    let [least, greatest] = bounds(spacing);
    Level(rounded.clamp(least, greatest))
}

/// The share of levels that are not lowered.
pub const WHOLE_SHARE: u32 = 1024;

/// "1 + ε, then rounded", which the specification asks for; least level of a picture frame.
const fn above_one(spacing: Spacing, mode: Mode) -> Level {
    match (spacing, mode) {
        (Spacing::Equal | Spacing::FractionalEven, _) => Level(2 * ONE),
        (Spacing::FractionalOdd, Mode::Exact) => Level(ONE + 1),
        // 1 + 2^-16 in 16.16, of which half is rounded up.
        (Spacing::FractionalOdd, Mode::D3d) => Level(ONE + (1 << 8)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPACINGS: [Spacing; 3] = [
        Spacing::Equal,
        Spacing::FractionalEven,
        Spacing::FractionalOdd,
    ];

    #[test]
    fn what_is_not_positive_discards() {
        for level in [0.0, -0.0, -1.0, f32::NAN, -f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(outer(level, Spacing::Equal, Mode::Exact), None, "{level}");
        }
        for level in [f32::from_bits(1), 1e-20, 0.3, f32::INFINITY, 1e9] {
            assert!(
                outer(level, Spacing::Equal, Mode::Exact).is_some(),
                "{level}"
            );
        }
    }

    #[test]
    fn segments_are_rounded_up_to_their_kind() {
        let segments = |level: f32| {
            SPACINGS.map(|spacing| {
                let level = outer(level, spacing, Mode::Exact).expect("positive");
                level.segments(spacing)
            })
        };
        assert_eq!(segments(1e-40), [1, 2, 1]);
        assert_eq!(segments(1.0), [1, 2, 1]);
        assert_eq!(segments(1.000_000_1), [2, 2, 3]);
        assert_eq!(segments(2.0), [2, 2, 3]);
        assert_eq!(segments(2.000_000_2), [3, 4, 3]);
        assert_eq!(segments(3.0), [3, 4, 3]);
        assert_eq!(segments(62.5), [63, 64, 63]);
        assert_eq!(segments(63.5), [64, 64, 63]);
        assert_eq!(segments(f32::INFINITY), [64, 64, 63]);
    }

    #[test]
    fn an_inner_level_of_one_is_lifted_only_beside_a_higher_one() {
        let lift = |spacing, outer: f32, inner_levels| {
            let outer = [super::outer(outer, spacing, Mode::Exact).expect("positive"); 4];
            inner(inner_levels, &outer, Domain::Quads, spacing, Mode::Exact)
                .map(|level| level.segments(spacing))
        };
        assert_eq!(lift(Spacing::Equal, 1.0, [1.0, f32::NAN]), [1, 1]);
        assert_eq!(lift(Spacing::Equal, 1.0, [1.0, 5.0]), [2, 5]);
        assert_eq!(lift(Spacing::Equal, 4.0, [f32::NAN, -3.0]), [2, 2]);
        assert_eq!(lift(Spacing::FractionalOdd, 1.5, [0.0, 1.0]), [3, 3]);
        assert_eq!(lift(Spacing::FractionalEven, 0.1, [0.0, 1.0]), [2, 2]);
    }
}
