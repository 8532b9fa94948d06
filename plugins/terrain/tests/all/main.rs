//! Tests of heights, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_terrain NAME::` runs one module.

mod accuracy;
mod adapter;
mod batch;
mod bounds;
mod edits;
mod field;
mod height_map;
mod layout;
mod permutation;
mod plugin;
mod shared;
mod support;
mod terrain;
mod tiled;
