//! Tests of the lab, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_lab NAME::` runs one module.

mod answers;
mod drawn;
mod heat;
mod quadtree;
mod shadow_ranges;
mod stage;
mod support;
mod tessellation;
mod web;
