//! A ground on its lattice: what a choice is told of it.

use dolomite_terrain::{GpuTerrainUniform, Terrain};

use super::lattice::DetailLattice;

/// A terrain, and the lattice that its vertices stand on.
#[derive(Clone, Debug)]
pub struct DetailGround {
    /// Where vertices stand.
    pub lattice: DetailLattice,
    terrain: Terrain,
}

impl DetailGround {
    /// On an even lattice whose finest cells are at most `finest` metres wide, see [`DetailLattice::new`]. What is drawn
    /// stands on [`lattice_of`](crate::blocks::kept::lattice_of) the terrain, which is aligned to maps.
    #[must_use]
    pub fn new(terrain: Terrain, finest: f32) -> Self {
        let lattice = DetailLattice::new(terrain.extent(), finest);
        Self { lattice, terrain }
    }

    /// On a lattice over the terrain's extent.
    #[must_use]
    pub const fn on(terrain: Terrain, lattice: DetailLattice) -> Self {
        Self { lattice, terrain }
    }

    /// The ground.
    #[must_use]
    pub const fn terrain(&self) -> &Terrain {
        &self.terrain
    }

    /// Height of the water, metres; far below everything where there is none.
    #[must_use]
    pub fn sea(&self) -> f32 {
        self.terrain
            .sea_level()
            .unwrap_or(GpuTerrainUniform::NO_SEA)
    }
}
