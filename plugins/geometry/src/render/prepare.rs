//! Pools of each producer in each view, and what the draws are told in a frame.

use bevy::math::{DMat4, DVec3};
use bevy::pbr::{ShadowView, ViewLightEntities};
use bevy::prelude::*;
use bevy::render::camera::TemporalJitter;
use bevy::render::render_resource::{BufferInitDescriptor, BufferUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::view::ExtractedView;
use bytemuck::{bytes_of, cast_slice};

use super::camera::Matrices;
use super::extract::{ExtractedGeometryCamera, GeometryScene};
use super::material::rows;
use super::producer::Producers;
use super::space::{ViewFrame, from_anchor};
use super::view::{GeometryView, ShadowSlot};
use crate::layout::{DRAW_SLOT, FILL, GeometryDraw, LINES};

/// How far the camera may go from the anchor of a producer that nothing moves, metres: an f32 still has
/// a quarter of a millimetre there.
const STILL_REACH: f64 = 4096.0;

type ViewItem<'a> = (
    &'a ExtractedView,
    &'a ExtractedGeometryCamera,
    Option<&'a ViewLightEntities>,
    Option<&'a TemporalJitter>,
);

/// Makes and drops pools as producers want them, and writes the uniforms of the draws.
pub fn views(
    mut producers: ResMut<Producers>,
    scene: Res<GeometryScene>,
    views: Query<ViewItem>,
    shadow_views: Query<&ExtractedView, With<ShadowView>>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    mut clips: Local<Vec<DMat4>>,
) {
    for (number, producer) in (0..).zip(producers.iter_mut()) {
        let wanted = &producer.wanted;
        producer.views.retain(|entity, _| {
            wanted.iter().any(|(view, _)| view == entity) && views.contains(*entity)
        });
        if wanted.is_empty() {
            producer.material_rows = None;
            continue;
        }
        if producer.materials_changed || producer.material_rows.is_none() {
            let table = rows(&producer.materials);
            match &producer.material_rows {
                Some(buffer) => queue.write_buffer(buffer, 0, cast_slice(&table)),
                None => {
                    producer.material_rows =
                        Some(device.create_buffer_with_data(&BufferInitDescriptor {
                            label: Some("geometry_materials"),
                            contents: cast_slice(&table),
                            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                        }));
                    for state in producer.views.values_mut() {
                        state.groups = None;
                    }
                }
            }
            producer.materials_changed = false;
        }
        for (entity, pool) in &producer.wanted {
            let Ok((view, camera, lights, jitter)) = views.get(*entity) else {
                continue;
            };
            let traits = &producer.traits;
            let matrices = Matrices::new(view, jitter);
            let kept = producer.views.get(entity).map(|state| state.frame.anchor);
            let near = |anchor: &DVec3| anchor.distance(matrices.position) < STILL_REACH;
            let anchor = match kept.filter(near) {
                Some(anchor) if producer.still => anchor,
                _ => matrices.position.floor(),
            };
            let frame = ViewFrame::new(view, &matrices, anchor, camera, &scene);
            let state = producer
                .views
                .entry(*entity)
                .or_insert_with(|| GeometryView::new(&device, frame, *pool, traits));
            if state.pool != *pool {
                *state = GeometryView::new(&device, frame, *pool, traits);
            }
            state.frame = frame;
            let mut main = GeometryDraw {
                clip_from_anchor: from_anchor(matrices.clip_from_world, anchor),
                previous_clip_from_anchor: from_anchor(
                    state.previous_clip.unwrap_or(matrices.clip_from_world),
                    anchor,
                ),
                camera: (matrices.position - anchor).as_vec3().to_array(),
                time: scene.time[0],
                anchor: anchor.as_vec3().to_array(),
                uv_range: traits.uv_range,
                viewport: frame.size.to_array(),
                flags: u32::from(camera.settings.fill) * FILL
                    + u32::from(camera.settings.lines) * LINES,
                producer: number,
                numbers: producer.numbers.as_ref().map_or([[0.0; 4]; 4], |numbers| {
                    numbers(&frame.viewpoint()).map(|n| n.to_array())
                }),
            };
            state.shown = [camera.settings.fill, camera.settings.lines];
            state.previous_clip = Some(matrices.clip_from_world);
            let lights = lights
                .into_iter()
                .flat_map(|lights| lights.lights.iter().copied())
                .filter(|_| traits.shadows);
            state.shadows.clear();
            clips.clear();
            for light in lights {
                let Ok(shadow) = shadow_views.get(light) else {
                    continue;
                };
                clips.push(Matrices::new(shadow, None).clip_from_world);
                let offset = (clips.len() as u64 * DRAW_SLOT) as u32;
                state.shadows.push(ShadowSlot { light, offset });
            }
            state.fit_slots(&device, clips.len() as u64 + 1);
            queue.write_buffer(&state.draw, 0, bytes_of(&main));
            for (slot, clip) in state.shadows.iter().zip(&mut *clips) {
                main.clip_from_anchor = from_anchor(*clip, anchor);
                queue.write_buffer(&state.draw, u64::from(slot.offset), bytes_of(&main));
                *clip *= DMat4::from_translation(anchor);
            }
            if let Some(ranges) = &mut state.ranges {
                ranges.update(&device, &queue, &clips);
            }
        }
    }
}
