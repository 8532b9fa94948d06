//! Tests of the game and the command, and of plugins together in one app, as one program, since each more would link
//! Bevy once more. `cargo nextest run -p dolomite_game NAME::` runs one module.

mod absent;
mod budget;
mod city;
mod classic;
mod console;
mod crowd;
mod culled;
mod feet;
mod headless;
mod hero;
mod hostile;
mod images;
mod inspector;
mod lamps;
mod level;
mod night;
#[expect(dead_code, reason = "only its body is drawn here")]
#[path = "../../plugins/character/tests/all/support/person.rs"]
mod person;
mod pictures;
mod quality;
mod reload;
mod soldiers;
mod stage;
mod start;
mod strangers;
mod support;

mod things;
mod tint;
mod views;
#[path = "../../plugins/character/tests/all/support/walk.rs"]
mod walk;
#[cfg(target_os = "linux")]
mod window;
