//! Components and messages.

use bevy::ecs::component::Component;
use bevy::ecs::message::Message;
use bevy::ecs::reflect::ReflectComponent;
use bevy::math::Vec3;
use bevy::reflect::Reflect;
use bevy::reflect::std_traits::ReflectDefault;
use bevy::transform::components::Transform;

use crate::id::SoundId;

/// Hears: goes on a camera or a head. Of several the one with the lowest entity number hears. Without one nothing is
/// opened and nothing runs.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, PartialEq)]
#[require(Transform)]
pub struct SoundListener;

/// Which volume of the settings counts.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default)]
pub enum Bus {
    /// What things and people do.
    #[default]
    Effects,
    /// Wind, water, what is always there.
    Ambience,
}

/// How loud, how far, how important.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, PartialEq)]
pub struct Loudness {
    /// Amplitude at [`Self::reference`], 0 to 4; 1 is the sound as it is.
    pub volume: f32,
    /// Speed and pitch as a multiple of the sound's own, 1/16 to 16.
    pub rate: f32,
    /// Metres up to which it is as loud as can be; from there on it is inverse to the distance. Above 0.
    pub reference: f32,
    /// Metres from which on it is not heard; above 0.
    pub reach: f32,
    /// Where there are more than voices, the greater number is heard.
    pub priority: u8,
    /// Which volume of the settings counts.
    pub bus: Bus,
}

impl Default for Loudness {
    fn default() -> Self {
        Self {
            volume: 1.0,
            rate: 1.0,
            reference: 2.0,
            reach: 200.0,
            priority: 100,
            bus: Bus::Effects,
        }
    }
}

impl Loudness {
    /// The same within its ranges; `None` where a number is not finite.
    #[must_use]
    pub fn checked(self) -> Option<Self> {
        let whole = [self.volume, self.rate, self.reference, self.reach]
            .iter()
            .all(|number| number.is_finite());
        whole.then(|| Self {
            volume: self.volume.clamp(0.0, 4.0),
            rate: self.rate.clamp(0.0625, 16.0),
            reference: self.reference.max(1e-3),
            reach: self.reach.max(1e-3),
            ..self
        })
    }
}

/// Sounds without end, at its `GlobalTransform`. What is silent or too far costs a comparison and no voice.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(Transform)]
pub struct SoundEmitter {
    /// What sounds.
    pub sound: SoundId,
    /// How.
    pub loudness: Loudness,
    /// Heard alike from everywhere, in the middle: wind about one's ears.
    pub everywhere: bool,
}

/// Plays a sound once.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct PlaySound {
    /// What.
    pub sound: SoundId,
    /// Where; `None`: at the listener, without delay.
    pub place: Option<Vec3>,
    /// How.
    pub loudness: Loudness,
}

impl PlaySound {
    /// At a place.
    #[must_use]
    pub fn at(sound: SoundId, place: Vec3) -> Self {
        Self {
            sound,
            place: Some(place),
            loudness: Loudness::default(),
        }
    }

    /// As loud everywhere.
    #[must_use]
    pub fn new(sound: SoundId) -> Self {
        Self {
            sound,
            place: None,
            loudness: Loudness::default(),
        }
    }

    /// The same with another loudness.
    #[must_use]
    pub const fn with(self, loudness: Loudness) -> Self {
        Self { loudness, ..self }
    }
}
