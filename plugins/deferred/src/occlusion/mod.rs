//! Ambient occlusion in screen space: how much of the light from everywhere reaches each pixel.
//!
//! | part | what it does |
//! |---|---|
//! | [`AmbientOcclusion`] | the component on a camera |
//! | [`Settings`] | the numbers of it that the passes take |
//! | [`mod@reference`] | the passes on the CPU |

pub mod reference;

use bevy::prelude::*;

/// Darkens what a camera with [`DeferredLighting`](crate::DeferredLighting) sees where objects near by block the light
/// from everywhere: ambient light, environment maps and irradiance volumes; never that of lamps and suns.
///
/// Lengths are metres of the world: scaled with its `radius` and `thickness`, a scene looks the same. Bevy's own
/// `ScreenSpaceAmbientOcclusion` works beside it; a pixel takes the darker of both.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct AmbientOcclusion {
    /// What is farther away blocks nothing, metres, above 0. Other values and those that are no number: no pass.
    pub radius: f32,
    /// How far things reach behind what is seen of them, metres, above 0: about as thick as most of a scene are. Too thin,
    /// and light gets through behind them; too thick, and what is before a wall darkens it. Values that make no sense are
    /// taken for the radius.
    pub thickness: f32,
    /// How much is looked at.
    pub quality: OcclusionQuality,
    /// How many pixels it is found for.
    pub resolution: OcclusionResolution,
}

impl Default for AmbientOcclusion {
    fn default() -> Self {
        Self {
            radius: 0.5,
            thickness: THICKNESS,
            quality: OcclusionQuality::default(),
            resolution: OcclusionResolution::default(),
        }
    }
}

/// How much is looked at: slices of directions a pixel, and steps on each of a slice's two sides. 4 × 4 pixels, over which
/// a filter takes the mean, each look elsewhere. The error of each is in docs/measured/light.md.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq, Hash)]
pub enum OcclusionQuality {
    /// 1 slice of 2 × 3 pixels.
    Low,
    /// 2 slices of 2 × 3 pixels.
    #[default]
    Medium,
    /// 3 slices of 2 × 6 pixels.
    High,
    /// 6 slices of 2 × 12 pixels.
    Ultra,
}

/// For how many pixels occlusion is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq, Hash)]
pub enum OcclusionResolution {
    /// For each.
    #[default]
    Full,
    /// For one of 2 × 2; the filter spreads it over pixels of the same plane.
    Half,
}

/// How it is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What is farther away blocks nothing, metres.
    pub radius: f32,
    /// Half-turns of directions a pixel.
    pub slices: u32,
    /// Pixels that are looked at on each side of a slice.
    pub steps: u32,
    /// How far a surface reaches behind what is seen of it, metres.
    pub thickness: f32,
    /// How far from a pixel is looked at most, in pixels.
    pub most_pixels: f32,
}

/// How thick what is seen counts, metres. Over two scenes of bodies of some 0.2 to 2 m, and radii of 0.25 to 2 m, it was that of
/// the least error at each radius but the smallest, where twice the radius was.
const THICKNESS: f32 = 1.0;

/// Beyond so many pixels steps lie so far apart that they find little: near the camera the radius shrinks.
const MOST_PIXELS: f32 = 256.0;

/// More metres than any scene has, and few enough that their squares are numbers.
const MOST_METRES: f32 = 1e15;

impl AmbientOcclusion {
    /// What the passes take; `None` where there is nothing to find.
    #[must_use]
    pub fn settings(&self) -> Option<Settings> {
        if self.radius.is_nan() || self.radius <= 0.0 {
            return None;
        }
        let radius = self.radius.clamp(1e-15, MOST_METRES);
        let (slices, steps) = match self.quality {
            OcclusionQuality::Low => (1, 3),
            OcclusionQuality::Medium => (2, 3),
            OcclusionQuality::High => (3, 6),
            OcclusionQuality::Ultra => (6, 12),
        };
        Some(Settings {
            radius,
            slices,
            steps,
            thickness: if self.thickness > 0.0 {
                self.thickness.min(MOST_METRES)
            } else {
                radius
            },
            most_pixels: MOST_PIXELS,
        })
    }
}
