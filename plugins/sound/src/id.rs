//! What a sound is known by.

use bevy::reflect::Reflect;

/// The number of a sound in [`Sounds`](crate::Sounds).
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SoundId(pub u32);
