//! What grows on a terrain, seen from where it is too thin to be drawn.

use bevy::math::{Vec3, ops};
use bevy::prelude::*;

/// What covers the ground from afar: goes on the entity that carries the [`Terrain`](dolomite_terrain::Terrain). Whoever
/// draws plants near by tells here what they look like where they end. Without it nothing of it is computed.
///
/// Cover is that of a Boolean model: C = 1 − exp(−depth/sin θ) at an elevation θ of the view above the ground. The
/// depths of layers add up, and colours mix by depth.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct GroundCanopy {
    /// At most [`MOST_LAYERS`](Self::MOST_LAYERS); what is beyond is not drawn.
    pub layers: Vec<CanopyLayer>,
}

/// One kind of what covers the ground.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
pub struct CanopyLayer {
    /// Heights of the world between which it grows, metres, and the steepness of the edges inside: a rise of 1 over so
    /// much of a metre.
    pub height: [f32; 3],
    /// The same of slopes, rise over run.
    pub slope: [f32; 3],
    /// Distances from the camera, metres: from the first on the ground shows it, from the second on all of it. A layer whose
    /// second distance is not above 0 is none.
    pub fade: [f32; 2],
    /// Depth (the area that hides the ground, over that of the ground) and linear colour, at the sines 2^(k/2 − 8).
    pub entries: [[f32; 4]; Self::ENTRIES],
}

/// What covers the ground at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Canopy {
    /// Share of the ground that is hidden.
    pub share: f32,
    /// Mean linear colour of what hides it.
    pub colour: Vec3,
}

impl CanopyLayer {
    /// Entries: sines of 1/256 to 1, by powers of √2.
    pub const ENTRIES: usize = 17;

    /// Where among the entries a sine lies: entry, and share of the way to the next.
    #[must_use]
    pub fn entry_of(sine: f32) -> (usize, f32) {
        let sine = if sine > LEAST_SINE {
            sine.min(1.0)
        } else {
            LEAST_SINE
        };
        let place = 2.0 * ops::log2(sine) + 16.0;
        let place = place.clamp(0.0, (Self::ENTRIES - 1) as f32);
        let entry = (place as usize).min(Self::ENTRIES - 2);
        (entry, place - entry as f32)
    }

    /// How much of it the ground shows at a height and a slope, so far from the camera, 0 to 1; of numbers as in
    /// [`CanopyLayer`]'s fields. As `canopy_density` in `shaders/src/ground/canopy.wgsl`.
    #[must_use]
    pub fn density(&self, height: f32, slope: f32, distance: f32) -> f32 {
        let ramp = |x: f32, [from, to, steep]: [f32; 3]| {
            ((x - from) * steep).min((to - x) * steep).clamp(0.0, 1.0)
        };
        let [from, to] = self.fade;
        let t = ((distance - from) / (to - from).max(1e-3)).clamp(0.0, 1.0);
        ramp(height, self.height) * ramp(slope, self.slope) * (t * t * (3.0 - 2.0 * t))
    }
}

/// Below it the ground is hidden as at it: 2⁻⁸.
const LEAST_SINE: f32 = 1.0 / 256.0;

impl GroundCanopy {
    /// Layers that are drawn.
    pub const MOST_LAYERS: usize = 4;

    /// What covers the ground at a height and a slope, so far from the camera, seen at an elevation of this sine. As
    /// `canopy_at` in `canopy.wgsl`.
    #[must_use]
    pub fn at(&self, height: f32, slope: f32, distance: f32, sine: f32) -> Canopy {
        let (entry, part) = CanopyLayer::entry_of(sine);
        let mut depth = 0.0;
        let mut colour = Vec3::ZERO;
        for layer in self.layers.iter().take(Self::MOST_LAYERS) {
            let [low, high] = [layer.entries[entry], layer.entries[entry + 1]];
            let [area, r, g, b] = [0, 1, 2, 3].map(|k| low[k] + (high[k] - low[k]) * part);
            let own = area * layer.density(height, slope, distance);
            depth += own;
            colour += Vec3::new(r, g, b) * own;
        }
        Canopy {
            share: 1.0 - ops::exp(-depth / sine.max(LEAST_SINE)),
            colour: colour / depth.max(1e-9),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn canopy() -> GroundCanopy {
        let layer = |depth: f32, colour: [f32; 3]| CanopyLayer {
            height: [0.0, 100.0, 1.0],
            slope: [-1.0, 1.0, 10.0],
            fade: [50.0, 100.0],
            entries: [[depth, colour[0], colour[1], colour[2]]; CanopyLayer::ENTRIES],
        };
        GroundCanopy {
            layers: vec![layer(0.2, [1.0, 0.0, 0.0]), layer(0.6, [0.0, 1.0, 0.0])],
        }
    }

    /// Depths add up, colours mix by them, and more is hidden at a lower elevation.
    #[test]
    fn layers_add_up() {
        let seen = canopy().at(50.0, 0.0, 200.0, 0.5);
        assert!((seen.share - (1.0 - ops::exp(-1.6))).abs() < 1e-6);
        assert!(seen.colour.distance(Vec3::new(0.25, 0.75, 0.0)) < 1e-6);
        assert!(canopy().at(50.0, 0.0, 200.0, 0.1).share > 0.999);
        let low = [0.0, -1.0, 1e-9].map(|sine| canopy().at(50.0, 0.0, 200.0, sine).share);
        assert_eq!(low, [1.0; 3]);
    }

    /// Nothing near by, nothing outside of the bands.
    #[test]
    fn layers_end() {
        for (height, slope, distance) in [(50.0, 0.0, 50.0), (-1.0, 0.0, 200.0), (50.0, 1.5, 200.0)]
        {
            assert_eq!(canopy().at(height, slope, distance, 0.5), Canopy::default());
        }
        assert!(canopy().at(50.0, 0.0, 75.0, 0.9).share < canopy().at(50.0, 0.0, 100.0, 0.9).share);
    }

    #[test]
    fn entries_go_by_the_square_root_of_two() {
        assert_eq!(CanopyLayer::entry_of(1.0), (15, 1.0));
        assert_eq!(CanopyLayer::entry_of(0.5), (14, 0.0));
        assert_eq!(CanopyLayer::entry_of(0.0), (0, 0.0));
        assert_eq!(CanopyLayer::entry_of(f32::NAN), (0, 0.0));
    }
}
