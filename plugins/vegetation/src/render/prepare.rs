//! Which views have something that grows, and what passes and draws are told.

use std::collections::HashMap;

use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::math::{DMat4, Vec3Swizzles as _};
use bevy::pbr::ShadowView;
use bevy::prelude::*;
use bevy::render::camera::TemporalJitter;
use bevy::render::render_resource::PipelineCache;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::view::ExtractedView;
use bytemuck::{Zeroable, bytes_of};
use dolomite_geometry::render::{
    ExtractedGeometryCamera, GeometryView, Matrices, Producer, ProducerKey, Producers, ViewFrame,
};
use dolomite_ground::render::GroundKind;
use dolomite_ground::render::detail::detail_key;
use dolomite_terrain::GroundPoint;

use super::extract::{ExtractedVegetation, ExtractedVegetationView};
use super::layers::{layer, layers, look};
use super::layout::{BladeView, CULL, GrowParams, LISTS, SHADOW_SLOT, SHADOW_VIEWS};
use super::lists::{BLADES, rooms_of, vertices_of};
use super::pipeline::{DrawKey, VegetationPipelines, VegetationShaders};
use super::state::{VegetationPool, ViewState};
use super::stats::VegetationStats;
use crate::bend::Press;
use crate::kind::Kind;
use crate::shade::FarField;
use crate::wind::{Wind, WindField};

/// The producers on whose triangles things grow, in order. A resource of the render world.
///
/// Their vertices have to be stored ([`DrawTraits::evaluated`](dolomite_geometry::render::DrawTraits) is not set): a
/// ground of patches ([`PatchDetail`](dolomite_ground::PatchDetail)) has none.
#[derive(Resource, Clone, Debug)]
pub struct VegetationGrounds(pub Vec<ProducerKey>);

impl Default for VegetationGrounds {
    /// The first terrain that is drawn.
    fn default() -> Self {
        Self(vec![detail_key::<GroundKind<0>>()])
    }
}

/// All views, in the render world.
#[derive(Resource, Default)]
pub struct VegetationViews {
    /// Pipelines, once something grows.
    pub pipelines: Option<VegetationPipelines>,
    /// By view, and by place among the grounds.
    pub views: HashMap<(Entity, usize), ViewState>,
    /// Whether a fault was told of.
    told: bool,
}

/// What the passes of a view are told.
fn params(
    grown: &ExtractedVegetation,
    kinds: &[Kind],
    frame: &ViewFrame,
    (pool, depth_range): (VegetationPool, f32),
) -> Box<GrowParams> {
    let mut params: Box<GrowParams> = Box::new(GrowParams::zeroed());
    params.vertices = vertices_of(layers(kinds));
    (params.rooms, params.bases) = rooms_of(pool.records, params.vertices);
    params.piece_room = pool.pieces;
    params.depth_range = depth_range;
    params.planes = frame.planes;
    params.eye = (frame.position - frame.anchor).as_vec3().to_array();
    params.pixels_per_radian = frame.pixels_per_radian;
    params.anchor = [frame.anchor.x, frame.anchor.z].map(|x| ((x as i64) << 12) as i32);
    params.flags = u32::from(grown.culled) * CULL;
    let drawn = layers(kinds).filter_map(|kind| layer(kind, grown, frame));
    for (slot, layer) in params.layers.iter_mut().zip(drawn) {
        *slot = layer;
        params.layer_count += 1;
    }
    params
}

/// What the draws of a view are told.
fn blade_view(
    grown: &ExtractedVegetation,
    kinds: &[Kind],
    state: &ViewState,
    (frame, matrices): (&ViewFrame, &Matrices),
) -> Box<BladeView> {
    let mut view: Box<BladeView> = Box::new(BladeView::zeroed());
    let from_anchor = |clip: DMat4| {
        (clip * DMat4::from_translation(state.anchor))
            .as_mat4()
            .to_cols_array_2d()
    };
    view.clip = from_anchor(matrices.clip_from_world);
    view.previous_clip = from_anchor(state.previous_clip.unwrap_or(matrices.clip_from_world));
    view.camera = (frame.position - state.anchor).as_vec3().to_array();
    view.sun = grown.sun.to_array();
    view.anchor = [state.anchor.x, state.anchor.z].map(|x| x as i64 as i32);
    view.pixels_per_radian = frame.pixels_per_radian;
    view.water = (f64::from(grown.sea) - state.anchor.y) as f32;
    let still = Wind {
        speed: 0.0,
        swell: 0.0,
        ..Wind::default()
    };
    let anchor = GroundPoint::new(state.anchor.xz());
    let field = |time| WindField::new(&grown.wind.unwrap_or(still), anchor, time);
    [view.wind, view.previous_wind] = grown.time.map(field);
    let (from, presses) = &grown.presses;
    let away = (*from - state.anchor.xz()).as_vec2();
    view.press_count = presses.len().min(view.presses.len()) as u32;
    for (slot, press) in view.presses.iter_mut().zip(presses) {
        let [x, y, z] = press.foot;
        let foot = [x + away.x, y - state.anchor.y as f32, z + away.y];
        *slot = Press { foot, ..*press };
    }
    let drawn = layers(kinds).zip(&state.params.layers);
    for (slot, (kind, layer)) in view.looks.iter_mut().zip(drawn) {
        *slot = look(kind, layer);
    }
    // Of the whole list, where those of meshes have none.
    let known = kinds.iter().zip(grown.far.iter());
    for (slot, kind) in view.far.iter_mut().zip(layers(kinds)) {
        let found = known.clone().find(|(of, _)| std::ptr::eq(*of, kind));
        *slot = found
            .and_then(|(_, far)| *far)
            .unwrap_or_else(FarField::zeroed);
    }
    view
}

type ViewItem<'a> = (
    Entity,
    &'a ExtractedView,
    Option<&'a ViewPrepassTextures>,
    Option<&'a TemporalJitter>,
);

/// The ground of a view: stored triangles of a producer.
fn ground_of(producer: &Producer, view: Entity) -> Option<&GeometryView> {
    let ground = producer.views.get(&view)?;
    (!producer.traits.evaluated && !producer.traits.moves).then_some(ground)
}

/// Makes and drops what views hold, and tells what changed.
pub fn prepare(
    mut vegetation: ResMut<VegetationViews>,
    (grown, grounds): (Res<ExtractedVegetation>, Res<VegetationGrounds>),
    producers: Res<Producers>,
    views: Query<ViewItem, (With<ExtractedVegetationView>, With<ExtractedGeometryCamera>)>,
    lights: Query<&ExtractedView, With<ShadowView>>,
    (shaders, cache): (Res<VegetationShaders>, Res<PipelineCache>),
    (device, queue, stats): (Res<RenderDevice>, Res<RenderQueue>, Res<VegetationStats>),
) {
    let VegetationViews {
        pipelines,
        views: states,
        told,
    } = &mut *vegetation;
    let kinds = grown.kinds.as_ref().map(|kinds| kinds.kinds.as_slice());
    let grows = grown.density > 0.0 && grown.reach > 0.0;
    let kinds = kinds.filter(|kinds| grows && layers(kinds).next().is_some());
    let (Some(kinds), false) = (kinds, views.is_empty()) else {
        states.clear();
        count(&stats, states, pipelines.as_ref());
        return;
    };
    let sources = || {
        grounds.0.iter().enumerate().flat_map(|(place, key)| {
            let producer = producers.get(*key);
            views.iter().filter_map(move |item| {
                let ground = ground_of(producer?, item.0)?;
                Some(((item.0, place), item, (ground, producer?.traits.uv_range)))
            })
        })
    };
    states.retain(|key, _| sources().any(|(known, ..)| known == *key));
    for (key, (_, view, prepass, jitter), (ground, depth_range)) in sources() {
        let Some(draw) = prepass.and_then(DrawKey::new) else {
            continue;
        };
        let pipelines = pipelines.get_or_insert_with(|| VegetationPipelines::new(&shaders, &cache));
        let frame = &ground.frame;
        let vertices = vertices_of(layers(kinds));
        let used = vertices.map(|count| count > 0);
        pipelines.want_draws(draw, used, &cache);
        let state = states
            .entry(key)
            .or_insert_with(|| ViewState::new(&device, grown.pool, vertices));
        let wanted = state.counters.newest.wanted_pieces;
        let pieces = state.pool.pieces.max(grown.pool.pieces);
        // A quarter more than was wanted, so that it seldom grows.
        let pieces = if wanted > pieces {
            (wanted + wanted / 4).min(grown.pool.pieces.saturating_mul(8))
        } else {
            pieces
        };
        let pool = VegetationPool {
            pieces,
            ..grown.pool
        };
        state.fit(&device, pool, vertices);
        let now = params(&grown, kinds, frame, (pool, depth_range));
        if *now != *state.params {
            queue.write_buffer(&state.buffers.params, 0, bytes_of(&*now));
            state.params = now;
            state.due = true;
        }
        state.due |= !ground.settled;
        state.bind(&device, &cache, pipelines, ground);
        let matrices = Matrices::new(view, jitter);
        // What is due is counted from the ground's anchor; what rests is where it was.
        if state.due || !state.grown {
            state.anchor = frame.anchor;
        }
        let told_draws = blade_view(&grown, kinds, state, (frame, &matrices));
        queue.write_buffer(&state.buffers.view, 0, bytes_of(&*told_draws));
        state.previous_clip = Some(matrices.clip_from_world);
        state.shadows.clear();
        let slots = ground.shadows.iter().take(SHADOW_VIEWS);
        for (slot, light) in slots.filter_map(|slot| Some((slot, lights.get(slot.light).ok()?))) {
            let clip = Matrices::new(light, None).clip_from_world;
            let clip = (clip * DMat4::from_translation(state.anchor)).as_mat4();
            let at = SHADOW_SLOT * state.shadows.len() as u64;
            queue.write_buffer(&state.buffers.shadows, at, bytes_of(&clip.to_cols_array()));
            state.shadows.push(slot.light);
        }
        if !state.shadows.is_empty() && used[BLADES] {
            pipelines.want_shadows(&cache);
        }
    }
    if let Some(fault) = pipelines.as_ref().and_then(|known| known.fault(&cache))
        && !std::mem::replace(told, true)
    {
        error!("nothing grows: {fault}");
    }
    count(&stats, states, pipelines.as_ref());
}

fn count(
    stats: &VegetationStats,
    states: &HashMap<(Entity, usize), ViewState>,
    pipelines: Option<&VegetationPipelines>,
) {
    stats.change(|count| {
        count.views = states.len() as u32;
        count.bytes = states.values().map(|state| state.buffers.bytes()).sum();
        count.pipelines = pipelines.map_or(0, VegetationPipelines::count) as u32;
        if states.is_empty() {
            count.records = [0; LISTS];
            count.wanted = 0;
        }
    });
}

/// After the submit: what was counted comes back.
pub fn collect(mut vegetation: ResMut<VegetationViews>, stats: Res<VegetationStats>) {
    for state in vegetation.views.values_mut() {
        state.counters.advance();
    }
    let newest = vegetation.views.values().map(|state| state.counters.newest);
    let Some(newest) = newest.max_by_key(|counts| counts.wanted) else {
        return;
    };
    let rooms = vegetation
        .views
        .values()
        .next()
        .map(|state| state.params.rooms);
    stats.change(|count| {
        count.records = newest.records;
        for (records, room) in count.records.iter_mut().zip(rooms.unwrap_or_default()) {
            *records = (*records).min(room);
        }
        count.looked = newest.looked;
        count.standing = newest.standing;
        count.cut = newest.cut;
        count.wanted = newest.wanted;
        count.pieces = newest.wanted_pieces;
    });
}
