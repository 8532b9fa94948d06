//! When the systems of the ground run.

use bevy::prelude::*;

/// What runs when in the main world, beside [`TerrainCoverSystems`](crate::TerrainCoverSystems). All but the
/// budget's needs the `render` feature and a render app.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GroundSystems {
    /// Schedule `Update`: textures and relief maps are begun, taken over when they are done, and dropped. Change
    /// materials and textures before, and they are drawn with in the same frame.
    Make,
    /// Schedule `PostUpdate`, after [`BudgetSystems`](crate::detail::budget::BudgetSystems): tolerances that were
    /// decided are written into each [`TerrainLod`](crate::detail::TerrainLod).
    Budget,
    /// Schedule `PostUpdate`, after [`TerrainCoverSystems`](crate::TerrainCoverSystems): what is drawn takes over
    /// terrains, materials, seas and relief maps that changed.
    Follow,
    /// Behind it: each camera with a [`PatchDetail`](crate::PatchDetail) gets its patches as entities.
    Place,
}
