//! Tests of the sky, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_sky NAME::` runs one module.

#[cfg(feature = "render")]
mod absent;
#[cfg(feature = "render")]
mod night;
mod registry;
#[cfg(feature = "render")]
mod stage;
#[cfg(feature = "render")]
mod support;
