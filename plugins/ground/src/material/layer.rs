//! Layers, and the bands in which they lie.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::MaterialBands;

/// What a terrain is made of; goes on the entity that carries the [`Terrain`](dolomite_terrain::Terrain).
///
/// The default is [`MaterialBands::default`]: sand, grass, rock, snow and scree, in textures that come with
/// the crate. A layer costs a few comparisons; what a pixel reads of its textures is as
/// [`GroundShading`](crate::GroundShading) says, however many layers there are.
#[derive(Component, Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Component, Default)]
#[cfg_attr(
    feature = "render",
    require(crate::GroundTextures, crate::GroundShading, Visibility)
)]
#[serde(deny_unknown_fields)]
pub struct GroundMaterial {
    /// From the uppermost to the lowest: each one hides what lies below it where it lies, and the last one
    /// takes what is left, whatever its bands. At most [`Self::MOST_LAYERS`] with [`Self::MOST_BANDS`] bands
    /// in all; what is beyond is not drawn, and a warning says so.
    pub layers: Vec<GroundLayer>,
}

impl GroundMaterial {
    /// Layers that are drawn at most.
    pub const MOST_LAYERS: usize = 32;
    /// Bands of all layers together that count at most.
    pub const MOST_BANDS: usize = 64;
    /// Different [`GroundLayer::tile`] sizes at most; layers of other sizes take the nearest of these.
    pub const MOST_TILES: usize = 3;

    /// The layer that is seen at a height and on a slope, `above_sea` metres above the sea: the uppermost that covers half
    /// of the ground or more, else the lowest; `None` without layers.
    ///
    /// What gameplay asks: what somebody stands on. The noises at the edges of bands are left out, so within half of
    /// [`Band::wide`] and [`Band::fine`] of an edge the picture may show the neighbour.
    #[must_use]
    pub fn layer_at(
        &self,
        height: f32,
        above_sea: Option<f32>,
        slope: f32,
    ) -> Option<&GroundLayer> {
        let covers = |layer: &&GroundLayer| {
            let share = |band: &Band| band.share(height, above_sea, slope);
            layer.bands.iter().map(share).product::<f32>() >= 0.5
        };
        self.layers.iter().find(covers).or(self.layers.last())
    }
}

impl Default for GroundMaterial {
    fn default() -> Self {
        MaterialBands::default().into()
    }
}

/// One material of the ground.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundLayer {
    /// For people; it changes nothing.
    #[serde(default)]
    pub name: String,
    /// Where it lies: in all of these bands at once. Without any, everywhere.
    #[serde(default)]
    pub bands: Vec<Band>,
    /// What is seen.
    pub surface: Surface,
    /// Side of a tile of its texture on the ground, metres; 0.01 to 10 000. Default 3.
    #[serde(default = "default_tile")]
    pub tile: f32,
    /// Whether the texture is laid on from the side where the ground is steep, so that it is not drawn out.
    /// Where the one side goes over into the other, both are read.
    #[serde(default)]
    pub cliff: bool,
}

fn default_tile() -> f32 {
    3.0
}

impl GroundLayer {
    /// A layer that lies everywhere.
    #[must_use]
    pub fn new(name: impl Into<String>, surface: Surface) -> Self {
        Self {
            name: name.into(),
            bands: Vec::new(),
            surface,
            tile: default_tile(),
            cliff: false,
        }
    }

    /// The same within a band, too.
    #[must_use]
    pub fn within(mut self, band: Band) -> Self {
        self.bands.push(band);
        self
    }
}

/// What a layer shows.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Surface {
    /// A layer of the terrain's texture arrays, counted from 0.
    Texture(u32),
    /// One colour, without a texture.
    Flat {
        /// Linear red, green and blue, 0 to 1: the albedo.
        colour: [f32; 3],
        /// Perceptual roughness, 0.089 to 1.
        roughness: f32,
    },
}

/// What a band measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect, Serialize, Deserialize)]
pub enum Measure {
    /// Height above y = 0, metres.
    Height,
    /// Height above the sea, metres; without a sea, above every band.
    AboveSea,
    /// Slope, rise over run.
    Slope,
}

/// Where a layer lies, by one measure: not at all before `from`, fully beyond `to`, by a smooth step between
/// them. With `from` above `to` it lies below them.
///
/// Edges follow two noises, so that they never show as contour lines: a wide one, of some 170 and 50 m, and a
/// fine one, of some 11 and 3 m. Both reach from −½ to ½.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// What is measured.
    pub of: Measure,
    /// Where the layer begins.
    pub from: f32,
    /// From where on nothing else is seen.
    pub to: f32,
    /// How far the wide noise moves the edge, in the band's own unit, for a noise of 1.
    #[serde(default)]
    pub wide: f32,
    /// How far the fine noise moves it.
    #[serde(default)]
    pub fine: f32,
    /// What is added to the measure for each unit of slope beyond [`Band::STEEP`], in the band's own unit:
    /// sand lies higher on flat ground.
    #[serde(default)]
    pub steep: f32,
}

impl Band {
    /// Slope from which [`Band::steep`] counts, as in `layers.wgsl`.
    pub const STEEP: f32 = 0.35;

    /// From `from` to `to`, without noise.
    #[must_use]
    pub const fn new(of: Measure, from: f32, to: f32) -> Self {
        Self {
            of,
            from,
            to,
            wide: 0.0,
            fine: 0.0,
            steep: 0.0,
        }
    }

    /// The share of the ground that lies within the band, 0 to 1, without its noises: a smooth step as in `layers.wgsl`.
    #[must_use]
    pub fn share(&self, height: f32, above_sea: Option<f32>, slope: f32) -> f32 {
        let measure = match self.of {
            Measure::Height => height,
            Measure::AboveSea => above_sea.unwrap_or(f32::INFINITY),
            Measure::Slope => slope,
        };
        let at = measure + self.steep * (slope - Self::STEEP).max(0.0);
        let (low, high) = (self.from.min(self.to), self.from.max(self.to));
        let part = if at <= low {
            0.0
        } else if at >= high {
            1.0
        } else {
            (at - low) / (high - low)
        };
        let step = part * part * (3.0 - 2.0 * part);
        if self.from > self.to {
            1.0 - step
        } else {
            step
        }
    }

    /// The same with edges that follow the noises.
    #[must_use]
    pub const fn rough(self, wide: f32, fine: f32) -> Self {
        Self { wide, fine, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_material_is_what_its_file_says() {
        let layer = GroundLayer {
            tile: 2.0,
            ..GroundLayer::new("moss", Surface::Texture(1))
        }
        .within(Band::new(Measure::Slope, 0.8, 0.4).rough(0.1, 0.0));
        assert_eq!(layer.bands.len(), 1);
        assert_eq!(layer.bands[0].from, 0.8);
        let material = GroundMaterial::default();
        assert_eq!(material.layers.len(), 5);
        assert!(
            material.layers[4].bands.is_empty(),
            "the last takes what is left"
        );
    }

    #[test]
    fn one_stands_on_what_is_seen_there() {
        let material = GroundMaterial::default();
        let on = |height: f32, slope: f32| {
            let layer = material.layer_at(height, Some(height), slope);
            layer.map(|layer| layer.name.as_str()).unwrap_or_default()
        };
        assert_eq!(on(1.0, 0.05), "sand");
        assert_eq!(on(200.0, 0.1), "grass");
        assert_eq!(on(200.0, 1.5), "rock");
        assert_eq!(on(1000.0, 0.3), "scree");
        assert_eq!(on(1600.0, 0.2), "snow");
        assert_eq!(on(1600.0, 2.0), "rock", "snow slides off");
        // Without a sea nothing is near it.
        assert_eq!(material.layer_at(1.0, None, 0.05).unwrap().name, "grass");
        assert!(material.layer_at(f32::NAN, None, f32::NAN).is_some());
        assert_eq!(
            GroundMaterial { layers: vec![] }.layer_at(0.0, None, 0.0),
            None
        );
        // Half way through an edge is half of it, on both sides of either direction.
        let up = Band::new(Measure::Height, 10.0, 30.0);
        let down = Band::new(Measure::Height, 30.0, 10.0);
        for (height, share) in [
            (0.0, 0.0),
            (10.0, 0.0),
            (15.0, 0.156_25),
            (20.0, 0.5),
            (30.0, 1.0),
        ] {
            assert_eq!(up.share(height, None, 0.0), share);
            assert_eq!(down.share(height, None, 0.0), 1.0 - share);
        }
        let step = Band::new(Measure::Height, 5.0, 5.0);
        assert_eq!(
            (step.share(4.0, None, 0.0), step.share(6.0, None, 0.0)),
            (0.0, 1.0)
        );
    }
}
