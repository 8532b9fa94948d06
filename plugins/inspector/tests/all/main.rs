//! Tests of the inspector, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_inspector NAME::` runs one module.

mod chart;
mod commands;
#[cfg(feature = "panel")]
mod costs;
#[cfg(any(feature = "panel", feature = "picture"))]
mod drawn;
mod fuzz;
#[cfg(feature = "panel")]
mod panel;
#[cfg(feature = "picture")]
mod picture;
mod support;
