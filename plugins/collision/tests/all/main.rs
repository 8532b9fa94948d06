//! Tests of collision, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_collision NAME::` runs one module.

mod fit;
#[cfg(feature = "terrain")]
mod ground;
mod moves;
mod plugin;
#[cfg(feature = "rapier")]
mod rapier;
mod support;
mod sweep;
mod tree;
mod volumes;
