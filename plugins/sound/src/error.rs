//! What can be wrong, with what to do.

use std::path::PathBuf;

use bevy::ecs::message::Message;
use thiserror::Error;

use crate::id::SoundId;

/// Why a sound, an emitter or a device was refused. Nothing here ends an app: what is refused is not heard.
#[derive(Debug, Error)]
pub enum SoundError {
    /// A file cannot be read.
    #[error("sound file {}: {source}; check the name", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file is no sound that can be played.
    #[error("sound file {}, byte {at}: {reason}; PCM of 8, 16, 24 or 32 bits or floats of 32 in a WAV can be played", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Where.
        at: usize,
        /// Why.
        reason: String,
    },
    /// Samples that cannot be played.
    #[error("samples: {0}")]
    Samples(String),
    /// More sounds than there are numbers.
    #[error("there are {0} sounds already; no more can be added")]
    Full(usize),
    /// Nothing has this number.
    #[error("there is no sound {}; `Sounds::add` gives numbers", .0.0)]
    Unknown(SoundId),
    /// Places or loudnesses that are no numbers.
    #[error("{count} of {what} have a place or a loudness that is not finite; they are not heard")]
    NotFinite {
        /// Emitters or messages.
        what: &'static str,
        /// How many, in one frame.
        count: u32,
    },
    /// The device cannot be opened.
    #[error("no sound: {0}; the game goes on without")]
    Device(String),
    /// The program was built without devices.
    #[error(
        "no sound: this program was built without the feature `device` of dolomite_sound (on Linux it needs ALSA: libasound2-dev)"
    )]
    NoDevice,
    /// A rate that no backend has.
    #[error("a sample rate of {0} cannot be rendered; 8000 to 192000 can")]
    Rate(u32),
}

/// Something was refused. Of each kind one a frame is written, and the first of each kind is logged too.
#[derive(Message, Debug)]
pub struct SoundFault(pub SoundError);

impl SoundError {
    /// A number for the kind, for logging each once.
    pub(crate) const fn kind(&self) -> u32 {
        match self {
            Self::Read { .. } => 0,
            Self::File { .. } => 1,
            Self::Samples(_) => 2,
            Self::Full(_) => 3,
            Self::Unknown(_) => 4,
            Self::NotFinite { .. } => 5,
            Self::Device(_) => 6,
            Self::NoDevice => 7,
            Self::Rate(_) => 8,
        }
    }
}
