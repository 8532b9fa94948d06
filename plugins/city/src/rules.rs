//! The rule file: what a city is made by. RON; a field that is left out has its default, one that is unknown is
//! refused. `assets/city.ron` of this crate names them all.
//!
//! Lengths are metres, light is in lumens.

use std::path::Path;

use bevy::reflect::prelude::*;
use serde::{Deserialize, Serialize};

use crate::rules_error::{RulesError, line_of};

/// Most blocks of a city that ends: 32 768 squared. An endless one has no limit but that of its cells' numbers.
pub const MAX_BLOCKS: u64 = 1 << 30;

/// What a city is made by; the same rules make the same city everywhere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Reflect)]
#[reflect(Default, Clone, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct CityRules {
    /// Seed of all random choices.
    pub seed: u32,
    /// Blocks east and south, around the origin; `None`: endless.
    pub blocks: Option<(u32, u32)>,
    /// From the middle of one street to that of the next, 16 to 512.
    pub pitch: f32,
    /// Width of a street from kerb to kerb, 2 to half of the pitch.
    pub street: f32,
    /// Which lines of the grid are streets.
    pub streets: Streets,
    /// Lots along each side of a block: 1 or 2.
    pub lots: u32,
    /// Side of a building, 2 to what a lot has room for.
    pub footprint: f32,
    /// Share of lots with a building, 0 to 1.
    pub built: f32,
    /// Height of a storey, 2 to 10.
    pub storey: f32,
    /// Least and greatest number of storeys, whole, 1 to 64.
    pub storeys: (f32, f32),
    /// Roofs.
    pub roof: RoofRules,
    /// Hedges.
    pub hedge: HedgeRules,
    /// Lamps.
    pub lamp: LampRules,
    /// Windows.
    pub window: WindowRules,
    /// Displacement.
    pub relief: ReliefRules,
}

/// Which lines of the grid are streets; the others are grass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Streets {
    /// Every line.
    #[default]
    Grid,
    /// The two through the origin.
    Cross,
}

/// Roofs are truncated pyramids.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Reflect)]
#[reflect(Default, Clone, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct RoofRules {
    /// From eaves to top, 0.1 to 20.
    pub height: f32,
    /// How far the upper base stands back on each side, 0.1 to 0.45 of the footprint.
    pub inset: f32,
}

/// Hedges along the sides of a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Reflect)]
#[reflect(Default, Clone, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct HedgeRules {
    /// Share of sides with a hedge, 0 to 1.
    pub share: f32,
    /// Least and greatest width, 0.6 to 4.
    pub width: (f32, f32),
    /// Least and greatest height, 0.6 to 4.
    pub height: (f32, f32),
}

/// Lamps along the kerbs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Reflect)]
#[reflect(Default, Clone, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct LampRules {
    /// Along a kerb, 4 to 1000 and at least the width of a street.
    pub spacing: f32,
    /// Height of the post, 1 to 20.
    pub height: f32,
    /// Between the post and the end that carries the light, 0.2 to 4.
    pub reach: f32,
    /// Length of the end that hangs down, as a share of the height, 0.01 to 0.9.
    pub drop: f32,
    /// Radius of the tube, 0.005 to 0.5.
    pub radius: f32,
    /// Least and greatest radius of a globe, 0.02 to 1.
    pub globe: (f32, f32),
    /// Luminous flux, 0 to 10⁷ lm.
    pub lumens: f32,
}

/// Windows of the walls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Reflect)]
#[reflect(Default, Clone, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct WindowRules {
    /// From one window to the next, 1 to 10.
    pub spacing: f32,
    /// Share of windows that are lit at the busiest hour, 0 to 1.
    pub lit: f32,
}

/// Displacement along the normals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Reflect)]
#[reflect(Default, Clone, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct ReliefRules {
    /// Over which length displacement fades to nothing towards a border, 0.02 to 0.25.
    pub band: f32,
    /// Longest side of a patch, 1 to 16.
    pub patch: f32,
    /// Greatest displacement, 0 to 0.2, of roads.
    pub asphalt: f32,
    /// Of crossings.
    pub cobbles: f32,
    /// Of lawns.
    pub grass: f32,
    /// Of walls of brick.
    pub bricks: f32,
    /// Of plastered walls.
    pub plaster: f32,
    /// Of roofs.
    pub tiles: f32,
    /// Of hedges.
    pub leaves: f32,
}

impl Default for CityRules {
    /// Streets every 32 m, four houses a block.
    fn default() -> Self {
        Self {
            seed: 1,
            blocks: None,
            pitch: 32.0,
            street: 8.0,
            streets: Streets::Grid,
            lots: 2,
            footprint: 8.0,
            built: 0.9,
            storey: 3.0,
            storeys: (2.0, 6.0),
            roof: RoofRules::default(),
            hedge: HedgeRules::default(),
            lamp: LampRules::default(),
            window: WindowRules::default(),
            relief: ReliefRules::default(),
        }
    }
}

impl Default for RoofRules {
    fn default() -> Self {
        Self {
            height: 2.2,
            inset: 0.28,
        }
    }
}

impl Default for HedgeRules {
    fn default() -> Self {
        Self {
            share: 0.7,
            width: (0.7, 1.0),
            height: (0.8, 1.4),
        }
    }
}

impl Default for LampRules {
    /// The proportions of the literature's lamp (1.3 high, 0.3 wide, the short leg 0.15 of the height) at 4 m.
    fn default() -> Self {
        Self {
            spacing: 30.0,
            height: 4.0,
            reach: 0.92,
            drop: 0.15,
            radius: 0.05,
            globe: (0.14, 0.2),
            lumens: 9000.0,
        }
    }
}

impl Default for WindowRules {
    fn default() -> Self {
        Self {
            spacing: 2.0,
            lit: 0.6,
        }
    }
}

impl Default for ReliefRules {
    fn default() -> Self {
        Self {
            band: 0.2,
            patch: 4.0,
            asphalt: 0.008,
            cobbles: 0.04,
            grass: 0.03,
            bricks: 0.025,
            plaster: 0.01,
            tiles: 0.05,
            leaves: 0.06,
        }
    }
}

impl CityRules {
    /// Reads a rule file.
    ///
    /// # Errors
    /// [`RulesError`], which names the file, the line and the field.
    pub fn read(path: &Path) -> Result<Self, RulesError> {
        let text = std::fs::read_to_string(path).map_err(|reason| RulesError::Read {
            file: path.to_owned(),
            reason,
        })?;
        Self::parse(&text, path)
    }

    /// Reads the text of a rule file; `file` is named in errors.
    ///
    /// # Errors
    /// [`RulesError`].
    pub fn parse(text: &str, file: &Path) -> Result<Self, RulesError> {
        let options = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        let rules: Self = options.from_str(text).map_err(|error| RulesError::Parse {
            file: file.to_owned(),
            line: error.span.start.line,
            column: error.span.start.col,
            reason: error.code.to_string(),
        })?;
        rules.checked().map_err(|error| match error {
            RulesError::Field {
                field,
                value,
                allowed,
                ..
            } => RulesError::Field {
                file: Some(file.to_owned()),
                line: line_of(text, field),
                field,
                value,
                allowed,
            },
            other => other,
        })
    }

    /// The same rules, if every number is one that a city can be made by.
    ///
    /// # Errors
    /// [`RulesError::Field`] for the first that is not.
    pub fn checked(self) -> Result<Self, RulesError> {
        let wrong = |field: &'static str, value: String, allowed: String| RulesError::Field {
            file: None,
            line: None,
            field,
            value,
            allowed,
        };
        let within = |field, value: f32, least: f32, most: f32| {
            if value >= least && value <= most {
                Ok(())
            } else {
                Err(wrong(
                    field,
                    value.to_string(),
                    format!("{least} to {most}"),
                ))
            }
        };
        let pair = |field, (low, high): (f32, f32), least: f32, most: f32| {
            within(field, low, least, most)?;
            within(field, high, low, most)
        };
        within("pitch", self.pitch, 16.0, 512.0)?;
        within("street", self.street, 2.0, 0.5 * self.pitch)?;
        if let Some((east, south)) = self.blocks {
            let blocks = u64::from(east) * u64::from(south);
            if blocks == 0 || blocks >= MAX_BLOCKS {
                let allowed = format!("1 to {} in all", MAX_BLOCKS - 1);
                return Err(wrong("blocks", format!("{east} by {south}"), allowed));
            }
            // Cells are counted by i32 and placed by f64; this keeps both far from their ends.
            within("blocks", east.max(south) as f32, 1.0, 1e6)?;
        }
        if !(1..=2).contains(&self.lots) {
            return Err(wrong("lots", self.lots.to_string(), "1 or 2".to_owned()));
        }
        within("hedge.share", self.hedge.share, 0.0, 1.0)?;
        pair("hedge.width", self.hedge.width, 0.6, 4.0)?;
        pair("hedge.height", self.hedge.height, 0.6, 4.0)?;
        let room = self.lot() - 0.5;
        within("footprint", self.footprint, 2.0, room)?;
        within("built", self.built, 0.0, 1.0)?;
        within("storey", self.storey, 2.0, 10.0)?;
        pair("storeys", self.storeys, 1.0, 64.0)?;
        for storeys in [self.storeys.0, self.storeys.1] {
            if storeys.fract() != 0.0 {
                return Err(wrong(
                    "storeys",
                    storeys.to_string(),
                    "whole numbers".to_owned(),
                ));
            }
        }
        within("roof.height", self.roof.height, 0.1, 20.0)?;
        within("roof.inset", self.roof.inset, 0.1, 0.45)?;
        within(
            "lamp.spacing",
            self.lamp.spacing,
            self.street.max(4.0),
            1000.0,
        )?;
        within("lamp.height", self.lamp.height, 1.0, 20.0)?;
        within("lamp.reach", self.lamp.reach, 0.2, 4.0)?;
        within("lamp.drop", self.lamp.drop, 0.01, 0.9)?;
        within("lamp.radius", self.lamp.radius, 0.005, 0.5)?;
        pair("lamp.globe", self.lamp.globe, 0.02, 1.0)?;
        within("lamp.lumens", self.lamp.lumens, 0.0, 1e7)?;
        within("window.spacing", self.window.spacing, 1.0, 10.0)?;
        within("window.lit", self.window.lit, 0.0, 1.0)?;
        let relief = &self.relief;
        within("relief.band", relief.band, 0.02, 0.25)?;
        within("relief.patch", relief.patch, 1.0, 16.0)?;
        for (field, value) in [
            ("relief.asphalt", relief.asphalt),
            ("relief.cobbles", relief.cobbles),
            ("relief.grass", relief.grass),
            ("relief.bricks", relief.bricks),
            ("relief.plaster", relief.plaster),
            ("relief.tiles", relief.tiles),
            ("relief.leaves", relief.leaves),
        ] {
            within(field, value, 0.0, 0.2)?;
        }
        Ok(self)
    }

    /// Side of a block from kerb to kerb, metres.
    #[must_use]
    pub fn block_side(&self) -> f32 {
        self.pitch - self.street
    }

    /// From the kerb to the lots: a path of 1 m, the widest hedge, and half a metre.
    #[must_use]
    pub fn verge(&self) -> f32 {
        1.5 + self.hedge.width.1
    }

    /// Side of a lot, metres.
    #[must_use]
    pub fn lot(&self) -> f32 {
        (self.block_side() - 2.0 * self.verge()) / self.lots as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> (String, RulesError) {
        let error = CityRules::parse(text, Path::new("old town.ron")).expect_err(text);
        (error.to_string(), error)
    }

    #[test]
    fn nothing_is_the_default_and_a_whole_file_comes_back() {
        let file = Path::new("x.ron");
        assert_eq!(
            CityRules::parse("()", file).expect("all defaults"),
            CityRules::default()
        );
        let text = ron::ser::to_string_pretty(&CityRules::default(), Default::default());
        let again = CityRules::parse(&text.expect("plain data"), file).expect("its own text");
        assert_eq!(again, CityRules::default());
    }

    #[test]
    fn the_annotated_file_is_the_default() {
        let text = include_str!("../assets/city.ron");
        let rules = CityRules::parse(text, Path::new("city.ron")).expect("the crate's own");
        assert_eq!(rules, CityRules::default());
    }

    #[test]
    fn what_is_wrong_is_named_with_file_line_and_field() {
        for (text, words) in [
            ("(\n  pitch: 0.0,\n)", ["line 2", "pitch", "is 0"]),
            (
                "(\n\n  storeys: (NaN, 4.0))",
                ["line 3", "storeys", "is NaN"],
            ),
            ("(storeys: (2.5, 4.0))", ["line 1", "storeys", "whole"]),
            ("(storeys: (5.0, 4.0))", ["line 1", "storeys", "5 to 64"]),
            ("(\n colour: 3)", ["line 2", "colour", "field"]),
            ("(roof: (\n colour: 3))", ["line 2", "colour", "field"]),
            (
                "(blocks: (40000, 40000))",
                ["line 1", "blocks", "40000 by 40000"],
            ),
            ("(blocks: (1000000000, 1))", ["line 1", "blocks", "1000000"]),
            ("(blocks: (0, 7))", ["line 1", "blocks", "0 by 7"]),
            ("(lots: 9)", ["line 1", "lots", "1 or 2"]),
            ("(footprint: 30.0)", ["line 1", "footprint", "is 30"]),
            (
                "(pitch: 40.0,\n lamp: (\n  spacing: inf))",
                ["line 3", "lamp.spacing", "inf"],
            ),
        ] {
            let (message, _) = refused(text);
            for word in words.iter().chain(&["old town.ron"]) {
                assert!(message.contains(word), "{text}: {message} lacks {word}");
            }
        }
        assert!(CityRules::parse("(pitch: 40.0)", Path::new("x.ron")).is_ok());
    }

    #[test]
    fn a_file_that_is_not_there_is_named() {
        let error = CityRules::read(Path::new("/no/such/town.ron")).expect_err("nothing there");
        assert!(error.to_string().contains("/no/such/town.ron"), "{error}");
    }
}
