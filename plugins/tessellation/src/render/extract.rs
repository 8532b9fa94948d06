//! Copies from the main world: the terrain with its material, and each view's settings.

use std::sync::Arc;

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;
use dolomite_terrain::{GpuTerrain, Terrain};

use super::relief::TerrainRelief;
use crate::cover::{Cover, clamped};
use crate::plugin::TerrainCover;
use crate::settings::{TerrainMaterial, TerrainView};

/// The terrain that is drawn, if any.
#[derive(Resource, Default)]
pub struct ExtractedTerrain {
    pub current: Option<TerrainData>,
    /// Counts the terrains seen, to know when to upload anew.
    pub version: u64,
    /// Seconds, wrapped at an hour.
    pub time: f32,
    /// Direction that the sunlight travels, where it casts shadows.
    pub sun: Option<Vec3>,
}

pub struct TerrainData {
    entity: Entity,
    pub gpu: Arc<GpuTerrain>,
    pub material: TerrainMaterial,
    pub relief: Option<TerrainRelief>,
    pub sea_level: Option<f32>,
    pub extent_min: DVec2,
    /// Least and greatest height of the ground, metres.
    pub heights: [f32; 2],
}

/// A view that tessellates, in the render world.
#[derive(Component)]
pub struct ExtractedTerrainView {
    pub settings: TerrainView,
    pub cover: Arc<Cover>,
    pub focus: DVec3,
}

pub fn terrain(
    mut extracted: ResMut<ExtractedTerrain>,
    terrains: Extract<
        Query<(
            Entity,
            Ref<Terrain>,
            &TerrainMaterial,
            Option<&TerrainRelief>,
        )>,
    >,
    lights: Extract<Query<(&DirectionalLight, &GlobalTransform)>>,
    time: Extract<Res<Time>>,
) {
    extracted.time = time.elapsed_secs_wrapped();
    extracted.sun = lights
        .iter()
        .filter(|(light, _)| light.shadow_maps_enabled)
        .map(|(_, transform)| *transform.forward())
        .next();
    let Some((entity, terrain, material, relief)) = terrains.iter().next() else {
        extracted.current = None;
        return;
    };
    let known = extracted
        .current
        .as_ref()
        .is_some_and(|current| current.entity == entity);
    if known && !terrain.is_changed() {
        if let Some(current) = &mut extracted.current {
            current.material = material.clone();
            current.relief = relief.cloned();
        }
        return;
    }
    let extent = terrain.extent();
    let bounds = terrain.bounds(&extent);
    extracted.version += 1;
    extracted.current = Some(TerrainData {
        entity,
        gpu: Arc::new(terrain.gpu()),
        material: material.clone(),
        relief: relief.cloned(),
        sea_level: terrain.sea_level(),
        extent_min: extent.min,
        heights: [bounds.min, bounds.max],
    });
}

pub fn views(
    mut commands: Commands,
    views: Extract<Query<(RenderEntity, &TerrainView, &TerrainCover)>>,
    mut removed: Extract<RemovedComponents<TerrainView>>,
    entities: Extract<Query<RenderEntity>>,
) {
    for entity in removed
        .read()
        .filter_map(|entity| entities.get(entity).ok())
    {
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.remove::<ExtractedTerrainView>();
        }
    }
    for (entity, view, cover) in &views {
        commands.entity(entity).insert(ExtractedTerrainView {
            settings: clamped(view),
            cover: cover.cover.clone(),
            focus: cover.focus,
        });
    }
}
