//! All sounds by the names of their files.

use crate::noise::Noise;
use crate::steps::{self, Walked, step};
use crate::{things, weather};

/// A sound.
#[derive(Clone, Copy, Debug)]
pub struct Sound {
    /// The name of its file, without `.wav`.
    pub name: &'static str,
    /// Samples a second.
    pub rate: u32,
    /// It is repeated: its end goes over into its begin.
    pub looped: bool,
    make: fn(Noise) -> Vec<f64>,
}

impl Sound {
    const fn once(name: &'static str, rate: u32, make: fn(Noise) -> Vec<f64>) -> Self {
        Self {
            name,
            rate,
            looped: false,
            make,
        }
    }

    const fn looped(name: &'static str, rate: u32, make: fn(Noise) -> Vec<f64>) -> Self {
        Self {
            name,
            rate,
            looped: true,
            make,
        }
    }

    /// Its samples, −1 to 1.
    #[must_use]
    pub fn samples(&self, seed: u32) -> Vec<f64> {
        (self.make)(Noise::new(seed, self.name))
    }
}

/// All of them.
pub const SOUNDS: [Sound; 20] = [
    Sound::once("step_rock_1", steps::RATE, |noise| {
        step(Walked::Rock, noise)
    }),
    Sound::once("step_rock_2", steps::RATE, |noise| {
        step(Walked::Rock, noise)
    }),
    Sound::once("step_grass_1", steps::RATE, |noise| {
        step(Walked::Grass, noise)
    }),
    Sound::once("step_grass_2", steps::RATE, |noise| {
        step(Walked::Grass, noise)
    }),
    Sound::once("step_sand_1", steps::RATE, |noise| {
        step(Walked::Sand, noise)
    }),
    Sound::once("step_sand_2", steps::RATE, |noise| {
        step(Walked::Sand, noise)
    }),
    Sound::once("step_snow_1", steps::RATE, |noise| {
        step(Walked::Snow, noise)
    }),
    Sound::once("step_snow_2", steps::RATE, |noise| {
        step(Walked::Snow, noise)
    }),
    Sound::once("step_road_1", steps::RATE, |noise| {
        step(Walked::Road, noise)
    }),
    Sound::once("step_road_2", steps::RATE, |noise| {
        step(Walked::Road, noise)
    }),
    Sound::once("step_water_1", steps::RATE, |noise| {
        step(Walked::Water, noise)
    }),
    Sound::once("step_water_2", steps::RATE, |noise| {
        step(Walked::Water, noise)
    }),
    Sound::looped("wind", weather::RATE, weather::wind),
    Sound::looped("sea", weather::RATE, weather::sea),
    Sound::looped("fire", weather::RATE, weather::fire),
    Sound::once("shot", things::SHARP, things::shot),
    Sound::once("hit", things::SHARP, things::hit),
    Sound::once("call", things::DULL, things::call),
    Sound::looped("lift", things::DULL, things::lift),
    Sound::once("latch", things::SHARP, things::latch),
];
