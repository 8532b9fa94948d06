//! Sound: emitters and one-shots in space, heard by a listener, played by [Kira](https://docs.rs/kira).
//!
//! See [`SoundPlugin`], and the README for a first example.
//!
//! | module | holds |
//! |---|---|
//! | [`samples`], [`wav`] | a sound in memory; files in the format WAV |
//! | [`sounds`], [`built_in`] | all sounds by number and name; those that come with the crate |
//! | [`space`] | loudness, panning and delay by place |
//! | [`parts`] | components and messages: [`SoundListener`], [`SoundEmitter`], [`PlaySound`] |
//! | [`settings`] | what may be set, and what is counted |
//! | [`choose`] | who gets a voice where there are more than may be heard |
//! | [`output`], [`offline`], [`limiter`] | a device, or samples in its place; no sample beyond full scale |
//! | [`wind`] | how loud wind is by speed and height |
//! | [`error`] | what can be wrong |
//!
//! Metres and seconds; +Y is up, −Z is forward. Loudness is amplitude: 1 is full scale, half of it 6 dB less.

pub mod built_in;
pub mod choose;
pub mod error;
mod id;
pub mod limiter;
pub mod offline;
pub mod output;
pub mod parts;
mod plugin;
pub mod samples;
pub mod settings;
pub mod sounds;
pub mod space;
mod voices;
pub mod wav;
pub mod wind;

pub use error::{SoundError, SoundFault};
pub use id::SoundId;
pub use output::SoundOutput;
pub use parts::{Bus, Loudness, PlaySound, SoundEmitter, SoundListener};
pub use plugin::{SoundPlugin, SoundSystems};
pub use samples::Samples;
pub use settings::{SoundCounters, SoundSettings, SoundTarget};
pub use sounds::Sounds;
