//! What may be set, and what is counted.

use bevy::ecs::reflect::ReflectResource;
use bevy::ecs::resource::Resource;
use bevy::reflect::Reflect;
use bevy::reflect::std_traits::ReflectDefault;

/// Most voices.
pub const MOST_VOICES: u32 = 128;

/// What plays.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default)]
pub enum SoundTarget {
    /// The system's device, with the feature `device`.
    #[default]
    Device,
    /// No device: [`SoundOutput::render`](crate::SoundOutput::render) gives the samples.
    Samples {
        /// Samples a second, 8000 to 192 000.
        rate: u32,
    },
}

/// What may be set.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, PartialEq)]
pub struct SoundSettings {
    /// Off closes the device: no thread is left, and no system runs.
    pub on: bool,
    /// Amplitude of everything, 0 to 1.
    pub volume: f32,
    /// Amplitude of [`Bus::Effects`](crate::Bus::Effects), 0 to 1.
    pub effects: f32,
    /// Amplitude of [`Bus::Ambience`](crate::Bus::Ambience), 0 to 1.
    pub ambience: f32,
    /// Sounds that are heard at once at most, 1 to [`MOST_VOICES`].
    pub voices: u32,
    /// Metres a second; not above 0: at once.
    pub speed_of_sound: f32,
    /// What plays. A change opens anew.
    pub target: SoundTarget,
}

impl Default for SoundSettings {
    fn default() -> Self {
        Self {
            on: true,
            volume: 0.8,
            effects: 1.0,
            ambience: 1.0,
            voices: 32,
            // Dry air of 20 °C.
            speed_of_sound: 343.0,
            target: SoundTarget::Device,
        }
    }
}

/// A volume as it counts: within 0 and 1, and 0 for what is no number.
pub(crate) const fn share(volume: f32) -> f32 {
    if volume.is_nan() {
        0.0
    } else {
        volume.clamp(0.0, 1.0)
    }
}

/// What the last frame heard, and what has been counted since the start.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, PartialEq)]
pub struct SoundCounters {
    /// Outputs that have been opened.
    pub opened: u32,
    /// Frames in which the systems ran.
    pub frames: u64,
    /// Emitters there are.
    pub emitters: u32,
    /// Emitters and one-shots that would be heard.
    pub audible: u32,
    /// Those that have a voice.
    pub voices: u32,
    /// One-shots that were played.
    pub played: u64,
    /// One-shots that nobody would have heard: too far or too low.
    pub unheard: u64,
    /// One-shots and emitters that gave their voice to others before they ended, and one-shots that got none.
    pub crowded_out: u64,
    /// Emitters and messages that were refused: see [`SoundFault`](crate::SoundFault).
    pub refused: u64,
}
