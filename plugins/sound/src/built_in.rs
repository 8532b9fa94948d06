//! The sounds that come with the crate. `cargo run -p dolomite_sounds` makes their files.

use crate::id::SoundId;

/// A step on rock or scree; each time one of two.
pub const STEP_ROCK: SoundId = SoundId(0);
/// A step on grass.
pub const STEP_GRASS: SoundId = SoundId(1);
/// A step on sand.
pub const STEP_SAND: SoundId = SoundId(2);
/// A step on snow.
pub const STEP_SNOW: SoundId = SoundId(3);
/// A step on paving.
pub const STEP_ROAD: SoundId = SoundId(4);
/// A step in shallow water.
pub const STEP_WATER: SoundId = SoundId(5);
/// Wind, a loop; [`crate::wind`] says how loud it is.
pub const WIND: SoundId = SoundId(6);
/// Surf, a loop.
pub const SEA: SoundId = SoundId(7);
/// A fire, a loop.
pub const FIRE: SoundId = SoundId(8);
/// A crossbow.
pub const SHOT: SoundId = SoundId(9);
/// A bolt that hits somebody.
pub const HIT: SoundId = SoundId(10);
/// Somebody calls.
pub const CALL: SoundId = SoundId(11);
/// A lift or a gate that moves, a loop.
pub const LIFT: SoundId = SoundId(12);
/// A latch or a button.
pub const LATCH: SoundId = SoundId(13);

/// Names in the order of the numbers, each with its files.
pub const NAMES: [(&str, &[usize]); 14] = [
    ("step_rock", &[0, 1]),
    ("step_grass", &[2, 3]),
    ("step_sand", &[4, 5]),
    ("step_snow", &[6, 7]),
    ("step_road", &[8, 9]),
    ("step_water", &[10, 11]),
    ("wind", &[12]),
    ("sea", &[13]),
    ("fire", &[14]),
    ("shot", &[15]),
    ("hit", &[16]),
    ("call", &[17]),
    ("lift", &[18]),
    ("latch", &[19]),
];

macro_rules! files {
    ($($name:literal),*) => {
        [$(($name, include_bytes!(concat!("../assets/", $name, ".wav")).as_slice())),*]
    };
}

/// The files with their bytes.
pub const FILES: [(&str, &[u8]); 20] = files!(
    "step_rock_1",
    "step_rock_2",
    "step_grass_1",
    "step_grass_2",
    "step_sand_1",
    "step_sand_2",
    "step_snow_1",
    "step_snow_2",
    "step_road_1",
    "step_road_2",
    "step_water_1",
    "step_water_2",
    "wind",
    "sea",
    "fire",
    "shot",
    "hit",
    "call",
    "lift",
    "latch"
);
