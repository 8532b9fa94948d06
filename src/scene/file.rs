//! What a scene file holds: the ground as layers, its materials and its sea, sun and start.
//!
//! The format is RON; unknown fields are errors. `assets/scenes/mountain.ron` is the annotated
//! example, and the scene of that name is nothing else than that file. Lengths are metres, angles
//! degrees, ground points `(x, z)` with +x east and −z north, heights +y up.

use dolomite::ground::{GroundMaterial, MaterialBands, Sea};
use dolomite::sky::Sun;
use dolomite::terrain::{Fractal, HeightMapFile, Hill, Mask, PermutationNoise};
use serde::Deserialize;

use super::city::CityFile;
use super::lamps::Lamps;
use super::things::Thing;

/// A scene, as it stands in its file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// One line on what the scene shows.
    #[serde(default)]
    pub about: String,
    /// The ground: least and greatest corner `((x, z), (x, z))`. Left out: that of the first
    /// height map.
    #[serde(default)]
    pub extent: Option<((f64, f64), (f64, f64))>,
    /// Height below the layers. Default 0.
    #[serde(default)]
    pub base: f32,
    /// Height of the sea. Left out: no sea.
    #[serde(default)]
    pub sea_level: Option<f32>,
    /// What is added to the base, in this order. At least one.
    pub layers: Vec<LayerFile>,
    /// Fractal detail below the sample spacing of the height maps, added last; the setting
    /// `detail` replaces its amplitude.
    #[serde(default)]
    pub detail: Option<Fractal>,
    /// Where sand, grass, rock and snow lie, in the usual layers.
    #[serde(default)]
    pub bands: MaterialBands,
    /// Layers of the ground's own, in place of the usual ones.
    #[serde(default)]
    pub material: Option<GroundMaterial>,
    /// How the sea looks.
    #[serde(default)]
    pub sea: Sea,
    /// Where the sun stands.
    #[serde(default)]
    pub sun: Sun,
    /// Lamps on the ground. Left out: none.
    #[serde(default)]
    pub lamps: Option<Lamps>,
    /// A city on the ground, which has to be level there. Left out: none.
    #[serde(default)]
    pub city: Option<CityFile>,
    /// What grows: a file of kinds, relative to the folder of the scene file. Left out: nothing.
    #[serde(default)]
    pub vegetation: Option<String>,
    /// Where camera and figure start. Left out: looking over the middle from the south.
    #[serde(default)]
    pub start: Option<StartFile>,
    /// What stands and lies on the ground. Left out: nothing.
    #[serde(default)]
    pub things: Vec<Thing>,
}

/// One layer: a source, and where it counts.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayerFile {
    /// What is added.
    pub source: SourceFile,
    /// By which part, depending on the height of the layers before. Left out: fully.
    #[serde(default)]
    pub mask: Option<Mask>,
}

/// Where heights come from.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum SourceFile {
    /// A sum of octaves of gradient noise.
    Fractal(Fractal),
    /// The method of the literature: a shuffled table of 256, four gradients.
    Permutation(PermutationNoise),
    /// A smooth round hill, `height (1 − r²/radius²)³`.
    Hill(Hill),
    /// Measured heights. The path is relative to the folder of the scene file.
    Map(HeightMapFile),
}

/// Where camera and figure start.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StartFile {
    /// The camera as `(x, y, z, yaw, pitch)`: metres and degrees. Yaw 0 looks north (−z) and
    /// grows to the left; pitch grows upwards.
    pub camera: (f64, f64, f64, f32, f32),
    /// The figure as `(x, z, yaw)`; it faces along the yaw.
    pub figure: (f64, f64, f32),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::ron_options;

    fn parse(text: &str) -> Result<SceneFile, ron::error::SpannedError> {
        ron_options().from_str(text)
    }

    const HILL: &str = "(source: Hill(centre: (0.0, 0.0), radius: 100.0, height: 10.0))";

    #[test]
    fn the_least_scene_is_one_layer() {
        let scene = parse(&format!("(layers: [{HILL}])")).unwrap();
        assert_eq!(scene.layers.len(), 1);
        assert_eq!(scene.sea_level, None);
        assert_eq!(scene.bands, MaterialBands::default());
    }

    #[test]
    fn materials_are_those_of_the_plugin() {
        let scene = parse(&format!(
            "(layers: [{HILL}], sea: (steepness: 0.0), material: (layers: [
                (name: \"moss\", surface: Texture(1), tile: 2.0, bands: [
                    (of: Slope, from: 0.9, to: 0.4, wide: 0.2),
                    (of: Height, from: 0.0, to: 10.0),
                ]),
                (surface: Flat(colour: (0.2, 0.1, 0.1), roughness: 0.9), cliff: true),
            ]))"
        ))
        .unwrap();
        let material = scene.material.expect("it is written there");
        assert_eq!(material.layers.len(), 2);
        assert_eq!(material.layers[0].bands[0].wide, 0.2);
        assert!(material.layers[1].cliff && material.layers[1].bands.is_empty());
        assert_eq!(
            (scene.sea.steepness, scene.sea.deep),
            (0.0, Sea::default().deep)
        );
    }

    #[test]
    fn unknown_fields_are_refused_on_every_level() {
        for text in [
            format!("(layers: [{HILL}], colour: 3)"),
            "(layers: [(source: Hill(centre: (0.0, 0.0), radius: 1.0, height: 1.0, w: 2.0))])"
                .to_owned(),
            format!("(layers: [{HILL}], bands: (sand: 3.0))"),
            format!("(layers: [{HILL}], sea: (colour: 3.0))"),
            format!("(layers: [{HILL}], material: (layers: [(surface: Texture(1), side: 2.0)]))"),
            format!("(layers: [{HILL}], sun: (azimuth: 1.0, elevation: 2.0, colour: 3.0))"),
            "(layers: [(source: Hole(radius: 3.0))])".to_owned(),
        ] {
            assert!(parse(&text).is_err(), "{text} was accepted");
        }
        // The same text without the unknown field is accepted, so the field is what was refused.
        assert!(
            parse(&format!(
                "(layers: [{HILL}], sun: (azimuth: 1.0, elevation: 2.0))"
            ))
            .is_ok()
        );
    }
}
