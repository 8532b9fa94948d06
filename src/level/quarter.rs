//! What a level's file says besides, in a city: sides, the gate, the player's weapon.

use bevy::math::Vec2;
use dolomite::city::streets::{EAST, NORTH, SOUTH, WEST};
use serde::Deserialize;

/// Half of the width of the gate, metres: two walk through it side by side.
pub const GATE: f32 = 2.0;

/// A side of a house or of the quarter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
pub enum Side {
    /// −x.
    West,
    /// +z.
    South,
    /// +x.
    East,
    /// −z.
    North,
}

impl Side {
    /// Outwards, (x, z), of length 1.
    pub const fn out(self) -> Vec2 {
        match self {
            Self::West => Vec2::NEG_X,
            Self::South => Vec2::Y,
            Self::East => Vec2::X,
            Self::North => Vec2::NEG_Y,
        }
    }

    /// As streets number sides.
    pub const fn number(self) -> usize {
        match self {
            Self::West => WEST,
            Self::South => SOUTH,
            Self::East => EAST,
            Self::North => NORTH,
        }
    }
}

/// Where the wall around a quarter opens.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GateFile {
    /// In which side of the area.
    pub side: Side,
    /// From the middle of that side, metres: east or south.
    pub along: f32,
}

/// The player's weapon. Metres, seconds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WeaponFile {
    /// Shots, and there are no more.
    pub rounds: u32,
    /// Health that a bolt takes.
    pub damage: f32,
    /// Metres a second of a bolt.
    pub bolt: f32,
    /// How far it flies.
    pub range: f32,
    /// Seconds between shots.
    pub every: f32,
    /// How far a shot is heard.
    pub noise: f32,
}
