//! What faces are covered with.

use crate::rules::CityRules;

/// What covers a face. The numbers are those of the shaders (`city/types.wgsl`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Surface {
    /// Streets.
    Asphalt = 0,
    /// Crossings.
    Cobbles = 1,
    /// Lawns, and lines of the grid that are no streets.
    Grass = 2,
    /// Walls.
    Bricks = 3,
    /// Walls.
    Plaster = 4,
    /// Roofs.
    Tiles = 5,
    /// Hedges.
    Leaves = 6,
    /// Flat ground beyond the patches: streets and lawns are told apart by place.
    Far = 7,
}

impl Surface {
    /// All that are displaced, by number.
    pub const ALL: [Self; 7] = [
        Self::Asphalt,
        Self::Cobbles,
        Self::Grass,
        Self::Bricks,
        Self::Plaster,
        Self::Tiles,
        Self::Leaves,
    ];

    /// The map that displaces it, by its place in [`MAPS`](crate::maps::MAPS): lawns have that of leaves.
    #[must_use]
    pub const fn map(self) -> usize {
        match self {
            Self::Asphalt => 0,
            Self::Cobbles => 1,
            Self::Bricks => 2,
            Self::Plaster => 3,
            Self::Tiles => 4,
            Self::Grass | Self::Leaves | Self::Far => 5,
        }
    }

    /// Greatest displacement, metres: what 1 in the map means.
    #[must_use]
    pub const fn amplitude(self, rules: &CityRules) -> f32 {
        match self {
            Self::Asphalt => rules.relief.asphalt,
            Self::Cobbles => rules.relief.cobbles,
            Self::Grass => rules.relief.grass,
            Self::Bricks => rules.relief.bricks,
            Self::Plaster => rules.relief.plaster,
            Self::Tiles => rules.relief.tiles,
            Self::Leaves => rules.relief.leaves,
            Self::Far => 0.0,
        }
    }

    /// Greatest displacement of all surfaces, metres.
    #[must_use]
    pub fn greatest(rules: &CityRules) -> f32 {
        Self::ALL
            .map(|surface| surface.amplitude(rules))
            .into_iter()
            .fold(0.0, f32::max)
    }
}
