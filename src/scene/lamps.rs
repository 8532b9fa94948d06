//! Lamps of a scene: how many, around which place; each stands on the ground.

use bevy::math::{DVec2, DVec3, ops};
use bevy::prelude::Vec3;
use dolomite::terrain::{Ground, Terrain};
use serde::Deserialize;

/// Most lamps that can be asked for.
pub const MOST_LAMPS: u32 = 200_000;

/// Least height of the ground above the sea below a lamp, metres.
const DRY: f64 = 0.4;

/// Places that are tried for each lamp before the rest is left out: a circle may lie in the sea.
const TRIES: u32 = 8;

/// Lamps around a place, as a scene file has them. Lengths are metres.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lamps {
    /// How many, up to [`MOST_LAMPS`].
    pub count: u32,
    /// The middle of the circle that they stand in, `(x, z)`.
    pub middle: (f64, f64),
    /// Its radius.
    pub radius: f64,
    /// Height of the light above the ground.
    #[serde(default = "height")]
    pub height: f32,
    /// Where the light ends.
    #[serde(default = "range")]
    pub range: f32,
    /// Luminous flux of one.
    #[serde(default = "lumens")]
    pub lumens: f32,
    /// The same seed is the same lamps.
    #[serde(default)]
    pub seed: u32,
}

const fn height() -> f32 {
    2.6
}

const fn range() -> f32 {
    14.0
}

const fn lumens() -> f32 {
    180.0
}

/// One lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// The ground below it.
    pub foot: DVec3,
    /// From 0, candle light, to 1, a pale gas flame.
    pub pale: f32,
}

impl Lamp {
    /// Colour of a light, linear, the greatest channel 1; `pale` from 0 to 1.
    #[must_use]
    pub fn colour(pale: f32) -> Vec3 {
        Vec3::new(1.0, 0.55, 0.22).lerp(Vec3::new(1.0, 0.8, 0.6), pale)
    }
}

impl Lamps {
    /// Refuses what no lamp can have.
    ///
    /// # Errors
    /// The value and what to write.
    pub fn check(&self) -> Result<(), String> {
        if self.count > MOST_LAMPS {
            return Err(format!(
                "`lamps.count` is {}, but at most {MOST_LAMPS} can be drawn",
                self.count
            ));
        }
        if !(self.middle.0.is_finite() && self.middle.1.is_finite()) {
            return Err("`lamps.middle` holds a number that is not finite".to_owned());
        }
        for (name, value) in [
            ("radius", self.radius),
            ("height", f64::from(self.height)),
            ("range", f64::from(self.range)),
            ("lumens", f64::from(self.lumens)),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(format!("`lamps.{name}` is {value}, but must be above 0"));
            }
        }
        Ok(())
    }

    /// Where they stand: a sunflower's spiral (Vogel 1979), each off it by up to half of its distance to the next,
    /// without those in the sea or beyond the ground.
    #[must_use]
    pub fn on(&self, terrain: &Terrain) -> Vec<Lamp> {
        let extent = terrain.extent();
        let dry = terrain
            .sea_level()
            .map_or(f64::NEG_INFINITY, |sea| f64::from(sea) + DRY);
        let middle = DVec2::from(self.middle);
        let apart = self.radius * (std::f64::consts::PI / f64::from(self.count.max(1))).sqrt();
        let mut lamps = Vec::new();
        for k in 0..self.count.saturating_mul(TRIES) {
            if lamps.len() == self.count as usize {
                break;
            }
            let random = |which: u32| {
                f64::from(hash(hash(self.seed ^ hash(k)) ^ which)) / f64::from(u32::MAX)
            };
            // The golden angle, in whole turns: it keeps its digits for any number of lamps.
            let turn =
                (f64::from(k) * 0.381_966_011_250_105).fract() as f32 * std::f32::consts::TAU;
            let (sin, cos) = ops::sin_cos(turn);
            let out = self.radius * ((f64::from(k) + 0.5) / f64::from(self.count.max(1))).sqrt();
            let off = DVec2::new(random(1) - 0.5, random(2) - 0.5) * apart;
            let place = middle + DVec2::new(f64::from(sin), f64::from(cos)) * out + off;
            if place.cmplt(extent.min).any() || place.cmpgt(extent.max).any() {
                continue;
            }
            let height = terrain.height(place);
            if height < dry {
                continue;
            }
            lamps.push(Lamp {
                foot: DVec3::new(place.x, height, place.y),
                pale: random(3) as f32,
            });
        }
        lamps
    }
}

/// PCG (O'Neill 2014), its output function alone.
const fn hash(x: u32) -> u32 {
    let state = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{SceneRequest, load};
    use std::path::Path;

    const LAMPS: Lamps = Lamps {
        count: 300,
        middle: (-1280.0, 3120.0),
        radius: 200.0,
        height: height(),
        range: range(),
        lumens: lumens(),
        seed: 3,
    };

    #[test]
    fn lamps_stand_apart_on_dry_ground_and_are_the_same_again() {
        let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
        let scene = load(&SceneRequest::new("mountain"), &assets).expect("a scene");
        let lamps = LAMPS.on(&scene.terrain);
        assert_eq!(lamps, LAMPS.on(&scene.terrain));
        assert_eq!(lamps.len(), 300);
        let sea = f64::from(scene.terrain.sea_level().expect("an island"));
        for (k, lamp) in lamps.iter().enumerate() {
            assert!(lamp.foot.y > sea, "{lamp:?}");
            let nearest = lamps[..k]
                .iter()
                .map(|other| other.foot.distance(lamp.foot));
            assert!(nearest.fold(f64::MAX, f64::min) > 0.2, "{lamp:?}");
        }
        // Far out in the sea there is no place for one.
        let drowned = Lamps {
            middle: (-6000.0, -6000.0),
            radius: 20.0,
            ..LAMPS
        };
        assert_eq!(drowned.on(&scene.terrain), []);
        assert_eq!(Lamps { count: 0, ..LAMPS }.on(&scene.terrain), []);
    }

    #[test]
    fn wrong_values_are_refused_by_name() {
        assert_eq!(LAMPS.check(), Ok(()));
        for (lamps, word) in [
            (
                Lamps {
                    count: 200_001,
                    ..LAMPS
                },
                "count",
            ),
            (
                Lamps {
                    middle: (f64::NAN, 0.0),
                    ..LAMPS
                },
                "middle",
            ),
            (
                Lamps {
                    radius: 0.0,
                    ..LAMPS
                },
                "radius",
            ),
            (
                Lamps {
                    range: f32::INFINITY,
                    ..LAMPS
                },
                "range",
            ),
            (
                Lamps {
                    lumens: -1.0,
                    ..LAMPS
                },
                "lumens",
            ),
            (
                Lamps {
                    height: f32::NAN,
                    ..LAMPS
                },
                "height",
            ),
        ] {
            assert!(
                lamps.check().is_err_and(|error| error.contains(word)),
                "{word}"
            );
        }
    }
}
