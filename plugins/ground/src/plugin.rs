//! The plugin.

use bevy::prelude::*;
use bevy::transform::TransformSystems;

use crate::cover::{PatchBounds, PatchDetail, TerrainCoverSystems, TerrainView, update_covers};
use crate::detail::budget::{Budget, DetailBudgetPlugin};
use crate::detail::{DrawnProbes, MakingBudget, TerrainLod};
use crate::idle_budget;
use crate::inspection::GroundInspection;
use crate::material::{GroundCanopy, GroundMaterial, GroundShading, MaterialBands, Sea};
use crate::sets::GroundSystems;
use crate::shown::{ShownTerrains, follow_terrains};
use crate::streaming::{any_faults, tell_faults};
use dolomite_terrain::TerrainPlugin;

/// Draws every visible [`Terrain`](dolomite_terrain::Terrain) that has a [`GroundMaterial`], for every camera that
/// carries a [`TerrainView`].
///
/// Under `MinimalPlugins` it keeps each camera's [`TerrainCover`](crate::TerrainCover); with the `render`
/// feature and a render app it also refines and draws. Without a terrain, or without a `TerrainView`, it
/// creates no image, no pipeline and no buffer and runs no pass.
///
/// It brings the [`TerrainPlugin`] along, which answers height queries. It may be added before Bevy's plugins or
/// after them; added again it does nothing, and the settings of the first time count.
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
        if app.world().contains_resource::<ShownTerrains>() {
            return;
        }
        app.register_type::<TerrainView>()
            .register_type::<TerrainLod>()
            .register_type::<PatchDetail>()
            .register_type::<GroundMaterial>()
            .register_type::<GroundShading>()
            .register_type::<MaterialBands>()
            .register_type::<Sea>()
            .register_type::<GroundCanopy>()
            .register_type::<DrawnProbes>()
            .register_type::<GroundInspection>()
            .register_type::<MakingBudget>();
        app.init_resource::<PatchBounds>()
            .init_resource::<MakingBudget>()
            .init_resource::<ShownTerrains>()
            .configure_sets(
                PostUpdate,
                (
                    TerrainCoverSystems.after(TransformSystems::Propagate),
                    GroundSystems::Follow,
                    GroundSystems::Place,
                )
                    .chain(),
            )
            .add_systems(
                PostUpdate,
                (
                    (follow_terrains, update_covers)
                        .chain()
                        .in_set(TerrainCoverSystems),
                    tell_faults.run_if(any_faults),
                ),
            )
            .add_systems(
                PostUpdate,
                idle_budget::tell
                    .in_set(GroundSystems::Budget)
                    .run_if(any_with_component::<Budget>),
            );
        app.add_plugins((TerrainPlugin, DetailBudgetPlugin));
        #[cfg(feature = "render")]
        crate::render::build(app, self.relief_side);
    }

    #[cfg(feature = "render")]
    fn finish(&self, app: &mut App) {
        crate::render::finish(app);
    }

    fn is_unique(&self) -> bool {
        false
    }
}
