//! Tests of what grows, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_vegetation NAME::` runs one module.

#[cfg(feature = "render")]
#[path = "../../../geometry/tests/all/app/mod.rs"]
mod app;
#[cfg(feature = "render")]
mod drawn;
#[cfg(feature = "render")]
mod edges;
#[cfg(feature = "render")]
mod functions;
#[cfg(feature = "render")]
mod images;
#[cfg(feature = "render")]
mod place;
#[cfg(feature = "render")]
mod ranks;
mod rings;
#[cfg(feature = "render")]
mod roots;
#[cfg(feature = "render")]
mod shaders;
#[cfg(feature = "render")]
mod shapes;
#[cfg(feature = "render")]
mod support;
