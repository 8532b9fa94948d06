//! Tests of characters, as one program, since each more would link Bevy once more.
//! `cargo nextest run -p dolomite_character NAME::` runs one module.

mod accuracy;
mod adapter;
mod blend;
mod crowd;
mod feet;
mod load;
mod locomotion;
mod plugin;
mod support;
