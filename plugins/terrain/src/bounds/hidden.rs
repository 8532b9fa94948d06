//! What of noise samples do not meet because all of them stand at the same place of its cells.
//!
//! Gradient noise is 0 at the points of its lattice. Samples as far apart as its cells are wide, or a multiple of that,
//! all stand at one place of a cell; where that is a lattice point they are 0, however high the octave is, and no
//! difference between them tells of it. Permutation noise has all of its lattices about the origin, so that on many a
//! ground whole ranges of its octaves are hidden; a fractal displaces each octave by an offset of its own, which seldom
//! is close to 0.
//!
//! Of an octave samples count as meeting the share that their place in a cell has of the height of noise: the root mean
//! square over all gradients, over that in the middle of a side, [`met`]. Their place is the farthest that one of them stands
//! from the nearest lattice line, along each axis, in cells: ½ wherever samples drift through more than half a cell from the
//! first to the last. A warp moves places and the octaves with them;
//! as it is noise itself, it may be hidden too, and counts nothing.

use crate::ground::GroundRect;
use crate::noise::Octave;
use bevy::math::DVec2;

/// Beyond so many cells from sample to sample an octave counts as hidden: its place there is beyond what the f32 of
/// `shaders/src/detail/unseen.wgsl` tells. Octaves half as high as the one before add a hundredth of what is known at most.
const MOST_CELLS: f64 = 200.0;

/// Samples over a rectangle, its corners among them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Samples {
    centre: DVec2,
    size: DVec2,
    /// Steps from the first to the last.
    count: f64,
}

impl Samples {
    /// `spacing` metres apart along the longer axis, and as many along the other.
    pub fn new(rect: &GroundRect, spacing: f64) -> Self {
        let size = rect.size();
        Self {
            centre: (rect.min + rect.max) * 0.5,
            size,
            count: (size.max_element() / spacing).round().max(1.0),
        }
    }

    /// How much of all octaves they do not meet, in the unit of their amplitudes.
    pub fn hidden(&self, octaves: &[Octave]) -> f64 {
        let of = |octave: &Octave| octave.amplitude.abs() * self.hidden_share(octave);
        octaves.iter().map(of).sum()
    }

    /// Share of an octave that they do not meet, 0 to 1.
    fn hidden_share(&self, octave: &Octave) -> f64 {
        let cells = self.size / self.count * octave.frequency.value();
        let most = cells.max_element();
        if !most.is_finite() || most < 0.5 {
            return 0.0;
        }
        if most > MOST_CELLS {
            return 1.0;
        }
        let place = |axis: usize| {
            let (_, place) = octave
                .frequency
                .coordinate_f64(self.centre[axis], octave.offset[axis]);
            let drift = 0.5 * self.count * (cells[axis] - cells[axis].round());
            farthest(place - drift, place + drift)
        };
        1.0 - met(DVec2::new(place(0), place(1)))
    }
}

/// How high noise is at a place of its cells, 0 to ½ along each axis, as a share of how high it is in the middle of a side: root
/// mean squares over gradients that all have one length and any direction. 0 on the lattice, 1 at most.
fn met(place: DVec2) -> f64 {
    let share = place * place * place * (place * (6.0 * place - 15.0) + 10.0);
    let (near, far) = (1.0 - share, share);
    // Of the four corners: the square of its weight, and of how far it is.
    let corner = |weight: DVec2, away: DVec2| {
        (weight.x * weight.y) * (weight.x * weight.y) * away.length_squared()
    };
    let beyond = 1.0 - place;
    let all = corner(near, place)
        + corner(DVec2::new(far.x, near.y), DVec2::new(beyond.x, place.y))
        + corner(DVec2::new(near.x, far.y), DVec2::new(place.x, beyond.y))
        + corner(far, beyond);
    // In the middle of a side two corners count by a half each, half a cell away.
    (8.0 * all).sqrt().min(1.0)
}

/// The farthest from a whole number that lies between two numbers, 0 to ½.
fn farthest(a: f64, b: f64) -> f64 {
    if (a + 0.5).floor() == (b + 0.5).floor() {
        (a - a.round()).abs().max((b - b.round()).abs())
    } else {
        0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::{Fractal, PermutationNoise};

    fn samples(centre: f64, step: f64) -> Samples {
        let rect = GroundRect::square(DVec2::splat(centre), 8.0 * step);
        Samples::new(&rect, step)
    }

    #[test]
    fn octaves_of_which_samples_stand_on_the_lattice_are_hidden_and_others_are_not() {
        let noise = PermutationNoise {
            octaves: 3,
            amplitude: 4.0,
            wavelength: 64.0,
            ..PermutationNoise::default()
        };
        let octaves = noise.prepare().expect("valid").octaves;
        let away = |place: f64| 1.0 - met(DVec2::splat(place));
        // 4 m in cells of 64 m, 2 m in cells of 32 m, 1 m in cells of 16 m.
        for (centre, step, hidden) in [
            (0.0, 64.0, 7.0),
            (0.0, 128.0, 7.0),
            (0.0, 32.0, 3.0),
            (0.0, 16.0, 1.0),
            (0.0, 8.0, 0.0),
            // In the middle of the largest, on the lattice of the others.
            (32.0, 64.0, 3.0),
            // A quarter into the smallest, an eighth into the next, a sixteenth into the largest.
            (
                4.0,
                64.0,
                4.0 * away(1.0 / 16.0) + 2.0 * away(0.125) + away(0.25),
            ),
            // Adrift by half a cell of the largest about its lattice point, by a whole one of the next.
            (0.0, 68.0, 4.0 * away(0.25)),
            // A cell to and a third fro: everywhere.
            (0.0, 85.0, 0.0),
        ] {
            let found = samples(centre, step).hidden(&octaves);
            assert!((found - hidden).abs() < 1e-6, "{centre} {step}: {found}");
        }
    }

    /// The height of noise itself, of as many lattices as there are seeds.
    #[test]
    fn noise_is_as_high_at_a_place_of_its_cells_as_is_said() {
        const CELL: f64 = 64.0;
        const SEEDS: u32 = 3000;
        let height = |place: DVec2| {
            let all = (0..SEEDS).map(|seed| {
                let fractal = Fractal {
                    seed,
                    octaves: 1,
                    amplitude: 1.0,
                    wavelength: CELL as f32,
                    ..Fractal::default()
                };
                let noise = fractal.prepare().expect("valid");
                let offset = noise.octaves[0].offset;
                let (_, x) = noise.octaves[0].frequency.coordinate_f64(0.0, offset[0]);
                let (_, z) = noise.octaves[0].frequency.coordinate_f64(0.0, offset[1]);
                // From where the origin is in its cell.
                let at = (place - DVec2::new(x, z)) * CELL;
                let height = noise.sample_f64(at).height;
                height * height
            });
            (all.sum::<f64>() / f64::from(SEEDS)).sqrt()
        };
        let whole = height(DVec2::new(0.5, 0.0));
        assert!(whole > 0.1, "{whole}");
        for (x, z) in [
            (0.0, 0.0),
            (0.1, 0.0),
            (0.1, 0.1),
            (0.25, 0.0),
            (0.25, 0.25),
            (0.5, 0.25),
            (0.4, 0.05),
            (0.5, 0.5),
        ] {
            let place = DVec2::new(x, z);
            let (is, said) = (height(place) / whole, met(place));
            // The root of a mean of 3000 squares has a standard deviation of 0.013; above 1 nothing more is said.
            assert!((is.min(1.0) - said).abs() < 0.04, "{place}: {is} {said}");
        }
    }

    /// What an octave does between samples is no more than twice what they differ by, and what is hidden.
    #[test]
    fn fractals_are_hidden_as_their_offsets_say() {
        const SIDE: usize = 9;
        const STEP: f64 = 64.0;
        const FINER: usize = 5;
        let (mut all, mut most, mut needed) = (0.0, 0.0_f64, 0);
        for seed in 0..200 {
            let fractal = Fractal {
                seed,
                octaves: 1,
                amplitude: -1.0,
                wavelength: STEP as f32,
                ..Fractal::default()
            };
            let noise = fractal.prepare().expect("valid");
            let hidden = samples(0.0, STEP).hidden(&noise.octaves);
            all += hidden;
            most = most.max(hidden);
            let first = DVec2::splat(-0.5 * STEP * (SIDE - 1) as f64);
            let height = |x: f64, z: f64| noise.sample_f64(first + DVec2::new(x, z) * STEP).height;
            let met: Vec<f64> = (0..SIDE * SIDE)
                .map(|k| height((k % SIDE) as f64, (k / SIDE) as f64))
                .collect();
            let at = |i: usize, j: usize| met[j * SIDE + i];
            let mut bend = 0.0_f64;
            for even in (0..SIDE).step_by(2) {
                for odd in (1..SIDE).step_by(2) {
                    let along = at(odd, even) - 0.5 * (at(odd - 1, even) + at(odd + 1, even));
                    let across = at(even, odd) - 0.5 * (at(even, odd - 1) + at(even, odd + 1));
                    bend = bend.max(along.abs()).max(across.abs());
                }
            }
            let mut off = 0.0_f64;
            for k in 0..(FINER * (SIDE - 1)).pow(2) {
                let (i, j) = (k % (FINER * (SIDE - 1)), k / (FINER * (SIDE - 1)));
                let (u, v) = ((i % FINER) as f64, (j % FINER) as f64);
                let (u, v) = (u / FINER as f64, v / FINER as f64);
                let (i, j) = (i / FINER, j / FINER);
                let row = |j: usize| at(i, j) * (1.0 - u) + at(i + 1, j) * u;
                let told = row(j) * (1.0 - v) + row(j + 1) * v;
                off = off.max((height(i as f64 + u, j as f64 + v) - told).abs());
            }
            assert!(off <= hidden + 2.0 * bend, "{seed}: {off}, {hidden} {bend}");
            needed += usize::from(off > 2.0 * bend);
        }
        // Of places spread evenly over a quarter of a cell 0.184 on the mean.
        let places = (0..10_000).map(|k| DVec2::new(f64::from(k % 100), f64::from(k / 100)));
        let mean = places.map(|at| 1.0 - met((at + 0.5) / 200.0)).sum::<f64>() / 1e4;
        assert!((0.15..0.22).contains(&mean), "{mean}");
        assert!((all / 200.0 - mean).abs() < 0.06, "{all} {mean}");
        assert!(most > 0.8 && needed > 3, "{most} {needed}");
    }
}
