//! A city of a scene: where it stands, and by which rules it is made. Its ground is level, so the terrain below has to
//! be.

use bevy::math::{DVec2, DVec3};
use dolomite::city::CityRules;
use dolomite::city::streets::extent;
use dolomite::terrain::{Ground, Terrain};
use serde::Deserialize;

/// How much higher or lower than at its origin the ground below a city may be, metres.
const LEVEL: f64 = 0.02;

/// How far above the terrain a city's ground lies, metres: more than the flat ground far from the eye is sunk.
pub const ABOVE: f64 = 0.03;

/// Distance of the places at which the ground is asked, metres.
const SPACING: f64 = 8.0;

/// A city, as it stands in the scene file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CityFile {
    /// Corner of its cell (0, 0), `(x, z)`: the middle of its blocks.
    #[serde(default)]
    pub at: (f64, f64),
    /// What it is made by; `blocks` has to say how many.
    #[serde(default)]
    pub rules: CityRules,
}

/// A city on its ground.
#[derive(Clone, Debug, PartialEq)]
pub struct CityScene {
    /// Corner of its cell (0, 0), on its ground.
    pub origin: DVec3,
    /// Rules that were checked.
    pub rules: CityRules,
}

impl CityFile {
    /// The city on a terrain.
    ///
    /// # Errors
    /// A sentence: rules by which no city can be made, one without end, ground that is not level and where.
    pub fn on(&self, terrain: &Terrain) -> Result<CityScene, String> {
        let at = DVec2::from(self.at);
        if !at.is_finite() {
            return Err(format!("`city.at` is {at}, which is no place"));
        }
        let rules = self.rules.clone().checked();
        let rules = rules.map_err(|fault| format!("`city.rules`: {fault}"))?;
        let Some((least, count)) = extent(&rules) else {
            return Err(
                "`city.rules.blocks` is None, but a city on a terrain has to end: write (24, 24)"
                    .to_owned(),
            );
        };
        let pitch = f64::from(rules.pitch);
        let low = at + DVec2::new(f64::from(least[0]), f64::from(least[1])) * pitch;
        let size = DVec2::new(f64::from(count[0]), f64::from(count[1])) * pitch;
        let ground = terrain.extent();
        if low.cmplt(ground.min).any() || (low + size).cmpgt(ground.max).any() {
            return Err(format!(
                "the city reaches from {low} to {}, beyond the ground's extent",
                low + size
            ));
        }
        let height = terrain.height(at);
        let steps = (size / SPACING).ceil().max(DVec2::ONE);
        for z in 0..=steps.y as u32 {
            for x in 0..=steps.x as u32 {
                let place = low + size * DVec2::new(f64::from(x), f64::from(z)) / steps;
                let off = terrain.height(place) - height;
                if off.abs() > LEVEL {
                    return Err(format!(
                        "the ground below the city is not level: {off:.2} m from that of its origin at {place}"
                    ));
                }
            }
        }
        Ok(CityScene {
            origin: DVec3::new(at.x, height + ABOVE, at.y),
            rules,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{SceneRequest, load};
    use std::path::Path;

    #[test]
    fn a_city_stands_on_level_ground_alone_and_what_is_wrong_is_named() {
        let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
        let scene = load(&SceneRequest::new("city"), &assets).expect("the scene is whole");
        let city = scene.city.as_ref().expect("it has one");
        assert!(city.rules.blocks.is_some());
        assert_eq!(city.origin.y, scene.terrain.height(DVec2::ZERO) + ABOVE);
        let file = |at, rules: &str| CityFile {
            at,
            rules: CityRules::parse(rules, Path::new("test")).expect("rules"),
        };
        let fault = |at, rules| file(at, rules).on(&scene.terrain).unwrap_err();
        assert!(fault((0.0, 0.0), "()").contains("blocks"));
        assert!(fault((0.0, -1700.0), "(blocks: Some((8, 8)))").contains("not level"));
        assert!(fault((0.0, 0.0), "(blocks: Some((9999, 9)))").contains("extent"));
        assert!(fault((f64::NAN, 0.0), "(blocks: Some((9, 9)))").contains("no place"));
        let mut wrong = file((0.0, 0.0), "(blocks: Some((8, 8)))");
        wrong.rules.pitch = 0.0;
        let fault = wrong.on(&scene.terrain).unwrap_err();
        assert!(
            fault.contains("city.rules") && fault.contains("pitch"),
            "{fault}"
        );
        wrong.rules.pitch = 32.0;
        assert!(wrong.on(&scene.terrain).is_ok());
    }
}
