//! What arrives at a point from each light.
//!
//! A point light of luminous power Φ has the intensity `I = Φ / 4π` and makes the illuminance `I / d²` on a surface that
//! faces it at distance `d` (inverse-square law). So that a light ends somewhere, Bevy takes the window of Karis, "Real
//! shading in Unreal Engine 4" (SIGGRAPH 2013 course notes, equation 9), and keeps the square from 0:
//!
//! ```text
//! E(d) = I · w(d)² / max(d², 10⁻⁴ m²),     w(d) = (1 − (d / range)⁴)⁺
//! ```
//!
//! It is exactly 0 at the range and beyond. A spot light is multiplied by the square of a ramp in the cosine `c` of the
//! angle to its axis (Lagarde and de Rousiers, "Moving Frostbite to physically based rendering", 2014, section 4.4):
//!
//! ```text
//! s(c) = ((c − cos outer) / max(cos inner − cos outer, 10⁻⁴))  cut to 0..1
//! ```
//!
//! # What is no light
//! A light with a number that is none, with an infinite or negative power, without a direction, or with a range or outer
//! angle of 0 or less gives nothing. An infinite range is no window. An outer angle of π/2 and more is π/2 − 10⁻⁴, an
//! inner one beyond the outer one is the outer one (both as Bevy has them), a negative inner one is 0. A negative
//! channel of the colour is 0. At the light's own position there is no direction, and so no light.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::scene::{Lamp, LampKind};

/// Square metres that a squared distance is at least taken for.
pub const LEAST_DISTANCE_SQUARED: f64 = 1e-4;

/// The least difference of the cosines of the two angles of a spot light.
pub const LEAST_CONE: f64 = 1e-4;

/// A light, made ready to be asked at many points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Candela a channel; lux for a directional light.
    strength: DVec3,
    /// Whether objects block it.
    pub shadows: bool,
    place: Place,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// Unit vector to the light.
    Far(DVec3),
    Near {
        position: DVec3,
        inverse_range_squared: f64,
        cone: Option<Cone>,
    },
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Cone {
    /// Unit vector, away from the light.
    axis: DVec3,
    cos_outer: f64,
    width: f64,
}

/// Light at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arriving {
    /// Unit vector to the light.
    pub direction: DVec3,
    /// Metres to it; infinite for a directional light.
    pub distance: f64,
    /// Lux a channel on a surface that faces the light.
    pub illuminance: DVec3,
}

/// `w(d)²` of the module, of the squared distance: 1 at the light, 0 at the range and beyond.
pub fn window(distance_squared: f64, inverse_range_squared: f64) -> f64 {
    let x = distance_squared * inverse_range_squared;
    let w = (1.0 - x * x).max(0.0);
    w * w
}

/// The squared ramp of a spot light, of the cosine of the angle to its axis.
pub fn spot(cos: f64, cos_outer: f64, width: f64) -> f64 {
    let s = ((cos - cos_outer) / width).clamp(0.0, 1.0);
    s * s
}

impl Source {
    /// `None` for what is no light, by the rules of the module.
    pub fn new(lamp: &Lamp) -> Option<Self> {
        let colour = lamp.colour.max(DVec3::ZERO);
        let well = lamp.colour.is_finite() && lamp.power.is_finite() && lamp.power > 0.0;
        if !well || colour == DVec3::ZERO {
            return None;
        }
        let unit = |d: DVec3| d.try_normalize();
        let ranged = |position: DVec3, range: f64| {
            (position.is_finite() && range > 0.0).then(|| (range * range).recip())
        };
        let place = match lamp.kind {
            LampKind::Directional { direction } => Place::Far(-unit(direction)?),
            LampKind::Point { position, range } => Place::Near {
                position,
                inverse_range_squared: ranged(position, range)?,
                cone: None,
            },
            LampKind::Spot {
                position,
                range,
                direction,
                inner,
                outer,
            } => {
                if !(outer > 0.0 && inner.is_finite()) {
                    return None;
                }
                let outer = if outer >= FRAC_PI_2 {
                    FRAC_PI_2 - 1e-4
                } else {
                    outer
                };
                let inner = inner.clamp(0.0, outer);
                Place::Near {
                    position,
                    inverse_range_squared: ranged(position, range)?,
                    cone: Some(Cone {
                        axis: unit(direction)?,
                        cos_outer: outer.cos(),
                        width: (inner.cos() - outer.cos()).max(LEAST_CONE),
                    }),
                }
            }
        };
        let unit_of_power = match place {
            Place::Far(_) => 1.0,
            Place::Near { .. } => 1.0 / (4.0 * PI),
        };
        Some(Self {
            strength: colour * lamp.power * unit_of_power,
            shadows: lamp.shadows,
            place,
        })
    }

    /// What arrives at `point`; `None` if it is exactly nothing.
    pub fn at(&self, point: DVec3) -> Option<Arriving> {
        match self.place {
            Place::Far(direction) => Some(Arriving {
                direction,
                distance: f64::INFINITY,
                illuminance: self.strength,
            }),
            Place::Near {
                position,
                inverse_range_squared,
                cone,
            } => {
                let to_light = position - point;
                let squared = to_light.length_squared();
                let mut factor = window(squared, inverse_range_squared);
                if factor <= 0.0 || squared == 0.0 {
                    return None;
                }
                let distance = squared.sqrt();
                let direction = to_light / distance;
                if let Some(cone) = cone {
                    factor *= spot(-direction.dot(cone.axis), cone.cos_outer, cone.width);
                    if factor <= 0.0 {
                        return None;
                    }
                }
                Some(Arriving {
                    direction,
                    distance,
                    illuminance: self.strength * (factor / squared.max(LEAST_DISTANCE_SQUARED)),
                })
            }
        }
    }
}

/// All lights that are some, in their order.
pub fn sources(lamps: &[Lamp]) -> Vec<Source> {
    lamps.iter().filter_map(Source::new).collect()
}
