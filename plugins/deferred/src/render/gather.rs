//! The rows of all point and spot lights, in Bevy's order, so that an index is good for Bevy's shadow maps too.

use bevy::camera::visibility::RenderLayers;
use bevy::log::warn;
use bevy::pbr::{ExtractedDirectionalLight, ExtractedPointLight, GlobalClusterableObjectMeta};
use bevy::prelude::*;
use bevy::render::render_resource::{BufferDescriptor, BufferUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};

use super::lights::Lights;
use super::prepare::ViewLighting;
use crate::choice::{Chosen, Suns};
use crate::components::DeferredLighting;
use crate::light::{Cone, LightRefusal, LightRow, LightSource, Shadows, check_sun};

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
        shadows: Shadows {
            map: light.shadow_maps_enabled,
            contact: light.contact_shadows_enabled,
        },
    }
}

/// Writes the rows where a view is lit by us; drops them where none is.
pub fn gather(
    views: Query<Option<&ViewLighting>, With<DeferredLighting>>,
    suns: Query<&ExtractedDirectionalLight>,
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
    lights.suns = Suns::None;
    if views.is_empty() {
        lights.buffer = None;
        lights.uploaded = Vec::new();
        return;
    }
    for sun in &suns {
        let color = Vec3::from_array([sun.color.red, sun.color.green, sun.color.blue]);
        // Not `back`, whose debug assertions end the app for what is refused here.
        let to_light = Vec3::from(sun.transform.affine().matrix3.z_axis).normalize_or_zero();
        if let Err(refusal) = check_sun(color * sun.illuminance, to_light) {
            refuse(lights, refusal);
            continue;
        }
        let shadows = sun.shadow_maps_enabled || sun.contact_shadows_enabled;
        lights.suns = lights
            .suns
            .max(if shadows { Suns::Shadowed } else { Suns::Open });
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
            Err(refusal) => refuse(lights, refusal),
        }
        if let Some(layers) = layers.filter(|layers| **layers != default) {
            lights.layers.insert(index as u32, layers.clone());
        }
    }
    let reads = |view: &ViewLighting| view.variation.is_some_and(|v| v.chosen != Chosen::Nothing);
    let read = views.iter().flatten().any(reads);
    upload(lights, read, &device, &queue);
}

/// Counts a light that is not drawn, and names the first of each sort.
fn refuse(lights: &mut Lights, refusal: LightRefusal) {
    lights.refused += 1;
    if lights.told.insert(refusal) {
        warn!("a light is not drawn: {refusal}; others like it are not told again");
    }
}

/// Writes what changed; a scene at rest writes nothing. `read` says that a view reads rows: until the pipeline
/// without lights is compiled, it does so where there are none any more.
fn upload(lights: &mut Lights, read: bool, device: &RenderDevice, queue: &RenderQueue) {
    if lights.rows.iter().all(|row| !row.shines()) {
        if read {
            return;
        }
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
