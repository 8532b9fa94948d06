//! Tests of the city that need shaders or many patches, as one program, since each more would link Bevy once more.
#![cfg(feature = "render")]

#[path = "../../../geometry/tests/all/app/mod.rs"]
mod app;
mod bound;
mod boxes;
#[expect(dead_code, reason = "its `main` opens a window")]
#[path = "../../examples/city.rs"]
mod city;
mod drawn;
mod probe;
mod seams;
mod support;
