//! What moved within the reach of still lights.

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{NoFrustumCulling, RenderLayers, VisibilityRange};
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::light::{NotShadowCaster, PointLightShadowMap};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use super::faces::{ALL, Ball, that_see};
use crate::components::StillShadows;

/// What a light's map depends on besides its casters.
#[derive(Clone, Debug, PartialEq)]
struct Light {
    place: Vec3,
    range: f32,
    near: f32,
    casts: bool,
    redraw: u32,
    layers: Option<RenderLayers>,
}

/// Still lights and what casts shadows.
#[derive(Resource, Default)]
pub struct Watched {
    /// Of each light the faces that are to be drawn, since the last extraction.
    pub dirty: EntityHashMap<u8>,
    lights: EntityHashMap<Light>,
    /// Where casters were when maps were drawn last.
    casters: EntityHashMap<Ball>,
}

/// Whether there is, or was, a still light.
pub fn wanted(lights: Query<(), With<StillShadows>>, watched: Res<Watched>) -> bool {
    !(lights.is_empty() && watched.lights.is_empty())
}

/// What is asked of a caster.
type Caster = (
    &'static GlobalTransform,
    Option<&'static Aabb>,
    &'static InheritedVisibility,
    Has<NoFrustumCulling>,
);

/// What casts shadows.
type Casts = (With<Mesh3d>, Without<NotShadowCaster>);

/// What tells that a caster is another.
type Moved = Or<(
    Changed<GlobalTransform>,
    Changed<Mesh3d>,
    Changed<Aabb>,
    Changed<InheritedVisibility>,
    Changed<RenderLayers>,
    Added<NotShadowCaster>,
    Added<NoFrustumCulling>,
)>;

/// What may be another in every frame.
type Restless = Or<(
    With<SkinnedMesh>,
    With<MorphWeights>,
    With<MeshMorphWeights>,
    With<VisibilityRange>,
)>;

/// What was taken from entities.
#[derive(bevy::ecs::system::SystemParam)]
pub struct Gone<'w, 's> {
    meshes: RemovedComponents<'w, 's, Mesh3d>,
    not_casting: RemovedComponents<'w, 's, NotShadowCaster>,
    not_culled: RemovedComponents<'w, 's, NoFrustumCulling>,
    layers: RemovedComponents<'w, 's, RenderLayers>,
    ranges: RemovedComponents<'w, 's, VisibilityRange>,
}

impl Gone<'_, '_> {
    fn read(&mut self) -> EntityHashSet {
        let all = self.meshes.read();
        all.chain(self.not_casting.read())
            .chain(self.not_culled.read())
            .chain(self.layers.read())
            .chain(self.ranges.read())
            .collect()
    }
}

/// Finds the faces that are to be drawn.
pub fn watch(
    lights: Query<(
        Entity,
        &PointLight,
        &GlobalTransform,
        &StillShadows,
        Option<&RenderLayers>,
    )>,
    casters: Query<Caster, Casts>,
    all: Query<Entity, Casts>,
    moved: Query<Entity, (With<Mesh3d>, Moved)>,
    restless: Query<Entity, (Casts, Restless)>,
    mut gone: Gone,
    mut remade: MessageReader<AssetEvent<Mesh>>,
    map: Option<Res<PointLightShadowMap>>,
    mut watched: ResMut<Watched>,
) {
    let watched = &mut *watched;
    let remade = remade
        .read()
        .any(|event| matches!(event, AssetEvent::Modified { .. }));
    let everything = remade || map.is_some_and(|map| map.is_changed());
    let first = watched.lights.is_empty();
    let mut now = EntityHashMap::default();
    for (entity, light, place, still, layers) in &lights {
        let light = Light {
            place: place.translation(),
            range: light.range,
            near: light.shadow_map_near_z,
            casts: light.shadow_maps_enabled,
            redraw: still.redraw,
            layers: layers.cloned(),
        };
        let same = !everything && watched.lights.get(&entity) == Some(&light);
        *watched.dirty.entry(entity).or_default() |= if same { 0 } else { ALL };
        now.insert(entity, light);
    }
    watched.lights = now;
    watched
        .dirty
        .retain(|entity, _| watched.lights.contains_key(entity));
    if watched.lights.is_empty() {
        watched.casters.clear();
        return;
    }
    let mut other = gone.read();
    if first {
        // All faces are drawn; from now on each caster is known.
        watched.casters.clear();
        other.extend(&all);
    } else {
        other.extend(&moved);
        other.extend(&restless);
    }
    for entity in other {
        let ball = casters
            .get(entity)
            .ok()
            .filter(|(_, _, visible, _)| visible.get())
            .map(|(place, aabb, _, uncut)| match aabb {
                Some(aabb) if !uncut => Ball::around(aabb, &place.affine()),
                _ => Ball::EVERYWHERE,
            });
        let before = match ball {
            Some(ball) => watched.casters.insert(entity, ball),
            None => watched.casters.remove(&entity),
        };
        for ball in [before, ball].into_iter().flatten() {
            for (entity, light) in &watched.lights {
                if let Some(dirty) = watched.dirty.get_mut(entity) {
                    *dirty |= that_see(light.place, light.range, &ball);
                }
            }
        }
    }
}
