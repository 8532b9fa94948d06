//! Tests of the inspector, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_inspector NAME::` runs one module.

mod commands;
mod fuzz;
#[cfg(feature = "panel")]
mod panel;
mod support;
