//! What a picture is drawn with beside its ground: presets by the kind of device, and what the player set by hand.
//!
//! The bound of the ground's error is not among them: it is one pixel *of the picture that is drawn* on every device.
//! Where the resolution is scaled, that is one over the scale in pixels of the display.

use bevy::prelude::*;
use dolomite::ground::GroundShading;
use serde::{Deserialize, Serialize};

use super::Settings;

/// Least and greatest resolution, as a part of the display's.
pub const RESOLUTION_RANGE: (f32, f32) = (0.25, 2.0);

/// The resolutions that the keys step through.
pub const RESOLUTIONS: [f32; 8] = [0.25, 0.33, 0.5, 0.67, 0.75, 0.8, 1.0, 2.0];

/// Most cascades of the sun's shadow: as many as Bevy has on every device.
pub const MOST_CASCADES: u32 = 4;

/// Least and greatest side of a shadow map, texels.
pub const SHADOW_MAP_RANGE: (u32, u32) = (256, 4096);

/// What draws.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceKind {
    /// A program on the CPU.
    Software,
    /// A GPU that shares the memory of the CPU, or one of a virtual machine, of which little is known.
    Integrated,
    /// A GPU with memory of its own.
    Discrete,
}

/// A set of qualities, by name.
#[derive(
    Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    /// That of the device, in a window; `full` in pictures and measurements, which shall be the same on each.
    #[default]
    Auto,
    /// For a program on the CPU.
    Software,
    /// For a GPU that shares the memory of the CPU.
    Integrated,
    /// All there is.
    Full,
}

impl Preset {
    /// The name, as in settings and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Software => "software",
            Self::Integrated => "integrated",
            Self::Full => "full",
        }
    }
}

/// How edges are smoothed.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AntiAliasing {
    /// Not at all: no pass.
    Off,
    /// Fast approximate: one pass.
    Fxaa,
    /// Subpixel morphological: three passes.
    Smaa,
}

/// For how many pixels it is found how much light from everywhere objects near by block; in Dolomite's light
/// ([`super::Renderer::Dolomite`]) alone.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Occlusion {
    /// For none: no pass, no texture.
    Off,
    /// For a quarter of them.
    Half,
    /// For each.
    Full,
}

/// What a picture is drawn with.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// The preset that it began with; never [`Preset::Auto`].
    pub preset: Preset,
    /// Whether bright places glow.
    pub bloom: bool,
    /// How edges are smoothed.
    pub anti_aliasing: AntiAliasing,
    /// Maps of the sun's shadow, up to [`MOST_CASCADES`]; 0: no shadows, and no map.
    pub shadow_cascades: u32,
    /// Side of each, texels, in [`SHADOW_MAP_RANGE`].
    pub shadow_map: u32,
    /// How much is done for a pixel of the ground.
    pub shading: GroundShading,
    /// How much light from everywhere objects near by block.
    pub occlusion: Occlusion,
    /// Sides of the picture that is drawn over those of the display, in [`RESOLUTION_RANGE`].
    pub resolution: f32,
}

/// The presets, each with its reason.
///
/// On software Vulkan the parts of a frame were measured (`dolomite bench`, mountain, 160 × 90, two busy cores): of
/// 1.2 s the ground's pixels and shadows took 0.46 s, bloom 0.3 s, tone mapping 0.2 s, shadows 0.12 s, anti-aliasing
/// 0.09 s. So the picture is smaller there, and passes that read all of it again are left out or are fewer. Of
/// integrated GPUs nothing was measured; their memory carries a tenth of what a discrete one's does, which bounds
/// passes over the whole picture and shadow maps.
pub const PRESETS: [(Quality, &str); 3] = [
    (
        Quality {
            preset: Preset::Software,
            bloom: false,
            anti_aliasing: AntiAliasing::Fxaa,
            shadow_cascades: 2,
            shadow_map: 1024,
            shading: GroundShading::Balanced,
            occlusion: Occlusion::Off,
            resolution: 0.67,
        },
        "pixels are most of a frame on the CPU: less than half of them; no bloom, two small maps of shadow, one pass for edges",
    ),
    (
        Quality {
            preset: Preset::Integrated,
            bloom: true,
            anti_aliasing: AntiAliasing::Fxaa,
            shadow_cascades: 3,
            shadow_map: 1024,
            shading: GroundShading::Balanced,
            occlusion: Occlusion::Half,
            resolution: 0.8,
        },
        "memory is shared with the CPU and carries a tenth: two thirds of the pixels, a fifth of the texels of shadow",
    ),
    (
        Quality {
            preset: Preset::Full,
            bloom: true,
            anti_aliasing: AntiAliasing::Smaa,
            shadow_cascades: 4,
            shadow_map: 2048,
            shading: GroundShading::Fine,
            occlusion: Occlusion::Full,
            resolution: 1.0,
        },
        "all there is",
    ),
];

impl Default for Quality {
    fn default() -> Self {
        Self::of(Preset::Full)
    }
}

impl Quality {
    /// A preset as it is; of [`Preset::Auto`] the full one.
    pub fn of(preset: Preset) -> Self {
        let found = PRESETS.iter().find(|(quality, _)| quality.preset == preset);
        let [.., (full, _)] = PRESETS;
        found.map_or(full, |(quality, _)| *quality)
    }

    /// What the settings ask for on a device; on none where the picture shall be the same on each. What was set by
    /// hand comes before the preset.
    pub fn chosen(settings: &Settings, device: Option<DeviceKind>) -> Self {
        let preset = match (settings.preset, device) {
            (Preset::Auto, Some(DeviceKind::Software)) => Preset::Software,
            (Preset::Auto, Some(DeviceKind::Integrated)) => Preset::Integrated,
            (Preset::Auto, _) => Preset::Full,
            (named, _) => named,
        };
        let preset = Self::of(preset);
        Self {
            preset: preset.preset,
            bloom: settings.bloom.unwrap_or(preset.bloom),
            anti_aliasing: settings.anti_aliasing.unwrap_or(preset.anti_aliasing),
            shadow_cascades: settings.shadow_cascades.unwrap_or(preset.shadow_cascades),
            shadow_map: settings.shadow_map.unwrap_or(preset.shadow_map),
            shading: settings.shading.unwrap_or(preset.shading),
            occlusion: settings.occlusion.unwrap_or(preset.occlusion),
            resolution: settings.resolution.unwrap_or(preset.resolution),
        }
    }

    /// Width and height of the picture that is drawn for a display of `display` pixels, none larger than `most`: at
    /// least a pixel each.
    pub fn drawn(&self, display: UVec2, most: u32) -> UVec2 {
        let fits = most as f32 / display.max_element().max(1) as f32;
        let scale = self.resolution.min(fits.max(f32::MIN_POSITIVE));
        let side = |side: u32| ((side as f32 * scale).round() as u32).clamp(1, most.max(1));
        UVec2::new(side(display.x), side(display.y))
    }
}

/// The resolution that is `steps` from this one among [`RESOLUTIONS`].
pub fn stepped(resolution: f32, steps: i32) -> f32 {
    let at = match steps {
        1.. => RESOLUTIONS.partition_point(|known| *known <= resolution * 1.001) as i32 + steps - 1,
        _ => RESOLUTIONS.partition_point(|known| *known < resolution * 0.999) as i32 + steps,
    };
    RESOLUTIONS[at.clamp(0, RESOLUTIONS.len() as i32 - 1) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_device_chooses_and_the_player_overrules() {
        let settings = Settings::default();
        let chosen = |settings: &Settings, kind| Quality::chosen(settings, kind);
        assert_eq!(chosen(&settings, None), Quality::default());
        assert_eq!(
            chosen(&settings, Some(DeviceKind::Discrete)),
            Quality::default()
        );
        let software = chosen(&settings, Some(DeviceKind::Software));
        assert_eq!(software, Quality::of(Preset::Software));
        assert!(!software.bloom);
        let integrated = chosen(&settings, Some(DeviceKind::Integrated));
        assert_eq!(integrated.preset, Preset::Integrated);
        let by_hand = Settings {
            bloom: Some(true),
            resolution: Some(1.0),
            ..settings.clone()
        };
        let mixed = chosen(&by_hand, Some(DeviceKind::Software));
        assert_eq!(
            mixed,
            Quality {
                bloom: true,
                resolution: 1.0,
                ..software
            }
        );
        let named = Settings {
            preset: Preset::Integrated,
            ..settings
        };
        assert_eq!(chosen(&named, Some(DeviceKind::Software)), integrated);
        assert_eq!(chosen(&named, None), integrated);
    }

    #[test]
    fn presets_are_within_the_ranges_of_settings() {
        for (quality, reason) in PRESETS {
            assert!(quality.shadow_cascades <= MOST_CASCADES, "{reason}");
            let (least, most) = SHADOW_MAP_RANGE;
            assert!((least..=most).contains(&quality.shadow_map));
            let (least, most) = RESOLUTION_RANGE;
            assert!((least..=most).contains(&quality.resolution));
            assert_eq!(Quality::of(quality.preset), quality);
        }
        assert_eq!(Quality::of(Preset::Auto).preset, Preset::Full);
    }

    #[test]
    fn a_drawn_picture_has_pixels_and_fits() {
        let at = |resolution| Quality {
            resolution,
            ..Quality::default()
        };
        let size = |x, y| UVec2::new(x, y);
        assert_eq!(at(0.5).drawn(size(640, 360), 16_384), size(320, 180));
        assert_eq!(at(1.0).drawn(size(641, 359), 16_384), size(641, 359));
        assert_eq!(at(0.25).drawn(size(1, 1), 16_384), size(1, 1));
        assert_eq!(at(0.25).drawn(size(16_384, 1), 16_384), size(4096, 1));
        // Twice as wide as the device can hold: as wide as it can.
        assert_eq!(at(2.0).drawn(size(16_384, 100), 16_384), size(16_384, 100));
        assert_eq!(at(2.0).drawn(size(3000, 1500), 4096), size(4096, 2048));
        assert_eq!(at(1.0).drawn(size(0, 0), 4096), size(1, 1));
    }

    #[test]
    fn steps_go_through_the_list_and_end_there() {
        assert_eq!(stepped(1.0, -1), 0.8);
        assert_eq!(stepped(1.0, 1), 2.0);
        assert_eq!(stepped(0.5, 1), 0.67);
        assert_eq!(stepped(0.5, -1), 0.33);
        assert_eq!(stepped(0.25, -1), 0.25);
        assert_eq!(stepped(2.0, 1), 2.0);
        // What stands between two goes to the nearest on the asked side.
        assert_eq!(stepped(0.6, 1), 0.67);
        assert_eq!(stepped(0.6, -1), 0.5);
    }
}
