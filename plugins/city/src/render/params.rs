//! What the shaders of a city read, as `CityParams` of `city/types.wgsl` has it.

use bevy::math::{UVec4, Vec4};
use bevy::render::render_resource::ShaderType;

use crate::components::{City, CityView};
use crate::levels::{CityDetail, Classic, ErrorBound};
use crate::map::{DisplacementMap, TEXELS_PER_METRE};
use crate::rules::{CityRules, Streets};
use crate::surface::Surface;
use crate::windows::lit_limit;

/// Luminance of a lit window, cd/m²: some 90 lux on a wall behind it that reflects half.
const WINDOW: f32 = 14.0;

/// The uniform of all kinds of a city.
#[derive(ShaderType, Clone, Copy, Debug, Default, PartialEq)]
pub struct CityParams {
    /// Tolerance, band, texels a metre, texels along a map.
    pub relief: Vec4,
    /// Greatest displacement, greatest bend, half of a patch's side, how levels are chosen.
    pub bound: Vec4,
    /// Bend of each surface.
    pub bend: [Vec4; 2],
    /// Displacement of each surface.
    pub heights: [Vec4; 2],
    /// Greatest and least level by distance, where ground ends, height of the ground.
    pub ground: Vec4,
    /// Distances of walls and of roofs.
    pub faces: Vec4,
    /// Pitch, street, storey, windows.
    pub plan: Vec4,
    /// Luminance of windows, illuminance of far lamps, distances.
    pub night: Vec4,
    /// Colour, luminance of globes.
    pub lamps: Vec4,
    /// Reach, drop, radius of posts; side of a building.
    pub post: Vec4,
    /// Seed, limit of windows, hour, whether two lines alone are streets.
    pub place: UVec4,
}

/// Two rows of four.
fn rows(values: [f32; 8]) -> [Vec4; 2] {
    [
        Vec4::from_slice(&values[..4]),
        Vec4::from_slice(&values[4..]),
    ]
}

/// Illuminance that the lamps give the ground on average, lux, where every line is a street: half of their flux
/// falls on it.
pub(crate) fn mean_illuminance(rules: &CityRules) -> f32 {
    let lamps = 4.0 * rules.pitch / rules.lamp.spacing;
    0.5 * lamps * rules.lamp.lumens / (rules.pitch * rules.pitch)
}

/// Mean colour of lamps.
pub(crate) fn lamp_colour() -> [f32; 3] {
    let [a, b] = crate::lamp::COLOURS;
    [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]))
}

impl CityParams {
    /// Of a city with these (checked) rules; `exposure` is what the camera multiplies luminances by, `ground` the
    /// height of the city's ground.
    #[must_use]
    pub fn new(
        city: &City,
        rules: &CityRules,
        maps: &[DisplacementMap],
        view: &CityView,
        exposure: f32,
        ground: f32,
    ) -> Self {
        let tolerance = match city.detail {
            CityDetail::ErrorBound(pixels) if pixels.is_finite() => pixels.clamp(0.05, 1000.0),
            _ => 1.0,
        };
        let bound = ErrorBound::new(rules, maps, tolerance);
        let (mode, classic) = match city.detail {
            CityDetail::ErrorBound(_) => (0.0, Classic::default()),
            CityDetail::Static(level) => (level.clamp(1.0, 64.0), Classic::default()),
            CityDetail::Classic(classic) => (-1.0, classic),
        };
        let mut heights = [0.0; 8];
        for surface in Surface::ALL {
            heights[surface as usize] = surface.amplitude(rules);
        }
        let lit = if city.lamps.is_finite() {
            city.lamps.clamp(0.0, 1.0)
        } else {
            0.0
        };
        let [r, g, b] = lamp_colour();
        let globe = 0.5 * (rules.lamp.globe.0 + rules.lamp.globe.1);
        // A ball of luminance L gives 4 π² r² L.
        let shine = rules.lamp.lumens
            / (4.0 * core::f32::consts::PI * core::f32::consts::PI * globe * globe);
        Self {
            relief: Vec4::new(
                tolerance,
                rules.relief.band,
                TEXELS_PER_METRE,
                maps[0].side() as f32,
            ),
            bound: Vec4::new(bound.amplitude, bound.border_bend, bound.slack, mode),
            bend: rows(bound.bend),
            heights: rows(heights),
            ground: Vec4::new(classic.levels.0, classic.levels.1, classic.ground, ground),
            faces: Vec4::new(
                classic.walls.0,
                classic.walls.1,
                classic.roofs.0,
                classic.roofs.1,
            ),
            plan: Vec4::new(
                rules.pitch,
                rules.street,
                rules.storey,
                rules.window.spacing,
            ),
            night: Vec4::new(
                WINDOW * lit * exposure,
                mean_illuminance(rules) * lit * exposure,
                super::lights::FADE * view.lights,
                view.lights.max(1.0),
            ),
            lamps: Vec4::new(r, g, b, shine * lit * exposure),
            post: Vec4::new(
                rules.lamp.reach,
                rules.lamp.drop,
                rules.lamp.radius,
                rules.footprint,
            ),
            place: UVec4::new(
                rules.seed,
                if lit > 0.0 {
                    lit_limit(rules, city.hour)
                } else {
                    0
                },
                city.hour.rem_euclid(24.0) as u32,
                u32::from(rules.streets == Streets::Cross),
            ),
        }
    }
}
