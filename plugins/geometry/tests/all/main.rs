//! Tests of the shared geometry passes, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_geometry NAME::` runs one module.

#[cfg(feature = "render")]
mod app;
#[cfg(feature = "render")]
mod example;
#[cfg(feature = "render")]
mod registry;
mod shaders;
#[cfg(feature = "render")]
mod warnings;
#[cfg(feature = "render")]
#[expect(dead_code, reason = "its `main` opens a window")]
#[path = "../../examples/waves.rs"]
mod waves;
