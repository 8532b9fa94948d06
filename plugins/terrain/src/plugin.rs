//! The ECS side: height queries for entities, in f64, without a GPU.

use bevy::app::{App, Plugin, PreUpdate};
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::IntoScheduleConfigs;

use crate::probe::{GroundProbe, ProbeBatch};
use crate::streaming::{
    MapFaults, MapFocus, MapStreaming, MapStreamingStats, Reads, any_map_by_tiles, read_tiles,
};

/// Fills every [`GroundProbe`](crate::GroundProbe) from the [`Terrain`](crate::Terrain) of the world.
///
/// Runs under `MinimalPlugins`, with or without the transform plugin. Probes are answered in
/// `PostUpdate` when they moved or were added or the terrain changed; a world without terrain clears
/// them. Transforms are f32, so a probe's place is: 1e4 m from the origin it is known to 1 mm.
///
/// At most [`ProbeBatch::per_frame`](crate::ProbeBatch::per_frame) probes are answered in a frame; a
/// greater crowd takes turns. What is drawn under them comes in by
/// [`ProbeBatch::fill`](crate::ProbeBatch::fill), if a renderer hands it in.
///
/// Added again it does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct TerrainPlugin;

/// Says that the plugin was added.
#[derive(Resource)]
struct Added;

impl Plugin for TerrainPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<Added>() {
            return;
        }
        app.insert_resource(Added)
            .register_type::<GroundProbe>()
            .register_type::<ProbeBatch>()
            .register_type::<MapStreaming>()
            .register_type::<MapFocus>()
            .register_type::<MapStreamingStats>()
            .register_type::<MapFaults>()
            .init_resource::<MapStreaming>()
            .init_resource::<MapFocus>()
            .init_resource::<MapFaults>()
            .init_resource::<MapStreamingStats>()
            .init_resource::<Reads>()
            .add_systems(PreUpdate, read_tiles.run_if(any_map_by_tiles));
        crate::probe::build(app);
    }

    fn is_unique(&self) -> bool {
        false
    }
}
