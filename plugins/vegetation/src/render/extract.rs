//! What comes from the main world: what grows, who sees it, the sun, the wind.

use std::sync::Arc;

use bevy::ecs::system::SystemParam;
use bevy::math::{DVec2, Vec3Swizzles as _};
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;
use dolomite_terrain::{GroundPoint, Terrain};

use super::far::FarFields;
use super::state::VegetationPool;
use crate::bend::{Press, Presses};
use crate::components::{Vegetation, VegetationState, VegetationView};
use crate::kind::Kinds;
use crate::shade::FarField;
use crate::wind::Wind;

/// A camera that sees what grows, in the render world.
#[derive(Component, Clone, Copy)]
pub struct ExtractedVegetationView;

/// What grows, in the render world: that of the terrain of the lowest entity.
#[derive(Resource, Default)]
pub struct ExtractedVegetation {
    /// The kinds, if any grow.
    pub kinds: Option<Arc<Kinds>>,
    /// Far fields in the order of the kinds, of those that have one; none while they are being fitted.
    pub far: Arc<[Option<FarField>]>,
    /// [`Vegetation::density`].
    pub density: f32,
    /// [`Vegetation::reach`].
    pub reach: f32,
    /// [`Vegetation::seed`].
    pub seed: u32,
    /// World height that heights count from, metres.
    pub sea: f32,
    /// Towards the sun, of length 1; 0 without one.
    pub sun: Vec3,
    /// Wind, if it blows.
    pub wind: Option<Wind>,
    /// Seconds since the app began, of this frame and the last.
    pub time: [f64; 2],
    /// Who presses blades aside, relative to a place of whole metres.
    pub presses: (DVec2, Vec<Press>),
    /// Room of each view.
    pub pool: VegetationPool,
    /// Whether what is outside of a view is left out.
    pub culled: bool,
}

/// Settings of all views, for tests and studies. A resource of the main world.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct VegetationCulling(pub bool);

impl Default for VegetationCulling {
    fn default() -> Self {
        Self(true)
    }
}

type GrownItem<'a> = (
    Entity,
    &'a Vegetation,
    &'a VegetationState,
    Option<&'a Terrain>,
    Option<&'a Wind>,
    Option<&'a FarFields>,
);

/// What else it depends on in the main world.
#[derive(SystemParam)]
pub(super) struct Around<'w, 's> {
    suns: Query<'w, 's, (&'static DirectionalLight, &'static GlobalTransform)>,
    cameras: Query<'w, 's, &'static GlobalTransform, With<VegetationView>>,
    pool: Option<Res<'w, VegetationPool>>,
    culling: Option<Res<'w, VegetationCulling>>,
    time: Option<Res<'w, Time>>,
    presses: Option<Res<'w, Presses>>,
}

pub(super) fn vegetation(
    mut extracted: ResMut<ExtractedVegetation>,
    grown: Extract<Query<GrownItem>>,
    around: Extract<Around>,
) {
    let now = around.time.as_ref();
    let now = now.map_or(0.0, |time| time.elapsed_secs_f64());
    extracted.time = [now, extracted.time[0]];
    let first = grown.iter().min_by_key(|(entity, ..)| entity.index_u32());
    let Some((_, vegetation, state, terrain, wind, fields)) = first else {
        extracted.kinds = None;
        return;
    };
    extracted.kinds.clone_from(&state.kinds);
    extracted.far = fields.map_or_else(Arc::default, |fields| Arc::clone(&fields.fitted));
    extracted.density = vegetation.density;
    extracted.reach = vegetation.reach;
    extracted.seed = vegetation.seed;
    extracted.sea = terrain.and_then(Terrain::sea_level).unwrap_or(0.0);
    extracted.wind = wind.copied();
    let brightest = around.suns.iter();
    let brightest = brightest.max_by(|(a, _), (b, _)| a.illuminance.total_cmp(&b.illuminance));
    extracted.sun = brightest.map_or(Vec3::ZERO, |(_, place)| *place.back());
    extracted.pool = around.pool.as_deref().copied().unwrap_or_default();
    extracted.culled = around.culling.as_deref().copied().unwrap_or_default().0;
    let near = around.cameras.iter().next();
    let near = near.map_or(DVec2::ZERO, |place| {
        place.translation().as_dvec3().xz().floor()
    });
    extracted.presses.0 = near;
    extracted.presses.1 = around
        .presses
        .as_ref()
        .map_or_else(Vec::new, |presses| presses.list(GroundPoint::new(near)));
}

pub(super) fn views(
    mut commands: Commands,
    cameras: Extract<Query<RenderEntity, With<VegetationView>>>,
    mut removed: Extract<RemovedComponents<VegetationView>>,
    entities: Extract<Query<RenderEntity>>,
) {
    for entity in removed
        .read()
        .filter_map(|entity| entities.get(entity).ok())
    {
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.remove::<ExtractedVegetationView>();
        }
    }
    for entity in &cameras {
        commands.entity(entity).insert(ExtractedVegetationView);
    }
}
