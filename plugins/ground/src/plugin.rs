//! The plugin.

use bevy::prelude::*;

use crate::cover::{PatchBounds, TerrainCoverSystems, update_covers};
use crate::shown::{ShownTerrains, follow_terrains};

/// Draws every visible [`Terrain`](dolomite_terrain::Terrain) that has a
/// [`GroundMaterial`](crate::GroundMaterial), for every camera that carries a
/// [`TerrainView`](crate::TerrainView).
///
/// Under `MinimalPlugins` it keeps each camera's [`TerrainCover`](crate::TerrainCover); with the `render`
/// feature and a render app it also refines and draws. Without a terrain, or without a `TerrainView`, it
/// creates no pipeline and no buffer and runs no pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroundPlugin {
    /// Side of the relief map of a terrain, texels, a power of two from 64 to 8192 (rounded up); 0: none. It
    /// keeps the slopes and the openness to the sky of ground whose triangles are larger than its texels.
    /// Default 2048: 43 MiB of the GPU a terrain; it is made on all cores in the background.
    pub relief_side: u32,
}

impl Default for GroundPlugin {
    fn default() -> Self {
        Self { relief_side: 2048 }
    }
}

impl Plugin for GroundPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PatchBounds>()
            .init_resource::<ShownTerrains>()
            .add_systems(
                PostUpdate,
                (follow_terrains, update_covers)
                    .chain()
                    .in_set(TerrainCoverSystems)
                    .after(bevy::transform::TransformSystems::Propagate),
            );
        app.add_plugins(crate::detail::budget::DetailBudgetPlugin);
        #[cfg(feature = "render")]
        crate::render::build(app, self.relief_side);
    }

    #[cfg(feature = "render")]
    fn finish(&self, app: &mut App) {
        crate::render::finish(app);
    }
}
