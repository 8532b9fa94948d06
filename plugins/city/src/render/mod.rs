//! The city in the picture, as patches of `dolomite_tessellation` and lights of Bevy's.
//!
//! Near blocks are patches with displacement (`near`), the others records (`far`), and beyond them lies flat ground.
//! Lamps near the camera are lights at night (`lights`). Nothing exists until there is a [`City`].

mod far;
mod kinds;
mod lights;
mod near;
mod params;

use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::camera::Exposure;
use bevy::prelude::*;
use bevy::render::storage::ShaderBuffer;
use dolomite_tessellation::render::PatchPlugin;

pub use far::records_mesh;
pub use kinds::{CityFaces, CityGlobes, CityPosts, CityRecords, FACE_LAYOUT};
pub use lights::CityLamp;
pub use near::{faces_mesh, lamp_meshes};
pub use params::CityParams;

use crate::components::{City, CityBlocks, CityView};
use crate::map::DisplacementMap;
use crate::maps::maps;
use crate::rules::CityRules;
use crate::sets::CitySystems;
use crate::streets::Cell;

/// The maps, once a city was there.
#[derive(Resource, Default)]
struct CityMaps(Arc<Vec<DisplacementMap>>);

/// Adds the render half.
pub(crate) fn build(app: &mut App) {
    app.init_resource::<CityMaps>()
        .init_resource::<near::NearCity>()
        .init_resource::<far::FarCity>()
        .init_resource::<lights::Lit>()
        .add_plugins((
            PatchPlugin(CityFaces::default()),
            PatchPlugin(CityRecords::default()),
            PatchPlugin(CityPosts::default()),
            PatchPlugin(CityGlobes::default()),
        ))
        .add_systems(
            PostUpdate,
            (set_params, near::show_near, far::show_far, lights::light)
                .chain()
                .in_set(CitySystems::Draw)
                .run_if(resource_exists::<Assets<ShaderBuffer>>)
                .run_if(any_with_component::<City>.or_else(any_component_removed::<City>)),
        );
}

/// The city that is drawn: that of the lowest entity which has had good rules.
fn shown_city<'a>(
    cities: &'a Query<(Entity, &City, &CityBlocks, &Transform)>,
) -> Option<(Entity, &'a City, &'a CityBlocks, &'a Transform)> {
    cities
        .iter()
        .filter(|(_, _, blocks, _)| blocks.rules.is_some())
        .min_by_key(|(entity, ..)| entity.index_u32())
}

/// Where the north-western corner of a cell is.
fn cell_corner(rules: Option<&CityRules>, place: &Transform, cell: Cell) -> Transform {
    let pitch = rules.map_or(0.0, |rules| f64::from(rules.pitch));
    let [x, z] = cell.map(|k| (f64::from(k) * pitch) as f32);
    Transform::from_translation(place.translation + Vec3::new(x, 0.0, z))
}

/// All texels, map after map: four a word.
#[must_use]
pub fn map_bytes(maps: &[DisplacementMap]) -> Vec<u8> {
    maps.iter()
        .flat_map(DisplacementMap::texels)
        .copied()
        .collect()
}

/// Writes what the shaders read where it has changed.
fn set_params(
    mut maps_made: ResMut<CityMaps>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
    kinds: (
        ResMut<CityFaces>,
        ResMut<CityRecords>,
        ResMut<CityPosts>,
        ResMut<CityGlobes>,
    ),
    cities: Query<(Entity, &City, &CityBlocks, &Transform)>,
    views: Query<(Entity, &CityView, Option<&Exposure>), Without<City>>,
) {
    let (mut faces, mut records, mut posts, mut globes) = kinds;
    let Some((_, city, blocks, place)) = shown_city(&cities) else {
        return;
    };
    if maps_made.0.is_empty() {
        let made = Arc::new(maps().to_vec());
        let bytes = map_bytes(&made);
        faces.maps = buffers.add(ShaderBuffer::new(&bytes, RenderAssetUsages::RENDER_WORLD));
        maps_made.0 = made;
    }
    let first = views.iter().min_by_key(|(entity, ..)| entity.index_u32());
    let (Some((_, view, exposure)), Some(rules)) = (first, &blocks.rules) else {
        return;
    };
    let exposure = exposure.copied().unwrap_or_default().exposure();
    let ground = place.translation.y;
    let params = CityParams::new(city, rules, &maps_made.0, view, exposure, ground);
    if faces.params != params {
        faces.params = params;
        records.params = params;
        posts.params = params;
        globes.params = params;
    }
}
