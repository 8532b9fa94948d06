//! One round hill of finite extent.

use crate::ground::{GroundPoint, GroundSample, Height};
use crate::noise::NoiseError;
use bevy::math::DVec2;
use bevy::reflect::Reflect;
use serde::{Deserialize, Serialize};

/// height·(1 − r²/R²)³ within R of the centre, 0 beyond: smooth to second order at the rim.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hill {
    /// Centre (x, z), metres.
    #[serde(with = "pair")]
    pub centre: DVec2,
    /// R, metres; 0.01 to 1e8.
    pub radius: f32,
    /// Height of the top, metres, up to 1e6; a hollow if negative.
    pub height: f32,
}

impl Hill {
    /// Whether every field can be used.
    ///
    /// # Errors
    /// Names the first field that is not finite or out of its range.
    pub fn validate(&self) -> Result<(), NoiseError> {
        NoiseError::check(
            self.centre.is_finite() && self.centre.abs().max_element() <= 1e9,
            "centre",
            self.centre.x,
            "two numbers of at most 1e9 metres either way",
        )?;
        NoiseError::check(
            (0.01..=1e8).contains(&self.radius),
            "radius",
            f64::from(self.radius),
            "from 0.01 to 1e8 metres",
        )?;
        NoiseError::check(
            self.height.is_finite() && self.height.abs() <= 1e6,
            "height",
            f64::from(self.height),
            "a number of metres of at most 1e6 either way",
        )
    }

    /// Height and gradient in f32. Error: value 4e-7, gradient 2e-6 (of height, height/R).
    #[must_use]
    pub fn sample(&self, point: GroundPoint) -> Height {
        let inverse = self.inverse_radius();
        let d = point.relative_to(GroundPoint::new(self.centre)) * inverse;
        let rest = (1.0 - d.length_squared()).max(0.0);
        let square = rest * rest;
        Height {
            value: self.height * square * rest,
            gradient: d * (-6.0 * self.height * inverse * square),
        }
    }

    /// 1/R as every implementation multiplies by it.
    pub(crate) fn inverse_radius(&self) -> f32 {
        1.0 / self.radius
    }

    /// Height and gradient in f64.
    #[must_use]
    pub fn sample_f64(&self, xz: DVec2) -> GroundSample {
        let radius = f64::from(self.radius);
        let height = f64::from(self.height);
        let d = (xz - self.centre) / radius;
        let rest = (1.0 - d.length_squared()).max(0.0);
        GroundSample {
            height: height * rest * rest * rest,
            gradient: d * (-6.0 * height / radius * rest * rest),
        }
    }

    /// Height at the relative radius t = r/R in [0, 1] and slope there, for bounds.
    pub(crate) fn profile(&self, t: f64) -> (f64, f64) {
        let rest = (1.0 - t * t).max(0.0);
        let height = f64::from(self.height);
        let slope = 6.0 * height.abs() / f64::from(self.radius) * t * rest * rest;
        (height * rest * rest * rest, slope)
    }
}

/// A `DVec2` as two numbers in a scene file.
mod pair {
    use bevy::math::DVec2;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(pair: &DVec2, to: S) -> Result<S::Ok, S::Error> {
        pair.to_array().serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<DVec2, D::Error> {
        <[f64; 2]>::deserialize(from).map(DVec2::from_array)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Vec2;

    #[test]
    fn gradient_is_the_derivative_and_f32_agrees() {
        let hill = Hill {
            centre: DVec2::new(1e6, -3.0),
            radius: 50.0,
            height: 20.0,
        };
        for k in 0..200 {
            let xz = hill.centre + DVec2::new(f64::from(k) * 0.3 - 30.0, f64::from(k % 17) * 3.0);
            let exact = hill.sample_f64(xz);
            let h = 1e-3;
            let slope = (hill.sample_f64(xz + DVec2::X * h).height
                - hill.sample_f64(xz - DVec2::X * h).height)
                / (2.0 * h);
            // h²/6 × third derivative (< 1) and the subtraction's 1e-12.
            assert!((slope - exact.gradient.x).abs() < 1e-6);
            let near = hill.sample(GroundPoint::new(xz));
            assert!((f64::from(near.value) - exact.height).abs() < 4e-7 * 20.0);
            assert!((near.gradient - exact.gradient.as_vec2()).length() < 2e-6);
        }
    }

    #[test]
    fn outside_is_nothing() {
        let hill = Hill {
            centre: DVec2::ZERO,
            radius: 5.0,
            height: 2.0,
        };
        assert_eq!(
            hill.sample_f64(DVec2::new(5.0, 0.1)),
            GroundSample::default()
        );
        assert_eq!(
            hill.sample(GroundPoint::new(DVec2::new(1e8, 0.0))).gradient,
            Vec2::ZERO
        );
    }

    #[test]
    fn bad_settings_are_named() {
        let good = Hill {
            centre: DVec2::ZERO,
            radius: 5.0,
            height: 2.0,
        };
        for (field, hill) in [
            (
                "centre",
                Hill {
                    centre: DVec2::NAN,
                    ..good
                },
            ),
            (
                "radius",
                Hill {
                    radius: 0.0,
                    ..good
                },
            ),
            (
                "height",
                Hill {
                    height: f32::INFINITY,
                    ..good
                },
            ),
        ] {
            assert_eq!(hill.validate().map_err(|error| error.field), Err(field));
        }
    }
}
