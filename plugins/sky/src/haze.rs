//! The haze between a camera and what it sees: how thick it is, and what colour far things tend to.

use bevy::math::{Vec3, ops};

use crate::air::ground_extinction;
use crate::heavens::Heavens;
use crate::math::smooth;
use crate::twilight;

/// Share of the sun's light that haze before it takes on.
const GLOW: f32 = 0.03;

/// Haze near the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Haze {
    /// Of what is far away: the sky just above the horizon, cd/m² (red, green, blue).
    pub colour: Vec3,
    /// Added towards the light that casts shadows, cd/m².
    pub glow: Vec3,
    /// What goes of the light of a thing, and what comes from the haze in its place, 1/m.
    pub extinction: Vec3,
}

impl Haze {
    /// The haze below a sky, `thickness` times that of the air with `dust` times the dust of a clear
    /// day.
    pub fn new(heavens: &Heavens, thickness: f32, dust: f32) -> Self {
        // Five degrees up, all round.
        let around = (0..16_u8).map(|i| {
            let (sin, cos) = ops::sin_cos(f32::from(i) * std::f32::consts::TAU / 16.0);
            heavens.radiance(Vec3::new(cos, 0.087, sin).normalize())
        });
        let colour = if heavens.elevation < twilight::DUSK {
            at_twilight(around.collect(), heavens.elevation)
        } else {
            around.sum::<Vec3>() / 16.0
        };
        Self {
            colour,
            glow: heavens.key().illuminance,
            extinction: ground_extinction(dust) * thickness,
        }
    }

    /// The glow in the picture at an exposure (factor from cd/m²).
    pub fn exposed_glow(&self, exposure: f32) -> Vec3 {
        self.glow * exposure * GLOW
    }
}

/// At dusk one side of the horizon is a hundred times as bright as the other, and haze of the mean
/// would glow before the dark one: the lower the sun, the more it tends to the geometric mean.
fn at_twilight(around: Vec<Vec3>, elevation: f32) -> Vec3 {
    let count = around.len() as f32;
    let mean = around.iter().sum::<Vec3>() / count;
    let logs = around
        .iter()
        .map(|sky| Vec3::from_array(sky.to_array().map(|x| ops::ln(x.max(1e-9)))))
        .sum::<Vec3>()
        / count;
    let geometric = Vec3::from_array(logs.to_array().map(ops::exp));
    geometric.lerp(mean, smooth(-4.0, twilight::DUSK, elevation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::{Sky, Sun};

    fn haze(elevation: f32, thickness: f32) -> Haze {
        let sun = Sun {
            elevation,
            ..Sun::default()
        };
        let sky = Sky::default();
        let heavens = Heavens::new(sun.towards().expect("a place"), &sky);
        Haze::new(&heavens, thickness, sky.dust)
    }

    #[test]
    fn haze_has_the_colour_of_the_horizon_and_darkens_with_it() {
        let mut before = f32::INFINITY;
        for elevation in [60.0, 30.0, 10.0, 4.9, 0.0, -4.0, -8.0, -12.0] {
            let now = haze(elevation, 1.0).colour;
            assert!(
                now.is_finite() && now.min_element() > 0.0,
                "{elevation}: {now}"
            );
            // A high sun leaves the horizon some darker than one in the middle.
            assert!(now.y < before * 1.3, "{elevation}: {before} {now}");
            before = now.y;
        }
        let (day, night) = (haze(30.0, 1.0).colour, haze(-30.0, 1.0).colour);
        assert!((2_000.0..20_000.0).contains(&day.y), "{day}");
        assert!((1e-4..1e-2).contains(&night.y), "{night}");
    }

    #[test]
    fn dusk_begins_without_a_jump() {
        let [before, after] = [5.001, 4.999].map(|elevation| haze(elevation, 1.0).colour);
        // Two thousandths of a degree, of which one is some 2 % of the light.
        assert!(
            (before / after - Vec3::ONE).abs().max_element() < 1e-3,
            "{before} {after}"
        );
    }

    #[test]
    fn twice_as_thick_is_twice_the_extinction_and_blue_goes_first() {
        let [one, two] = [1.0, 2.0].map(|thickness| haze(30.0, thickness).extinction);
        assert_eq!(two, one * 2.0);
        assert!(one.z > one.y && one.y > one.x, "{one}");
        // What is seen from 100 km in very clear air (Koschmieder: a contrast of 2 % is left after
        // 3.9 over the extinction).
        assert!((1e5..4e5).contains(&(3.9 / one.y)), "{one}");
    }
}
