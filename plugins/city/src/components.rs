//! What an app spawns: a city, and how a camera sees it.

use bevy::prelude::*;

use crate::around::Around;
use crate::levels::CityDetail;
use crate::rules::CityRules;
use crate::rules_error::RulesError;

/// A city whose cell (0, 0) begins at the entity's place; the ground is level, at its height. A turn or a scale of
/// the entity is not used.
///
/// Of several, the one of the lowest entity is drawn.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform, CityBlocks)]
pub struct City {
    /// What it is made by. Rules by which none can be made are named in [`CityBlocks::fault`]; the last good ones
    /// hold on.
    pub rules: CityRules,
    /// How finely its faces are divided.
    pub detail: CityDetail,
    /// Hour of the day, 0 to 24: which windows are lit.
    pub hour: f32,
    /// Brightness of lamps and windows, 0 to 1. At 0, as by day, there is no light and no cost of any.
    pub lamps: f32,
}

impl Default for City {
    /// The usual rules, by day.
    fn default() -> Self {
        Self {
            rules: CityRules::default(),
            detail: CityDetail::default(),
            hour: 12.0,
            lamps: 0.0,
        }
    }
}

/// On a camera that sees the city.
///
/// With the `render` feature it requires a `GeometryCamera`; the camera needs `Msaa::Off`.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform)]
#[cfg_attr(feature = "render", require(dolomite_geometry::GeometryCamera))]
pub struct CityView {
    /// How far blocks are patches, metres, 0 to 1000; rounded up to whole cells. Costs some 250 patches a block. Where
    /// displacement is smaller than the tolerance the records beyond look the same: at 0.06 m and 935 pixels a
    /// radian beyond 56 m for one pixel.
    pub near: f32,
    /// How far buildings and hedges are records, metres, up to 20 000; beyond is level ground. Costs some 150 bytes a
    /// building.
    pub far: f32,
    /// How far lamps are lights, metres, up to 2000; beyond, their light is part of the ground's.
    pub lights: f32,
    /// Most lights at once; the nearest come first.
    pub most_lights: usize,
}

impl Default for CityView {
    fn default() -> Self {
        Self {
            near: 64.0,
            far: 2000.0,
            lights: 120.0,
            most_lights: 4096,
        }
    }
}

/// The blocks of a city around the cameras that see it. Kept by the plugin.
#[derive(Component, Debug, Default)]
pub struct CityBlocks {
    /// The last rules by which a city could be made.
    pub rules: Option<CityRules>,
    /// Blocks around the camera.
    pub around: Around,
    /// Cells around that of the camera that are there along each axis.
    pub reach: u32,
    /// Place of the camera's cell.
    pub middle: [i32; 2],
    /// Whether `around` is that of `rules` and `middle`.
    pub known: bool,
    /// Why the city's rules are not used, if they are not.
    pub fault: Option<RulesError>,
}
