//! What a fractal sum is made of: the settings that a person writes, and their checks.

use super::hash::pcg;
use super::octave::{Octave, PreparedWarp, octave_table};
use super::sum::MAX_OCTAVES;
use bevy::reflect::Reflect;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How the octaves are put together. nₖ is octave k's noise in [−1, 1], aₖ its amplitude.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
pub enum Sum {
    /// Σ aₖ nₖ: rolling ground (B. Mandelbrot; K. Musgrave 1994).
    #[default]
    Fbm,
    /// Σ aₖ rₖ² rₖ₋₁², r = 1 − |n|, r₋₁ = 1: sharp crests, detail only near them (after
    /// Musgrave's ridged multifractal, 1994). |n| is √(n² + ε²), so that crests are round on the
    /// scale of ε = 1/32 of the noise and the gradient is defined everywhere.
    Ridged,
    /// Σ aₖ (2|n| − 1) with the same |n|: round hills, sharp creases between them.
    Billow,
    /// Σ aₖ nₖ / (1 + erosion·|Gₖ|²): detail fades where the slope Gₖ gathered by octaves 0..=k
    /// (in units of the first octave's amplitude/wavelength) is steep, as if washed down (idea:
    /// I. Quilez, "Value noise derivatives", 2008). The gradient is exact, through second
    /// derivatives.
    Eroded,
}

/// Displaces the ground position before a fractal looks at it: p + strength·(f₁(p), f₂(p)), both
/// FBM of gain ½ and lacunarity 2 (I. Quilez, "Domain warping", 2002). Gradients go through the
/// chain rule exactly.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Warp {
    /// Displacement for noise of 1 in the first octave, metres; 0 to 1e5.
    pub strength: f32,
    /// Wavelength of the first octave, metres.
    pub wavelength: f32,
    /// Octaves, 1 to 8.
    pub octaves: u32,
    /// Any number.
    pub seed: u32,
}

/// A fractal sum of gradient noise: heights of a kind of ground, without end, from a few numbers.
///
/// Error of the f32 value (scalar, batch and WGSL) against the f64 oracle, for gain ½,
/// lacunarity 2, up to 16 octaves, at any distance: FBM at most 1e-5 of the amplitude (3e-7 seen),
/// gradient at most 1e-4 of amplitude / wavelength (3e-6 seen). Each octave adds about 1e-7 of its
/// own amplitude and 5e-7 of its own amplitude / wavelength, so a larger gain × lacunarity errs
/// more in proportion. Other sums and warps: values alike, gradients up to 4e-5.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Fractal {
    /// How the octaves are put together.
    pub sum: Sum,
    /// Any number; other seeds give other ground.
    pub seed: u32,
    /// Octaves, 1 to 24.
    pub octaves: u32,
    /// Ratio of frequencies of successive octaves, in [1, 4).
    pub lacunarity: f32,
    /// Ratio of amplitudes of successive octaves, in (0, 1].
    pub gain: f32,
    /// Amplitude of the first octave, metres; not 0, up to 1e6 either way (negative turns it upside down).
    pub amplitude: f32,
    /// Wavelength (cell size) of the first octave, metres. The finest octave's must be at least
    /// 1 mm, the coarsest at most 2³⁰ m.
    pub wavelength: f32,
    /// Strength of [`Sum::Eroded`], 0 to 1e3; else unused.
    pub erosion: f32,
    /// Displacement of the position, if any.
    pub warp: Option<Warp>,
}

impl Default for Fractal {
    fn default() -> Self {
        Self {
            sum: Sum::Fbm,
            seed: 0,
            octaves: 8,
            lacunarity: 2.0,
            gain: 0.5,
            amplitude: 100.0,
            wavelength: 1000.0,
            erosion: 1.0,
            warp: None,
        }
    }
}

/// A setting of a source that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{field} is {value}, but it must be {allowed}")]
pub struct NoiseError {
    /// The field, as it is written in a scene file.
    pub field: &'static str,
    /// What it was.
    pub value: f64,
    /// What would be accepted.
    pub allowed: &'static str,
}

impl NoiseError {
    /// `Err` unless `ok`.
    pub(crate) fn check(
        ok: bool,
        field: &'static str,
        value: f64,
        allowed: &'static str,
    ) -> Result<(), Self> {
        if ok {
            Ok(())
        } else {
            Err(Self {
                field,
                value,
                allowed,
            })
        }
    }
}

/// A validated [`Fractal`] with its octave table. Evaluate many points with this one.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedFractal {
    pub(crate) sum: Sum,
    pub(crate) erosion: f32,
    pub(crate) octaves: Vec<Octave>,
    pub(crate) warp: Option<PreparedWarp>,
}

/// Most octaves of a warp.
const MAX_WARP_OCTAVES: u32 = 8;
impl Fractal {
    /// Whether every field can be used; the error names the first that cannot.
    ///
    /// # Errors
    /// A number that is NaN, infinite or out of the range stated at its field.
    pub fn validate(&self) -> Result<(), NoiseError> {
        self.prepare().map(drop)
    }

    /// Checks the settings and lays out the octave table. Costs about 20 ns an octave.
    ///
    /// # Errors
    /// As [`Fractal::validate`].
    pub fn prepare(&self) -> Result<PreparedFractal, NoiseError> {
        let check = NoiseError::check;
        check(
            (1..=MAX_OCTAVES as u32).contains(&self.octaves),
            "octaves",
            f64::from(self.octaves),
            "from 1 to 24",
        )?;
        check(
            self.amplitude.is_normal() && self.amplitude.abs() <= 1e6,
            "amplitude",
            f64::from(self.amplitude),
            "a number of metres other than 0, at most 1e6 either way",
        )?;
        check(
            self.gain.is_normal() && self.gain > 0.0 && self.gain <= 1.0,
            "gain",
            f64::from(self.gain),
            "above 0 and at most 1",
        )?;
        check(
            (0.0..=1e3).contains(&self.erosion),
            "erosion",
            f64::from(self.erosion),
            "from 0 to 1000",
        )?;
        let octaves = octave_table(self)?;
        let warp = self.warp.map(|warp| warp.prepare()).transpose()?;
        Ok(PreparedFractal {
            sum: self.sum,
            erosion: self.erosion,
            octaves,
            warp,
        })
    }
}

impl Warp {
    fn prepare(&self) -> Result<PreparedWarp, NoiseError> {
        let check = NoiseError::check;
        check(
            (0.0..=1e5).contains(&self.strength),
            "warp.strength",
            f64::from(self.strength),
            "from 0 to 1e5 metres",
        )?;
        check(
            (1..=MAX_WARP_OCTAVES).contains(&self.octaves),
            "warp.octaves",
            f64::from(self.octaves),
            "from 1 to 8",
        )?;
        let table = |seed: u32| {
            let fbm = Fractal {
                seed,
                octaves: self.octaves,
                amplitude: self.strength,
                wavelength: self.wavelength,
                ..Fractal::default()
            };
            octave_table(&fbm).map_err(|error| NoiseError {
                field: "warp.wavelength",
                ..error
            })
        };
        // The two displacements are fractals of two seeds that no user seed gives both of.
        Ok(PreparedWarp {
            x: table(pcg(self.seed))?,
            z: table(pcg(pcg(self.seed)))?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_settings_are_named() {
        let good = Fractal::default();
        let cases = [
            ("octaves", Fractal { octaves: 0, ..good }),
            (
                "octaves",
                Fractal {
                    octaves: 25,
                    ..good
                },
            ),
            (
                "amplitude",
                Fractal {
                    amplitude: f32::NAN,
                    ..good
                },
            ),
            (
                "amplitude",
                Fractal {
                    amplitude: 0.0,
                    ..good
                },
            ),
            (
                "gain",
                Fractal {
                    gain: f32::INFINITY,
                    ..good
                },
            ),
            ("gain", Fractal { gain: 0.0, ..good }),
            (
                "lacunarity",
                Fractal {
                    lacunarity: f32::NAN,
                    ..good
                },
            ),
            (
                "lacunarity",
                Fractal {
                    lacunarity: 4.0,
                    ..good
                },
            ),
            (
                "wavelength",
                Fractal {
                    wavelength: 0.0,
                    ..good
                },
            ),
            (
                "wavelength",
                Fractal {
                    wavelength: -5.0,
                    ..good
                },
            ),
            (
                "wavelength",
                Fractal {
                    wavelength: f32::NAN,
                    ..good
                },
            ),
            (
                "wavelength",
                Fractal {
                    wavelength: 1.0,
                    octaves: 24,
                    ..good
                },
            ),
            (
                "erosion",
                Fractal {
                    erosion: -1.0,
                    ..good
                },
            ),
        ];
        for (field, fractal) in cases {
            assert_eq!(
                fractal.validate().map_err(|error| error.field),
                Err(field),
                "{fractal:?}"
            );
        }
        let warp = Warp {
            strength: 10.0,
            wavelength: 500.0,
            octaves: 3,
            seed: 1,
        };
        for (field, warp) in [
            (
                "warp.strength",
                Warp {
                    strength: f32::NAN,
                    ..warp
                },
            ),
            (
                "warp.wavelength",
                Warp {
                    wavelength: 0.0,
                    ..warp
                },
            ),
            ("warp.octaves", Warp { octaves: 9, ..warp }),
        ] {
            let fractal = Fractal {
                warp: Some(warp),
                ..good
            };
            assert_eq!(
                fractal.validate().map_err(|error| error.field),
                Err(field),
                "{fractal:?}"
            );
        }
        assert_eq!(good.validate(), Ok(()));
        assert_eq!(
            Fractal {
                wavelength: 16_777.216,
                octaves: 24,
                ..good
            }
            .validate(),
            Ok(())
        );
    }

    #[test]
    fn octaves_differ_in_seed_and_offset() {
        let table = Fractal::default().prepare().expect("valid").octaves;
        for (i, a) in table.iter().enumerate() {
            for b in &table[..i] {
                assert!(
                    a.seed != b.seed && a.offset[0] != b.offset[0] && a.offset[1] != b.offset[1]
                );
            }
        }
    }
}
