//! What of a kind comes into the render world: its ground, and who sees it.

use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;
use dolomite_geometry::GeometryCamera;
use dolomite_geometry::budget::Budget;
use dolomite_terrain::Terrain;

use super::DetailKind;
use crate::detail::{MakingBudget, TerrainLod};
use crate::render::tiles::Tiles;

/// The ground of a kind, in the render world.
#[derive(Resource)]
pub(in crate::render) struct ExtractedGround<K> {
    /// The newest resource, until it is bound.
    pub(super) kind: Option<K>,
    /// Whether it has just changed.
    pub(super) newer: bool,
    pub(in crate::render) terrain: Option<Terrain>,
    /// Of a map that is read by tiles, what has arrived of it.
    pub(in crate::render) tiles: Option<Tiles>,
    /// From the lowest to the highest ground, metres.
    pub(in crate::render) relief: f32,
    /// Whether the CPU chooses and places.
    pub(in crate::render) on_host: bool,
    /// How many blocks a frame makes.
    pub(in crate::render) making: MakingBudget,
    /// Bytes of its data on the GPU.
    pub(in crate::render) data_bytes: u64,
    /// Who sees it, and how.
    pub(in crate::render) cameras: Vec<(Entity, TerrainLod)>,
    /// Those of them whose vertices are counted, for their budgets.
    pub(in crate::render) counted: Vec<Entity>,
}

impl<K> Default for ExtractedGround<K> {
    fn default() -> Self {
        Self {
            kind: None,
            newer: false,
            terrain: None,
            tiles: None,
            relief: 0.0,
            on_host: false,
            making: MakingBudget::default(),
            data_bytes: 0,
            cameras: Vec::new(),
            counted: Vec::new(),
        }
    }
}

type Seeing<'a> = (
    RenderEntity,
    Option<&'a TerrainLod>,
    Option<&'a RenderLayers>,
    Has<Budget>,
);

pub(super) fn extract<K: DetailKind>(
    mut ground: ResMut<ExtractedGround<K>>,
    kind: Extract<Option<Res<K>>>,
    making: Extract<Option<Res<MakingBudget>>>,
    cameras: Extract<Query<Seeing, (With<GeometryCamera>, K::Cameras)>>,
) {
    ground.cameras.clear();
    ground.counted.clear();
    ground.making = making.as_ref().map(|making| **making).unwrap_or_default();
    let Some(kind) = kind.as_ref() else {
        ground.terrain = None;
        ground.tiles = None;
        ground.data_bytes = 0;
        return;
    };
    if kind.is_changed() {
        ground.kind = Some((**kind).clone());
        ground.newer = true;
    }
    let same = match (&ground.terrain, kind.ground()) {
        (Some(known), Some(terrain)) => known.same(terrain),
        (known, terrain) => known.is_none() && terrain.is_none(),
    };
    if !same {
        ground.terrain = kind.ground().cloned();
    }
    let known = ground.tiles.take();
    ground.tiles = ground
        .terrain
        .as_ref()
        .and_then(|terrain| Tiles::extract(known, terrain));
    ground.relief = kind.relief();
    ground.on_host = kind.on_host();
    ground.data_bytes = kind.data_bytes();
    if kind.is_shown() {
        let layers = kind.layers();
        let seen = cameras
            .iter()
            .filter(|(_, _, own, _)| own.unwrap_or(&RenderLayers::default()).intersects(&layers));
        for (entity, detail, _, budget) in seen {
            // Who has lost its detail sees the ground by the default.
            let detail = detail.copied().unwrap_or_default();
            ground.cameras.push((entity, detail.clamped()));
            if budget {
                ground.counted.push(entity);
            }
        }
    }
}
