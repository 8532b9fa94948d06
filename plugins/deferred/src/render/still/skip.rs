//! Gives faces that stay as they are a schedule without systems.

use bevy::core_pipeline::Core3d;
use bevy::core_pipeline::schedule::RootNonCameraView;
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::pbr::{GlobalClusterableObjectMeta, LightEntity, ViewShadowBindings};
use bevy::prelude::*;
use bevy::render::MainWorld;
use bevy::render::render_resource::{PipelineCache, TextureId};
use bevy::render::view::ExtractedView;

use super::stats::StillStats;
use super::watch::Watched;

/// What a face runs that is not drawn: nothing.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub struct StillFace;

/// Frames that a face is drawn in after a change: meshes come to the adapter a frame or two after the entity.
const SETTLE: u8 = 3;

/// A light's part of the shadow maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Map {
    /// Frames that each face is still to be drawn in.
    left: [u8; 6],
    /// Where it lies: the texture, and the light's index in it. None where another light may have been drawn there.
    place: Option<(TextureId, usize)>,
    /// Whether it has faces in this frame: Bevy takes them from lights out of sight.
    seen: bool,
}

/// What the maps hold.
#[derive(Resource, Default)]
pub struct Kept {
    maps: EntityHashMap<Map>,
    /// Whether a face may have [`StillFace`].
    some: bool,
}

/// Takes what is dirty from the main world.
pub fn extract(mut main: ResMut<MainWorld>, mut kept: ResMut<Kept>) {
    let Some(mut watched) = main.get_resource_mut::<Watched>() else {
        return;
    };
    if watched.dirty.is_empty() && kept.maps.is_empty() {
        return;
    }
    let watched = watched.bypass_change_detection();
    kept.maps
        .retain(|light, _| watched.dirty.contains_key(light));
    for (light, dirty) in &mut watched.dirty {
        let map = kept.maps.entry(*light).or_default();
        for (face, left) in map.left.iter_mut().enumerate() {
            if *dirty & (1 << face) != 0 {
                *left = SETTLE;
            }
        }
        *dirty = 0;
    }
}

/// Whether a face is, or was, to be kept.
pub fn wanted(kept: Res<Kept>) -> bool {
    kept.some || !kept.maps.is_empty()
}

/// Whether a face keeps what its map holds in this frame.
#[must_use]
pub fn is_kept_face(face: &RootNonCameraView) -> bool {
    face.0 == StillFace.intern()
}

/// Of all faces of shadow maps that are no camera's.
pub fn skip(
    mut faces: Query<(&LightEntity, &ExtractedView, &mut RootNonCameraView)>,
    bindings: Query<&ViewShadowBindings>,
    indices: Res<GlobalClusterableObjectMeta>,
    pipelines: Res<PipelineCache>,
    stats: Res<StillStats>,
    mut kept: ResMut<Kept>,
) {
    let (drawn, still) = (Core3d.intern(), StillFace.intern());
    let texture = bindings
        .iter()
        .next()
        .map(|bindings| bindings.point_light_depth_texture.id());
    // What is not compiled yet is not drawn.
    let ready = pipelines.waiting_pipelines().next().is_none();
    let mut counts = [0_u32; 2];
    for (light, view, mut root) in &mut faces {
        let LightEntity::Point {
            light_entity,
            face_index,
        } = *light
        else {
            continue;
        };
        let main = view.retained_view_entity.main_entity.id();
        let Some(map) = kept.maps.get_mut(&main) else {
            // It was still once.
            if root.0 == still {
                root.0 = drawn;
            }
            continue;
        };
        map.seen = true;
        let place = texture.zip(indices.entity_to_index.get(&light_entity).copied());
        if place.is_none() || map.place != place {
            map.place = place;
            map.left = [SETTLE; 6];
        }
        let left = &mut map.left[face_index];
        if *left > 0 {
            *left -= u8::from(ready);
            root.0 = drawn;
            counts[0] += 1;
        } else {
            root.0 = still;
            counts[1] += 1;
        }
    }
    for map in kept.maps.values_mut() {
        if !std::mem::take(&mut map.seen) {
            map.place = None;
        }
    }
    kept.some = counts[1] > 0;
    stats.set(counts[0], counts[1]);
}
