//! The usual five layers, from six numbers.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Band, GroundLayer, GroundMaterial, Measure, Surface};

/// Where sand, grass, rock, snow and scree lie: the short way to a [`GroundMaterial`].
///
/// Heights are world metres, slopes are rise over run. The layers of the texture arrays are 0 sand, 1 grass,
/// 2 rock, 3 snow, 4 scree.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default)]
#[serde(deny_unknown_fields, default)]
pub struct MaterialBands {
    /// Sand reaches this height above the sea level, metres. Default 4.
    pub sand_top: f32,
    /// Grass gives way to scree around this height. Default 700.
    pub tree_line: f32,
    /// Snow lies above this height where it is not too steep. Default 1250.
    pub snow_line: f32,
    /// Width of the transitions at the tree and snow lines, metres. Default 160.
    pub blend: f32,
    /// Slope at which grass gives way to bare rock. Default 0.75.
    pub rock_slope: f32,
    /// Slope at which snow no longer holds. Default 1.1.
    pub snow_slope: f32,
}

impl Default for MaterialBands {
    fn default() -> Self {
        Self {
            sand_top: 4.0,
            tree_line: 700.0,
            snow_line: 1250.0,
            blend: 160.0,
            rock_slope: 0.75,
            snow_slope: 1.1,
        }
    }
}

impl From<MaterialBands> for GroundMaterial {
    fn from(of: MaterialBands) -> Self {
        use Measure::{AboveSea, Height, Slope};
        let blend = of.blend.max(0.01);
        let layer = |name, texture| GroundLayer::new(name, Surface::Texture(texture));
        // Snow lies lower in hollows of the noise and slides off steep ground.
        let snow = layer("snow", 3)
            .within(
                Band::new(Height, of.snow_line - blend, of.snow_line + blend)
                    .rough(blend * 1.6, blend * 0.5),
            )
            .within(below(Slope, of.snow_slope * 1.15, of.snow_slope * 0.7).rough(0.0, 0.25));
        let rock = GroundLayer {
            cliff: true,
            ..layer("rock", 2)
        }
        .within(Band::new(Slope, of.rock_slope * 0.8, of.rock_slope * 1.25).rough(0.3, 0.15));
        let sand = layer("sand", 0).within(Band {
            steep: 40.0,
            ..below(AboveSea, of.sand_top * 1.5, of.sand_top * 0.5).rough(0.0, 3.0)
        });
        // Earth shows through the grass where it is steeper and in patches.
        let grass = layer("grass", 1)
            .within(
                Band::new(Height, of.tree_line + blend, of.tree_line - blend)
                    .rough(blend * 1.4, blend),
            )
            .within(below(Slope, of.rock_slope * 0.9, of.rock_slope * 0.45).rough(0.35, 0.3));
        Self {
            layers: vec![snow, rock, sand, grass, layer("scree", 4)],
        }
    }
}

/// A band that lies below its edge whatever the numbers are: a multiple of 0 is 0, and of a negative number the
/// other way round, while [`Band`] reads its direction from which of the two is greater.
fn below(of: Measure, a: f32, b: f32) -> Band {
    const LEAST: f32 = 1e-3;
    let full = a.min(b);
    Band::new(of, a.max(b).max(full + LEAST), full)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sand_snow_and_grass_lie_below_their_edges_for_any_number() {
        for number in [0.0, -3.0, 1e-6, 4.0] {
            let material = GroundMaterial::from(MaterialBands {
                sand_top: number,
                rock_slope: number,
                snow_slope: number,
                ..MaterialBands::default()
            });
            let band = |layer: &str, of: Measure| {
                let layer = material.layers.iter().find(|found| found.name == layer);
                let bands = &layer.expect("one of the five").bands;
                *bands.iter().find(|band| band.of == of).expect("it has one")
            };
            for (layer, of) in [
                ("sand", Measure::AboveSea),
                ("snow", Measure::Slope),
                ("grass", Measure::Slope),
            ] {
                let band = band(layer, of);
                assert!(band.from > band.to, "{layer} with {number}: {band:?}");
            }
        }
    }
}
