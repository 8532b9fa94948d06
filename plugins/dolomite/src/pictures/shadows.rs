//! Shadow maps, and which of them were drawn in this frame.

use bevy::core_pipeline::schedule::RootNonCameraView;
use bevy::ecs::prelude::*;
use bevy::ecs::world::EntityRef;
use bevy::pbr::{GlobalClusterableObjectMeta, LightEntity, ViewShadowBindings};
use bevy::render::render_resource::{TextureView, TextureViewDescriptor, TextureViewDimension};
use bevy::render::sync_world::MainEntity;
use bevy::render::view::ExtractedView;
use dolomite_deferred::render::is_kept_face;
use dolomite_inspector::picture::source::{Marks, Source, Way};

/// Of directional and spot lights, which share a texture.
pub const SUNS: Way = Way {
    source: Source::Layers(sun_maps, sun_marks),
    define: "SHADOW_MAPS",
};

/// Of point lights, six faces each.
pub const POINTS: Way = Way {
    source: Source::Layers(point_maps, point_marks),
    define: "POINT_SHADOW_MAPS",
};

fn sun_maps(view: EntityRef) -> Option<TextureView> {
    let bindings = view.get::<ViewShadowBindings>()?;
    Some(bindings.directional_light_depth_texture_view.clone())
}

fn point_maps(view: EntityRef) -> Option<TextureView> {
    let bindings = view.get::<ViewShadowBindings>()?;
    // Bevy's own view is of cubes.
    let faces = TextureViewDescriptor {
        label: Some("dolomite_point_maps"),
        dimension: Some(TextureViewDimension::D2Array),
        ..Default::default()
    };
    Some(bindings.point_light_depth_texture.create_view(&faces))
}

/// Cascades of this view come first, in order; spots are the last layers. Bevy draws all of them in every frame.
fn sun_marks(world: &World, view: Entity) -> Marks {
    let mut marks = Marks::default();
    let (Some(mut lights), Some(main), Some(bindings)) = (
        world.try_query::<(&LightEntity, &ExtractedView)>(),
        world.get::<MainEntity>(view),
        world.get::<ViewShadowBindings>(view),
    ) else {
        return marks;
    };
    let (mut cascades, mut spots) = (0, 0);
    for (light, of_light) in lights.iter(world) {
        match light {
            LightEntity::Directional { .. } => {
                let camera = of_light.retained_view_entity.auxiliary_entity;
                cascades += u32::from(camera == *main);
            }
            LightEntity::Spot { .. } => spots += 1,
            LightEntity::Point { .. } => {}
        }
    }
    let layers = bindings
        .directional_light_depth_texture
        .depth_or_array_layers();
    let spots = layers.saturating_sub(spots)..layers;
    for layer in (0..cascades).chain(spots) {
        marks.drawn(layer);
    }
    marks
}

fn point_marks(world: &World, _: Entity) -> Marks {
    let mut marks = Marks::default();
    let (Some(mut faces), Some(indices)) = (
        world.try_query::<(&LightEntity, &RootNonCameraView)>(),
        world.get_resource::<GlobalClusterableObjectMeta>(),
    ) else {
        return marks;
    };
    for (light, schedule) in faces.iter(world) {
        let LightEntity::Point {
            light_entity,
            face_index,
        } = light
        else {
            continue;
        };
        let Some(index) = indices.entity_to_index.get(light_entity) else {
            continue;
        };
        let layer = (6 * index + face_index) as u32;
        if is_kept_face(schedule) {
            marks.kept(layer);
        } else {
            marks.drawn(layer);
        }
    }
    marks
}
