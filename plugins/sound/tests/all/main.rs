//! Tests of sound, as one program, since each more would link Bevy once more. They listen to samples.

mod cost;
mod heard;
mod hostile;
mod idle;
mod support;
