//! Tests of logic, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_logic NAME::` runs one module.

mod access;
mod behaviour;
#[cfg(feature = "collision")]
mod collision;
mod movement;
mod parts;
mod paths;
mod plugin;
mod programs;
mod senses;
mod shots;
mod support;
mod times;
mod zones;
