//! What the ground looks like where blades are too thin to be drawn: cover and colour by the elevation of the view.
//!
//! Cover is that of a Boolean model (e.g. S. Chiu and others, *Stochastic Geometry and its Applications*, 2013):
//! C = 1 − exp(−λ·a(θ)/sin θ), with λ blades a square metre and a(θ) the area that one hides from rays of the elevation
//! θ. λ·a(θ) is a table over sin θ, fitted to the brute-force picture of [`crate::reference`]; at another density it is
//! proportional to it. The colour is a table beside it.

use bevy::math::ops;
use bytemuck::{Pod, Zeroable};

use crate::density::{Growth, NO_CLUMPS};
use crate::kind::Blade;
use crate::reference::{Manner, draw, field_of, mean};

/// Entries: sines of 1/256 to 1, by powers of √2.
pub const ENTRIES: usize = 17;

/// Blades that the table is the mean of, at least: as many fields are drawn as hold them.
const BLADES: f32 = 20_000.0;

/// Side of a field, metres, and its samples along a side: a blade is half a sample wide or so. What falls between samples
/// is as likely to be met as what does not.
const SIDE: f32 = 8.0;
const SAMPLES: usize = 256;

/// As it is drawn: what differs from blade to blade is its mean, so that fewer blades are enough.
const MANNER: Manner = Manner {
    segments: 7,
    calm: 1.0,
};

/// Most fields: of what is that thin few are enough to be seen at all.
const MOST_FIELDS: f32 = 32.0;

/// From this cover on fields differ by less than what is asked for, and one of them is as good as many.
const WHOLE: f64 = 0.999;

/// Sine of the first entry. Below it the cover is whole.
const FIRST: f32 = 1.0 / 256.0;

/// The far field of a kind: 17 entries of λ·a and a colour, for shaders too.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct FarField {
    /// λ·a(θ) at full density, and the mean linear colour of what is seen.
    pub entries: [[f32; 4]; ENTRIES],
}

/// What covers the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cover {
    /// Share of the ground that is hidden.
    pub share: f32,
    /// Mean linear colour of what hides it.
    pub colour: [f32; 3],
}

impl FarField {
    /// Fits the table to a picture of the kind's blades: some tenths of a second, for a task.
    #[must_use]
    pub fn fit(blade: &Blade, growth: &Growth) -> Self {
        // A clump is one of many: their mean is a field without any.
        let growth = &Growth {
            clump_size: NO_CLUMPS,
            ..*growth
        };
        let field = field_of(growth, SIDE, SAMPLES, [1 << 20, 1 << 20]);
        let mut entries = [[0.0; 4]; ENTRIES];
        let each = growth.full * growth.lattice.density() * SIDE * SIDE;
        let mut fields = (BLADES / each.max(1.0)).ceil().clamp(1.0, MOST_FIELDS) as i32;
        for (k, entry) in entries.iter_mut().enumerate().rev() {
            let sine = FIRST * ops::exp2(0.5 * k as f32);
            let seen = mean(field, fields, |field| {
                draw(field, blade, growth, sine.min(1.0), |_| 1.0, MANNER)
            });
            // Where all samples are covered the depth is at least that of half a sample.
            let all = f64::from(fields) * (SAMPLES * SAMPLES) as f64;
            if seen.cover > WHOLE {
                fields = 1;
            }
            let bare = (1.0 - seen.cover).max(0.5 / all);
            let depth = -ops::ln(bare as f32) * sine;
            let [r, g, b] = seen.colour.map(|part| part as f32);
            *entry = [depth, r, g, b];
        }
        Self { entries }
    }

    /// Cover and colour at an elevation whose sine is `sine`, and a share of the full density.
    #[must_use]
    pub fn at(&self, sine: f32, share: f32) -> Cover {
        let sine = if sine > FIRST { sine.min(1.0) } else { FIRST };
        let (k, part) = entry_of(sine);
        let [low, high] = [self.entries[k], self.entries[k + 1]];
        let mixed = [0, 1, 2, 3].map(|n| low[n] + (high[n] - low[n]) * part);
        Cover {
            share: 1.0 - ops::exp(-mixed[0] * share.max(0.0) / sine),
            colour: [mixed[1], mixed[2], mixed[3]],
        }
    }
}

/// Where among the entries a sine lies: entry, and share of the way to the next.
#[must_use]
pub fn entry_of(sine: f32) -> (usize, f32) {
    let sine = if sine > FIRST { sine.min(1.0) } else { FIRST };
    let place = (2.0 * ops::log2(sine / FIRST)).clamp(0.0, (ENTRIES - 1) as f32);
    let entry = (place as usize).min(ENTRIES - 2);
    (entry, place - entry as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between its entries, on other ground than it was fitted to, the table says what the picture does: cover within
    /// 1 % and colour within 1/255.
    #[test]
    fn table_is_that_of_the_picture() {
        let (blade, growth) = crate::kind::defaults::grass();
        let growth = Growth {
            clump_size: NO_CLUMPS,
            ..growth
        };
        let far = FarField::fit(&blade, &growth);
        let field = field_of(&growth, SIDE, 2 * SAMPLES, [-5000, 777]);
        for sine in [0.93, 0.6, 0.3, 0.15, 0.07, 0.03] {
            let seen = mean(field, 8, |field| {
                draw(field, &blade, &growth, sine, |_| 1.0, Manner::FINEST)
            });
            let ours = far.at(sine, 1.0);
            let cover = (f64::from(ours.share) - seen.cover).abs();
            assert!(cover < 0.01, "{sine}: {} {}", ours.share, seen.cover);
            for (ours, seen) in ours.colour.iter().zip(seen.colour) {
                assert!(
                    (f64::from(*ours) - seen).abs() < 1.0 / 255.0,
                    "{sine}: {ours} {seen}"
                );
            }
        }
        let nothing = far.at(0.0, 0.0);
        assert_eq!(nothing.share, 0.0);
        assert!(far.at(f32::NAN, 1.0).share > 0.99);
    }
}
