//! The rows of all point and spot lights, in Bevy's order, so that an index is good for Bevy's shadow maps too.

use std::collections::HashSet;

use bevy::camera::visibility::RenderLayers;
use bevy::log::warn;
use bevy::pbr::{ExtractedPointLight, GlobalClusterableObjectMeta};
use bevy::prelude::*;
use bevy::render::render_resource::{Buffer, BufferDescriptor, BufferUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};

use crate::components::DeferredLighting;
use crate::light::{Cone, LightRefusal, LightRow, LightSource};

/// All lights of the world.
#[derive(Resource, Default)]
pub struct Lights {
    /// By Bevy's index.
    pub rows: Vec<LightRow>,
    /// Layers of those that are not on the default one alone.
    pub layers: bevy::platform::collections::HashMap<u32, RenderLayers>,
    /// `rows` on the GPU; `None` while there are none.
    pub buffer: Option<Buffer>,
    /// What the buffer holds.
    uploaded: Vec<LightRow>,
    /// Refusals that were told.
    told: HashSet<LightRefusal>,
    /// How many lights are refused.
    pub refused: u32,
}

fn source(light: &ExtractedPointLight) -> LightSource {
    let color = Vec3::from_array([light.color.red, light.color.green, light.color.blue]);
    LightSource {
        position: light.transform.translation(),
        range: light.range,
        intensity: color * light.intensity,
        radius: light.radius,
        cone: light.spot_light_angles.map(|(inner, outer)| Cone {
            direction: light.transform.forward().into(),
            inner,
            outer,
        }),
    }
}

/// Writes the rows where a view is lit by us; drops them where none is.
pub fn gather(
    views: Query<(), With<DeferredLighting>>,
    extracted: Query<(Entity, &ExtractedPointLight, Option<&RenderLayers>)>,
    meta: Res<GlobalClusterableObjectMeta>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    mut lights: ResMut<Lights>,
) {
    let lights = &mut *lights;
    lights.rows.clear();
    lights.layers.clear();
    lights.refused = 0;
    if views.is_empty() {
        lights.buffer = None;
        lights.uploaded = Vec::new();
        return;
    }
    lights
        .rows
        .resize(meta.entity_to_index.len(), LightRow::default());
    let default = RenderLayers::default();
    for (entity, light, layers) in &extracted {
        let Some(index) = meta.entity_to_index.get(&entity).copied() else {
            continue;
        };
        let Some(row) = lights.rows.get_mut(index) else {
            continue;
        };
        match LightRow::new(&source(light)) {
            Ok(good) => *row = good,
            Err(refusal) => {
                lights.refused += 1;
                if lights.told.insert(refusal) {
                    warn!("a light is not drawn: {refusal}; others like it are not told again");
                }
            }
        }
        if let Some(layers) = layers.filter(|layers| **layers != default) {
            lights.layers.insert(index as u32, layers.clone());
        }
    }
    upload(lights, &device, &queue);
}

/// Writes what changed; a scene at rest writes nothing.
fn upload(lights: &mut Lights, device: &RenderDevice, queue: &RenderQueue) {
    if lights.rows.iter().all(|row| !row.shines()) {
        lights.buffer = None;
        lights.uploaded.clear();
        return;
    }
    if lights.buffer.is_some() && lights.rows == lights.uploaded {
        return;
    }
    let bytes: &[u8] = bytemuck::cast_slice(&lights.rows);
    let size = bytes.len() as u64;
    let fits = lights
        .buffer
        .as_ref()
        .is_some_and(|buffer| buffer.size() >= size && buffer.size() <= 4 * size);
    if !fits {
        lights.buffer = Some(device.create_buffer(&BufferDescriptor {
            label: Some("dolomite_deferred_lights"),
            size: size.next_power_of_two(),
            usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        }));
    }
    if let Some(buffer) = &lights.buffer {
        queue.write_buffer(buffer, 0, bytes);
    }
    lights.uploaded.clone_from(&lights.rows);
}
