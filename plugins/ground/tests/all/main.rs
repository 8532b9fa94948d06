//! Tests of the drawn ground, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_ground NAME::` runs one module.

mod adapter;
mod app;
#[cfg(feature = "render")]
mod blocks;
#[cfg(feature = "render")]
mod canopy;
#[cfg(feature = "render")]
mod chosen;
mod cover;
#[cfg(feature = "render")]
mod edits;
#[cfg(feature = "render")]
mod inspect;
#[cfg(feature = "render")]
mod once;
mod plugin;
#[cfg(feature = "render")]
mod several;
mod shaders;
mod support;
