//! Makes the sounds that come with `dolomite_sound`: steps, wind, sea, shots, calls, lifts, fire.
//!
//! | module | holds |
//! |---|---|
//! | [`noise`] | random numbers, white noise |
//! | [`filter`] | filters of one and two poles, and how they run round a loop |
//! | [`shape`] | envelopes, fades, levels |
//! | [`steps`], [`weather`], [`things`] | the sounds |
//! | [`catalogue`] | all of them by name |
//! | [`wave`] | files in the format WAV, 16 bits, one channel |
//! | [`picture`] | a picture of all of them |
//!
//! Everything is f64 arithmetic with functions of `libm`, so that a sound is the same bytes on every machine.
//! Samples are in −1 to 1.

pub mod catalogue;
pub mod filter;
pub mod noise;
pub mod picture;
pub mod shape;
pub mod steps;
pub mod things;
pub mod wave;
pub mod weather;

/// The seed that the committed files were made from.
pub const SEED: u32 = 22;
