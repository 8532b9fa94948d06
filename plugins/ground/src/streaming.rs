//! Maps that are read by tiles have fine samples about the first camera that sees the ground.

use bevy::prelude::*;
use dolomite_terrain::{MapFaults, MapFocus, Terrain};
use dolomite_tessellation::GeometryCamera;

use crate::cover::TerrainView;

/// Tells where fine ground is wanted. A focus that an app has set stays where no camera sees the ground.
pub(crate) fn follow_maps(
    terrains: Query<&Terrain>,
    views: Query<(&GeometryCamera, &GlobalTransform, &Camera), With<TerrainView>>,
    (mut focus, mut faults): (ResMut<MapFocus>, ResMut<MapFaults>),
) {
    if !faults.0.is_empty() {
        for fault in std::mem::take(&mut faults.0) {
            tell!("{fault}");
        }
    }
    if !terrains.iter().any(|terrain| terrain.streamed().is_some()) {
        return;
    }
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
