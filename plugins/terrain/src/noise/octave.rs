//! The octave table of a fractal: what every evaluator (scalar, batch, f64, WGSL) reads.

use super::coordinate::{Frequency, lacunarity_fixed};
use super::fractal::{Fractal, NoiseError};
use super::hash::pcg;
use super::sum::Scale;

/// One octave, ready to evaluate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octave {
    /// Cells a metre.
    pub frequency: Frequency,
    /// Added to the coordinates (x, z; 32.32 cells), so that lattices of octaves do not line up.
    pub offset: [i64; 2],
    /// Seed of the lattice hash.
    pub seed: u32,
    /// Metres, as the product of the settings in f64.
    pub amplitude: f64,
    /// The factors in f32.
    pub(crate) scale: Scale,
}

impl Octave {
    /// Amplitude × frequency: metres a metre.
    #[must_use]
    pub fn slope(&self) -> f64 {
        self.amplitude * self.frequency.value()
    }

    /// The same octave with amplitude 1: its bare noise, gradient a metre.
    pub(crate) fn unit(&self) -> Self {
        let scale = Scale::new(1.0, self.frequency, self.frequency.value());
        Self {
            amplitude: 1.0,
            scale,
            ..*self
        }
    }
}

/// The displacement of a [`Warp`](super::Warp), ready to evaluate: one table for x, one for z. Amplitudes are
/// in metres (the strength is in them).
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedWarp {
    /// Octaves of the displacement along x.
    pub x: Vec<Octave>,
    /// Octaves of the displacement along z; the same frequencies and amplitudes.
    pub z: Vec<Octave>,
}

/// Smallest cell, metres: [`Frequency::SHIFT_MIN`] allows 0.49 mm.
const FINEST: f64 = 1e-3;

/// Lays out the octaves: frequency by exact recurrence, amplitude in f64, seeds and offsets by PCG.
pub(super) fn octave_table(fractal: &Fractal) -> Result<Vec<Octave>, NoiseError> {
    let lacunarity = lacunarity_fixed(fractal.lacunarity).ok_or(NoiseError {
        field: "lacunarity",
        value: f64::from(fractal.lacunarity),
        allowed: "at least 1 and below 4",
    })?;
    let wavelength = NoiseError {
        field: "wavelength",
        value: f64::from(fractal.wavelength),
        allowed: "such that every octave's wavelength lies between 1 mm and 2^30 m",
    };
    let first = Frequency::from_wavelength(f64::from(fractal.wavelength));
    let mut frequency = first
        .filter(|_| fractal.wavelength <= 1_073_741_824.0)
        .ok_or(wavelength)?;
    let mut amplitude = f64::from(fractal.amplitude);
    let mut first_slope = None;
    let mut table = Vec::with_capacity(fractal.octaves as usize);
    for k in 0..fractal.octaves {
        if k > 0 {
            frequency = frequency.times(lacunarity).ok_or(wavelength)?;
            amplitude *= f64::from(fractal.gain);
        }
        if frequency.value() * FINEST > 1.0 + 1e-6 {
            return Err(wavelength);
        }
        let seed = pcg(pcg(fractal.seed).wrapping_add(k));
        let mut word = seed;
        let mut next = || {
            word = pcg(word);
            i64::from(word)
        };
        let offset = [(next() << 32) | next(), (next() << 32) | next()];
        let slope = amplitude * frequency.value();
        let first = *first_slope.get_or_insert(slope);
        let scale = Scale::new(amplitude, frequency, first);
        table.push(Octave {
            frequency,
            offset,
            seed,
            amplitude,
            scale,
        });
    }
    Ok(table)
}
