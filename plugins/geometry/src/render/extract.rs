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
    /// Direction that the sunlight travels, where it casts shadows.
    pub sun: Option<Vec3>,
}

pub(super) fn scene(
    mut scene: ResMut<GeometryScene>,
    time: Extract<Option<Res<Time>>>,
    lights: Extract<Query<(&DirectionalLight, &GlobalTransform)>>,
) {
    let now = time
        .as_ref()
        .map_or(0.0, |time| time.elapsed_secs_wrapped());
    scene.time = [now, scene.time[0]];
    scene.sun = lights
        .iter()
        .filter(|(light, _)| light.shadow_maps_enabled)
        .map(|(_, transform)| *transform.forward())
        .next();
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
