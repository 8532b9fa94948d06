//! Tests of the tessellation stage, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_tessellation NAME::` runs one module.

#[path = "../../../geometry/tests/all/app/mod.rs"]
mod app;
mod shaders;
mod shadows;
mod stage;
#[expect(dead_code, reason = "its `main` opens a window")]
#[path = "../../examples/torus.rs"]
mod torus;
mod warnings;
