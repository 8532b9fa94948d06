//! Tests of the umbrella, as one program, since each more would link Bevy once more.

mod settings;
mod sources;
