//! What comes from the main world: cameras, time, the sun.

use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;

use crate::GeometryCamera;

/// A camera that sees what producers make, in the render world.
#[derive(Component, Clone)]
pub struct ExtractedGeometryCamera {
    /// Its settings.
    pub settings: GeometryCamera,
    /// The camera in the main world.
    pub main: Entity,
    /// What entities that one camera alone sees name it by; see [`camera_number`].
    pub number: f32,
    /// Layers that it sees.
    pub layers: RenderLayers,
}

/// A number above 0 for a camera, exact as f32: entity indices stay below 2²⁴.
#[must_use]
pub fn camera_number(camera: Entity) -> f32 {
    (camera.index_u32() + 1) as f32
}

/// What all producers share.
#[derive(Resource, Default)]
pub struct GeometryScene {
    /// Seconds, wrapped at an hour, of this frame and the last.
    pub time: [f32; 2],
    /// Direction that the sunlight travels, where it casts shadows: of several such lights that of the lowest entity.
    pub sun: Option<Vec3>,
}

type LightItem<'a> = (
    Entity,
    &'a DirectionalLight,
    &'a GlobalTransform,
    Option<&'a InheritedVisibility>,
);

pub(super) fn scene(
    mut scene: ResMut<GeometryScene>,
    time: Extract<Option<Res<Time>>>,
    lights: Extract<Query<LightItem>>,
    cameras: Extract<Query<(), With<GeometryCamera>>>,
    mut told: Local<bool>,
) {
    let now = time
        .as_ref()
        .map_or(0.0, |time| time.elapsed_secs_wrapped());
    scene.time = [now, scene.time[0]];
    let mut casting: Vec<_> = lights
        .iter()
        .filter(|(_, light, _, visibility)| {
            light.shadow_maps_enabled && visibility.is_none_or(|seen| seen.get())
        })
        .map(|(entity, _, transform, _)| (entity, *transform.forward()))
        .collect();
    // Queries have no order of their own.
    casting.sort_by_key(|(entity, _)| entity.index_u32());
    scene.sun = casting.first().map(|(_, travels)| *travels);
    if let [(first, _), others @ ..] = casting.as_slice()
        && !others.is_empty()
        && !cameras.is_empty()
        && !std::mem::replace(&mut *told, true)
    {
        let others: Vec<Entity> = others.iter().map(|(entity, _)| *entity).collect();
        warn!(
            "of several lights with shadows {first} decides what beside a camera's picture is kept for its shadows; \
             those of {others:?} may lack what stands there"
        );
    }
}

pub(super) fn cameras(
    mut commands: Commands,
    cameras: Extract<Query<(Entity, RenderEntity, &GeometryCamera, Option<&RenderLayers>)>>,
    mut removed: Extract<RemovedComponents<GeometryCamera>>,
    entities: Extract<Query<RenderEntity>>,
) {
    for entity in removed
        .read()
        .filter_map(|entity| entities.get(entity).ok())
    {
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.remove::<ExtractedGeometryCamera>();
        }
    }
    for (main, entity, settings, layers) in &cameras {
        commands.entity(entity).insert(ExtractedGeometryCamera {
            settings: settings.clone(),
            main,
            number: camera_number(main),
            layers: layers.cloned().unwrap_or_default(),
        });
    }
}
