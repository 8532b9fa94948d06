//! How densely a kind grows at a place: [`Growth`], the numbers that shaders read too.
//!
//! All of it is f32 operations that WGSL has: clamps and products. An implementation of WGSL may fuse a product and a
//! sum, so that shares agree to an ulp or two, and a root whose rank lies that near to its threshold (one of some 10⁶)
//! may stand in one and not in the other; where roots are, and their ranks, agree to the bit.

use bytemuck::{Pod, Zeroable};
use dolomite_terrain::noise::hash::pcg;

use crate::band::{ramp, steepness};
use crate::kind::Kind;
use crate::place::{Clump, Lattice, Root, salted, threshold, unit};

/// Where a kind grows, 64 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Growth {
    /// Its lattice.
    pub lattice: Lattice,
    /// Its density where it grows best, as a share of the lattice's own.
    pub full: f32,
    /// How much clumps differ, 0 to 1.
    pub uneven: f32,
    /// Heights above the sea: from, to, and the steepness of the edges.
    pub height: [f32; 3],
    /// Slopes: from, to, and the steepness of the edges.
    pub slope: [f32; 3],
    /// Seed of the clumps' pattern.
    pub clump_seed: u32,
    /// Width of a clump: 2 to this power cells of the lattice; [`NO_CLUMPS`]: none.
    pub clump_size: u32,
    /// It grows in clumps whose number is at least this.
    pub clump_from: f32,
    /// It grows in clumps whose number is less than this.
    pub clump_to: f32,
    /// To fill 64 bytes.
    pub rest: [u32; 2],
}

/// As [`Growth::clump_size`]: the kind does not grow in clumps.
pub const NO_CLUMPS: u32 = u32::MAX;

/// FNV-1a over a name, 32 bits.
const fn name_hash(name: &str) -> u32 {
    let bytes = name.as_bytes();
    let mut hash = 0x811C_9DC5_u32;
    let mut k = 0;
    while k < bytes.len() {
        hash = (hash ^ bytes[k] as u32).wrapping_mul(0x0100_0193);
        k += 1;
    }
    hash
}

impl Growth {
    /// Of a kind, in a world of this seed.
    #[must_use]
    pub fn new(kind: &Kind, seed: u32) -> Self {
        let lattice =
            Lattice::of_density(name_hash(&kind.name).wrapping_add(pcg(seed)), kind.density);
        let (clump_seed, clump_size, from, to, uneven) =
            kind.clumps
                .as_ref()
                .map_or((0, NO_CLUMPS, 0.0, 1.0, 0.0), |clumps| {
                    let cells = (clumps.size / lattice.pitch()).max(1.0);
                    // The power of two nearest to it in ratio: the exponent of √2 times as much.
                    let size = ((cells * std::f32::consts::SQRT_2).to_bits() >> 23) - 127;
                    let seed = pcg(name_hash(&clumps.of).wrapping_add(pcg(seed)));
                    (seed, size.min(12), clumps.from, clumps.to, clumps.uneven)
                });
        Self {
            lattice,
            full: (kind.density / lattice.density()).min(1.0),
            uneven,
            height: [
                kind.height.from,
                kind.height.to,
                steepness(kind.height.soft),
            ],
            slope: [kind.slope.from, kind.slope.to, steepness(kind.slope.soft)],
            clump_seed,
            clump_size,
            clump_from: from,
            clump_to: to,
            rest: [0; 2],
        }
    }

    /// The same with a share of its density, 0 to 1; 0 for NaN.
    #[must_use]
    pub fn thinned(self, share: f32) -> Self {
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        Self {
            full: self.full * share,
            ..self
        }
    }

    /// The clump of a candidate, if the kind grows in clumps.
    #[must_use]
    pub fn clump(&self, root: Root) -> Option<Clump> {
        (self.clump_size != NO_CLUMPS)
            .then(|| self.lattice.clump(root, self.clump_seed, self.clump_size))
    }

    /// The density by the clump alone, as a share of the full one.
    #[must_use]
    pub fn clump_share(&self, clump: Option<Clump>) -> f32 {
        clump.map_or(1.0, |clump| {
            let number = unit(salted(clump.hash, 2));
            if number >= self.clump_from && number < self.clump_to {
                1.0 - self.uneven * unit(salted(clump.hash, 3))
            } else {
                0.0
            }
        })
    }

    /// The density at a height above the sea and a slope, as a share of the lattice's own. The last factor is that of
    /// the clump, [`Growth::clump_share`].
    #[inline]
    #[must_use]
    pub fn share(&self, above_sea: f32, slope: f32, clump_share: f32) -> f32 {
        let [from, to, steep] = self.height;
        let [least, most, edge] = self.slope;
        self.full * ramp(above_sea, from, to, steep) * ramp(slope, least, most, edge) * clump_share
    }

    /// Whether a candidate stands, with the ground at its place as given.
    #[must_use]
    pub fn stands(&self, root: Root, above_sea: f32, slope: f32) -> bool {
        // The cheap test comes first: no clump raises the density.
        root.rank < threshold(self.share(above_sea, slope, 1.0))
            && root.rank
                < threshold(self.share(above_sea, slope, self.clump_share(self.clump(root))))
    }

    /// Whether anything can stand where heights above the sea are within `least..=most` and no slope is more than
    /// `steepest`: where this is false no candidate has to be looked at.
    #[must_use]
    pub fn possible(&self, least: f32, most: f32, steepest: f32) -> bool {
        self.full > 0.0
            && self.clump_to > self.clump_from
            && most > self.height[0]
            && least < self.height[1]
            && steepest > self.slope[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kind::Kinds;

    fn growth(name: &str) -> Growth {
        let kinds = Kinds::small_set();
        Growth::new(kinds.find(name).expect("in the example").1, 1)
    }

    /// Over a field of cells the number of roots is the integral of the density, and none is outside of a band.
    #[test]
    fn count_is_the_integral_of_the_density() {
        let growth = Growth {
            clump_size: NO_CLUMPS,
            ..growth("grass")
        };
        let [from, to, steep] = growth.height;
        let (mut count, mut integral) = (0_u32, 0.0_f64);
        for z in 0..1024 {
            for x in 0..1024 {
                let root = growth.lattice.root([x, z]);
                // A ramp of heights across the field, past both borders, and of slopes along it.
                let height = from - 20.0 + (to - from + 40.0) * x as f32 / 1024.0;
                let slope = z as f32 / 1024.0;
                let stands = growth.stands(root, height, slope);
                assert!(!stands || (height > from && height < to && slope < growth.slope[1]));
                count += u32::from(stands);
                let edge = |a: f32, b: f32, s: f32| f64::from(a.min(b) * s).clamp(0.0, 1.0);
                integral += f64::from(growth.full)
                    * edge(height - from, to - height, steep)
                    * edge(slope + 1.0, growth.slope[1] - slope, growth.slope[2]);
            }
        }
        let error = f64::from(count) / integral - 1.0;
        // Nested ranks spread each share evenly: far less than the 1/√count of random ones.
        assert!(error.abs() < 0.005, "{count} for {integral}");
    }

    /// Clumps of one pattern whose ranges do not overlap never share a clump; the sum of ranges is the sum of clumps.
    #[test]
    fn kinds_exclude_each_other_by_clumps() {
        let [daisy, poppy] = ["daisy", "poppy"].map(growth);
        assert_eq!(daisy.clump_seed, poppy.clump_seed);
        assert_eq!(
            daisy.lattice.pitch_log2, poppy.lattice.pitch_log2,
            "the same cells"
        );
        let (mut daisies, mut poppies) = (0, 0);
        for k in 0..20_000_u32 {
            let cell = [salted(k, 1), salted(k, 2)].map(|h| (h >> 16).cast_signed());
            let root = Root {
                at: 0,
                ..daisy.lattice.root(cell)
            };
            let share = [daisy, poppy].map(|kind| kind.clump_share(kind.clump(root)));
            assert!(share[0] == 0.0 || share[1] == 0.0);
            daisies += i32::from(share[0] > 0.0);
            poppies += i32::from(share[1] > 0.0);
        }
        // Means of 22 % and 14 % of 20 000: five standard deviations.
        assert!(
            (daisies - 4400).abs() < 293 && (poppies - 2800).abs() < 245,
            "{daisies} {poppies}"
        );
    }

    #[test]
    fn nothing_is_looked_at_where_nothing_can_grow() {
        let growth = growth("grass");
        assert!(growth.possible(0.0, 10.0, 0.1));
        assert!(!growth.possible(-50.0, 1.0, 0.1));
        assert!(!growth.possible(620.0, 700.0, 0.1));
        assert!(
            !Growth {
                full: 0.0,
                ..growth
            }
            .possible(0.0, 10.0, 0.1)
        );
        let k = growth.lattice.root([3, 4]);
        for height in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(!growth.stands(k, height, 0.0) && !growth.stands(k, 100.0, height));
        }
    }
}
