//! Maps that are read by tiles have fine samples about the first camera that sees the ground.

use bevy::prelude::*;
use dolomite_terrain::MapFaults;
#[cfg(feature = "render")]
use {
    crate::cover::TerrainView,
    dolomite_terrain::{MapFocus, Terrain},
    dolomite_tessellation::GeometryCamera,
};

/// Whether there is anything to tell.
pub(crate) fn any_faults(faults: Res<MapFaults>) -> bool {
    !faults.0.is_empty()
}

/// Tells what went wrong while tiles were read, and takes it out.
pub(crate) fn tell_faults(mut faults: ResMut<MapFaults>) {
    for fault in std::mem::take(&mut faults.0) {
        tell!("{fault}");
    }
}

/// Whether any terrain has such a map.
#[cfg(feature = "render")]
pub(crate) fn any_map_by_tiles(terrains: Query<&Terrain>) -> bool {
    terrains.iter().any(|terrain| terrain.streamed().is_some())
}

/// Tells where fine ground is wanted. A focus that an app has set stays where no camera sees the ground, and always
/// without the feature `render`, as there are no cameras then.
#[cfg(feature = "render")]
pub(crate) fn follow_maps(
    views: Query<(&GeometryCamera, &GlobalTransform, &Camera), With<TerrainView>>,
    mut focus: ResMut<MapFocus>,
) {
    let first = views
        .iter()
        .filter(|(_, _, camera)| camera.is_active)
        .min_by_key(|(_, _, camera)| camera.order);
    let Some((camera, transform, _)) = first else {
        return;
    };
    let place = camera
        .focus
        .unwrap_or_else(|| transform.translation().as_dvec3());
    if place.is_finite() {
        focus.set_if_neq(MapFocus(Some(place.xz())));
    }
}
