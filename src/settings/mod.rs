//! What the player may set, from a RON file; what they chose in the menu ([`choices`]); what pictures are drawn with
//! ([`quality`]); where files lie ([`paths`]).

pub mod choices;
pub mod paths;
pub mod quality;

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use dolomite::ground::GroundShading;
use dolomite::ground::detail::settings::LEAST_PIXELS;
use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer, Serialize};
use thiserror::Error;

use quality::{AntiAliasing, MOST_CASCADES, Occlusion, Preset, RESOLUTION_RANGE, SHADOW_MAP_RANGE};

/// The default settings as a file, with a comment on each; `dolomite settings` prints it.
pub const DEFAULT_SETTINGS: &str = include_str!("default.ron");

/// Largest side of a window or picture, in pixels: what every Vulkan 1.3 device of the desktop
/// profile can hold in one texture is 8192, and most hold 16384.
pub const MAX_SIDE: u32 = 16_384;

/// Narrowest and widest vertical field of view, degrees.
pub const FOV_RANGE: (f32, f32) = (4.0, 100.0);

/// The settings of the player. Every field may be left out of the file.
#[derive(Resource, Reflect, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Resource, Default, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Window width and height, pixels, 1 to [`MAX_SIDE`].
    pub window: (u32, u32),
    /// Waits for the display between frames.
    pub vsync: bool,
    /// Vertical field of view, degrees, in [`FOV_RANGE`]. The wheel changes it while playing.
    pub fov: f32,
    /// Degrees that the view turns for one pixel of mouse movement; above 0, at most 10.
    pub mouse_sensitivity: f32,
    /// Moving the mouse forward looks down.
    pub invert_y: bool,
    /// Speed of the free camera, metres a second; above 0, at most 10 000.
    pub fly_speed: f32,
    /// Speed of the walking figure along the ground, metres a second; above 0, at most 100.
    pub walk_speed: f32,
    /// The same while Ctrl is held.
    pub run_speed: f32,
    /// The speed of the camera is multiplied by this while Ctrl is held; 1 to 1000.
    pub fast_factor: f32,
    /// Wanted length of a triangle edge on the screen, pixels; 1 to 256.
    pub pixels_per_edge: f32,
    /// Side of the smallest patch, metres; 1 to 4096.
    pub finest_patch: f32,
    /// How far the drawn ground may be from the true one in the picture, pixels; 1/64 to 1024. Without, and
    /// without a `budget`, the ground is of patches with edges of `pixels_per_edge`.
    pub max_error: Option<f32>,
    /// Time in which the ground's detail is to be chosen and drawn, milliseconds of the GPU; above 0, at most
    /// 1000. The error in the picture follows it; `max_error` then does not count.
    pub budget: Option<f32>,
    /// Was once how the ground's triangles are chosen: read over, so that older files load.
    #[doc(hidden)]
    #[reflect(ignore)]
    #[serde(skip_serializing, deserialize_with = "read_over")]
    pub blocks: (),
    /// Who lights the picture.
    pub renderer: Renderer,
    /// What pictures are drawn with, where the seven fields below do not say it.
    pub preset: Preset,
    /// Bright places glow.
    pub bloom: Option<bool>,
    /// How edges are smoothed.
    pub anti_aliasing: Option<AntiAliasing>,
    /// Maps of the sun's shadow, 0 (no shadows) to [`MOST_CASCADES`].
    pub shadow_cascades: Option<u32>,
    /// Side of each, texels, in [`SHADOW_MAP_RANGE`].
    pub shadow_map: Option<u32>,
    /// How much is done for a pixel of the ground.
    pub shading: Option<GroundShading>,
    /// How much light from everywhere objects near by block, where Dolomite lights the picture.
    pub occlusion: Option<Occlusion>,
    /// Sides of the picture that is drawn over those of the display, in [`RESOLUTION_RANGE`]; the errors above are
    /// in pixels of what is drawn.
    pub resolution: Option<f32>,
    /// Sun as (azimuth, elevation) in degrees instead of the scene's own: azimuth clockwise from
    /// north, elevation above the horizon, −90 to 90.
    pub sun: Option<(f32, f32)>,
    /// Amplitude in metres of the fractal detail below the sample spacing of scenes that have
    /// some (`jacksboro`), instead of the scene's own; 0 (none) to 1000.
    pub detail: Option<f32>,
    /// Draws what grows in scenes where something does; none: in a window of a device that is no program on the CPU.
    pub vegetation: Option<bool>,
    /// Share of its density, 0 to 1.
    pub vegetation_density: f32,
    /// Share of how far away it is drawn, 0 to 4.
    pub vegetation_reach: f32,
    /// Sound is on; off no device is opened.
    pub sound: bool,
    /// How loud all of it is, 0 to 1.
    pub volume: f32,
    /// Shows the panel of frame times and counts.
    pub panel: bool,
}

/// Who lights the picture.
#[derive(
    Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "snake_case")]
pub enum Renderer {
    /// Bevy's deferred pass.
    #[default]
    Bevy,
    /// Dolomite's, which is made for many lamps.
    Dolomite,
}

impl Renderer {
    /// The name, as in settings and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bevy => "bevy",
            Self::Dolomite => "dolomite",
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            window: (1600, 900),
            vsync: true,
            fov: 55.0,
            mouse_sensitivity: 0.12,
            invert_y: false,
            fly_speed: 90.0,
            walk_speed: 1.6,
            run_speed: 5.0,
            fast_factor: 8.0,
            pixels_per_edge: 8.0,
            finest_patch: 16.0,
            max_error: Some(1.0),
            budget: None,
            blocks: (),
            renderer: Renderer::Bevy,
            preset: Preset::Auto,
            bloom: None,
            anti_aliasing: None,
            shadow_cascades: None,
            shadow_map: None,
            shading: None,
            occlusion: None,
            resolution: None,
            sun: None,
            detail: None,
            vegetation: None,
            vegetation_density: 1.0,
            vegetation_reach: 1.0,
            sound: true,
            volume: 0.8,
            panel: true,
        }
    }
}

/// Why settings were refused.
#[derive(Debug, Error)]
pub enum SettingsError {
    /// The file cannot be read.
    #[error("settings file {}: {source}; check the name, or leave `--settings` out", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not RON, or has a field that is none of ours.
    #[error(
        "settings file {}, {source}; `dolomite settings` prints every field with its meaning",
        .path.display()
    )]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line, column and reason.
        source: Box<ron::error::SpannedError>,
    },
    /// A value is outside its range.
    #[error("{}: `{field}` is {value}, but must be {range}", .from.display())]
    Range {
        /// The file, or the option of the command line.
        from: PathBuf,
        /// Name of the field.
        field: &'static str,
        /// What was given.
        value: String,
        /// What is allowed.
        range: String,
    },
}

/// RON with optional values written plainly: `sea_level: 0.0`, not `sea_level: Some(0.0)`; and
/// `Hill(radius: 9.0)`, not `Hill((radius: 9.0))`. Settings and scene files share it.
pub(crate) fn ron_options() -> ron::Options {
    use ron::extensions::Extensions;
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME | Extensions::UNWRAP_VARIANT_NEWTYPES)
}

/// Reads any value of a field that no longer counts.
fn read_over<'de, D: Deserializer<'de>>(value: D) -> Result<(), D::Error> {
    IgnoredAny::deserialize(value).map(drop)
}

impl Settings {
    /// Reads `named`; without a name the file of the user where there is one, else the defaults.
    ///
    /// # Errors
    /// [`SettingsError`] when the named file is missing, or a file is malformed, has an unknown
    /// field or a value outside its range.
    pub fn load(named: Option<&Path>) -> Result<Self, SettingsError> {
        let path = match named {
            Some(path) => path.to_owned(),
            None => match paths::user_settings().filter(|path| path.is_file()) {
                Some(path) => path,
                None => return Ok(Self::default()),
            },
        };
        let text = std::fs::read_to_string(&path).map_err(|source| SettingsError::Read {
            path: path.clone(),
            source,
        })?;
        Self::parse(&text, &path)
    }

    /// Reads settings from RON text; `path` is named in errors.
    ///
    /// # Errors
    /// As [`Settings::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, SettingsError> {
        let settings: Self =
            ron_options()
                .from_str(text)
                .map_err(|source| SettingsError::Parse {
                    path: path.to_owned(),
                    source: Box::new(source),
                })?;
        settings.check(path)?;
        Ok(settings)
    }

    /// Checks every range; `from` is named in the error.
    ///
    /// # Errors
    /// [`SettingsError::Range`] for the first field outside its range, NaN included.
    pub fn check(&self, from: &Path) -> Result<(), SettingsError> {
        let refuse = |field, value: String, range: String| {
            Err(SettingsError::Range {
                from: from.to_owned(),
                field,
                value,
                range,
            })
        };
        let (width, height) = self.window;
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return refuse(
                "window",
                format!("{width} x {height}"),
                format!("1 to {MAX_SIDE} pixels on each side"),
            );
        }
        // Lowest value, whether that value itself is allowed, highest value.
        let ranges = [
            ("fov", self.fov, FOV_RANGE.0, true, FOV_RANGE.1),
            (
                "mouse_sensitivity",
                self.mouse_sensitivity,
                0.0,
                false,
                10.0,
            ),
            ("fly_speed", self.fly_speed, 0.0, false, 1e4),
            ("walk_speed", self.walk_speed, 0.0, false, 100.0),
            ("run_speed", self.run_speed, 0.0, false, 100.0),
            ("fast_factor", self.fast_factor, 1.0, true, 1000.0),
            ("pixels_per_edge", self.pixels_per_edge, 1.0, true, 256.0),
            ("finest_patch", self.finest_patch, 1.0, true, 4096.0),
            (
                "max_error",
                self.max_error.unwrap_or(1.0),
                LEAST_PIXELS,
                true,
                1024.0,
            ),
            ("budget", self.budget.unwrap_or(1.0), 0.0, false, 1000.0),
            (
                "vegetation_density",
                self.vegetation_density,
                0.0,
                true,
                1.0,
            ),
            ("vegetation_reach", self.vegetation_reach, 0.0, true, 4.0),
            ("volume", self.volume, 0.0, true, 1.0),
            ("detail", self.detail.unwrap_or(0.0), 0.0, true, 1000.0),
            (
                "shadow_cascades",
                self.shadow_cascades.unwrap_or(0) as f32,
                0.0,
                true,
                MOST_CASCADES as f32,
            ),
            (
                "shadow_map",
                self.shadow_map.unwrap_or(SHADOW_MAP_RANGE.0) as f32,
                SHADOW_MAP_RANGE.0 as f32,
                true,
                SHADOW_MAP_RANGE.1 as f32,
            ),
            (
                "resolution",
                self.resolution.unwrap_or(1.0),
                RESOLUTION_RANGE.0,
                true,
                RESOLUTION_RANGE.1,
            ),
            (
                "sun azimuth",
                self.sun.map_or(0.0, |sun| sun.0),
                -360.0,
                true,
                360.0,
            ),
            (
                "sun elevation",
                self.sun.map_or(0.0, |sun| sun.1),
                -90.0,
                true,
                90.0,
            ),
        ];
        for (field, value, low, low_allowed, high) in ranges {
            let above = if low_allowed {
                value >= low
            } else {
                value > low
            };
            if !(above && value <= high) {
                let word = if low_allowed { "at least" } else { "above" };
                return refuse(
                    field,
                    value.to_string(),
                    format!("{word} {low} and at most {high}"),
                );
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Settings, SettingsError> {
        Settings::parse(text, Path::new("test.ron"))
    }

    #[test]
    fn the_printed_file_is_the_default() {
        assert_eq!(parse(DEFAULT_SETTINGS).unwrap(), Settings::default());
        assert_eq!(parse("()").unwrap(), Settings::default());
    }

    #[test]
    fn the_printed_file_names_every_field() {
        let all = ron::to_string(&Settings::default()).unwrap();
        for field in all
            .split([',', '('])
            .filter_map(|part| part.split_once(':'))
        {
            assert!(
                DEFAULT_SETTINGS.contains(&format!("{}:", field.0)),
                "{} is missing",
                field.0
            );
        }
    }

    #[test]
    fn files_that_say_how_triangles_are_chosen_still_load() {
        for blocks in ["true", "false"] {
            let settings = parse(&format!("(blocks: {blocks}, fov: 60.0)")).unwrap();
            let expected = Settings {
                fov: 60.0,
                ..Settings::default()
            };
            assert_eq!(settings, expected);
        }
    }

    #[test]
    fn an_unknown_field_is_named_with_file_and_place() {
        let error = parse("(fov: 60.0, fow: 60.0)").unwrap_err().to_string();
        assert!(error.contains("test.ron"), "{error}");
        assert!(error.contains("fow"), "{error}");
        assert!(error.contains("1:"), "{error}");
    }

    #[test]
    fn values_outside_their_range_are_refused() {
        for text in [
            "(window: (0, 600))",
            "(window: (800, 100000))",
            "(fov: 0.0)",
            "(fov: NaN)",
            "(fly_speed: 0.0)",
            "(walk_speed: inf)",
            "(run_speed: 0.0)",
            "(budget: 0.0)",
            "(fast_factor: 0.5)",
            "(pixels_per_edge: 0.0)",
            "(sun: (0.0, 91.0))",
            "(detail: -1.0)",
            "(volume: 1.1)",
            "(volume: NaN)",
            "(resolution: 0.2)",
            "(resolution: NaN)",
            "(shadow_cascades: 5)",
            "(shadow_map: 8192)",
        ] {
            assert!(
                matches!(parse(text), Err(SettingsError::Range { .. })),
                "{text} was accepted"
            );
        }
    }

    #[test]
    fn a_missing_named_file_is_an_error() {
        let error = Settings::load(Some(Path::new("no/such/file.ron"))).unwrap_err();
        assert!(error.to_string().contains("no/such/file.ron"));
    }
}
