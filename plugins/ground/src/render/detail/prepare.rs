//! Which views choose their ground, and what of them is made or told anew.

use std::collections::HashMap;
use std::marker::PhantomData;
use std::sync::Arc;

use bevy::ecs::system::{StaticSystemParam, SystemParamItem};
use bevy::prelude::*;
use bevy::render::render_resource::{
    AsBindGroup, AsBindGroupError, BindingResources, Buffer, OwnedBindingResource, PipelineCache,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::view::ExtractedView;

use super::counted::Counted;
use super::pipeline::DetailPipelines;
use super::state::DetailState;
use super::store::{CellStore, capacity_for};
use super::view::{detail_view, picture};
use super::{DetailKind, DetailShaders, ExtractedGround, detail_key, host};
use crate::blocks::kept::lattice_of;
use crate::blocks::layout::least_pools;
use crate::detail::layout::{HEAD_USED, without};
use crate::detail::{Choice, DetailLattice, Metric, TerrainLod};
use crate::render::pools::PoolRooms;
use crate::render::told::is_news;
use dolomite_geometry::layout::OWN;
use dolomite_geometry::render::{GeometryPool, GeometryShared, GeometryView, Producer, Producers};
use dolomite_terrain::Terrain;

/// Every view that chooses its ground, and what all have in common.
#[derive(Resource)]
pub struct DetailViews<K> {
    pub(super) pipelines: Option<DetailPipelines>,
    pub(super) views: HashMap<Entity, DetailState>,
    /// The cells that views share, by the bits of the side of their smallest.
    pub(super) stores: HashMap<u32, CellStore>,
    /// Whether the bind group is older than the kind's data.
    pub(super) data_due: bool,
    /// What the height function reads: layers, their data, uniform.
    pub(in crate::render) ground: Option<[Buffer; 3]>,
    kind: PhantomData<fn() -> K>,
}

impl<K> Default for DetailViews<K> {
    fn default() -> Self {
        Self {
            pipelines: None,
            views: HashMap::new(),
            stores: HashMap::new(),
            data_due: true,
            ground: None,
            kind: PhantomData,
        }
    }
}

impl<K> DetailViews<K> {
    /// Whether what the height function reads is older than the kind's data.
    pub(in crate::render) const fn is_data_due(&self) -> bool {
        self.data_due
    }

    /// The lattice of a view's ground, and the metric of its newest choice.
    pub(in crate::render) fn lattice(&self, view: Entity) -> Option<(&DetailLattice, Metric)> {
        let detail = self.views.get(&view)?.detail;
        let store = self.stores.get(&detail.finest.to_bits())?;
        Some((&store.ground.lattice, detail.metric))
    }

    /// The metric of a view's newest choice.
    pub(in crate::render) fn metric(&self, view: Entity) -> Option<Metric> {
        self.views.get(&view).map(|own| own.detail.metric)
    }
}

/// The stores that the cameras need: one for each size of the smallest cell, as large as the greatest view of it asks
/// for. Whether their ground was edited.
fn keep_stores(
    stores: &mut HashMap<u32, CellStore>,
    terrain: &Terrain,
    cameras: &[(Entity, TerrainLod)],
    device: &RenderDevice,
    queue: &RenderQueue,
) -> bool {
    let mut wanted: HashMap<u32, u32> = HashMap::new();
    for (_, detail) in cameras {
        let room = capacity_for(device, detail);
        let most = wanted.entry(detail.finest.to_bits()).or_default();
        *most = room.max(*most);
    }
    let mut edited = false;
    stores.retain(|finest, store| {
        wanted.get(finest) == Some(&store.capacity)
            && store
                .follow_edits(queue, terrain)
                .inspect(|changed| edited |= changed)
                .is_some()
    });
    for (finest, capacity) in wanted {
        stores.entry(finest).or_insert_with(|| {
            CellStore::new(device, queue, terrain, f32::from_bits(finest), capacity)
        });
    }
    edited
}

/// The newest counters of the views of a store: cells in use, vertices of all views, and the oldest choice of a view.
fn news(views: &HashMap<Entity, DetailState>, producer: &Producer, store: &CellStore) -> [u32; 3] {
    let of_store = views.iter().filter(|(_, own)| own.is_of(store));
    let mut newest = (0, 0);
    let (mut vertices, mut oldest) = (0_u32, store.stamp);
    for (entity, own) in of_store {
        let Some(state) = producer.views.get(entity) else {
            continue;
        };
        let counted = state.counters.newest;
        vertices = vertices.saturating_add(counted.vertices);
        oldest = oldest.min(own.stamp);
        // Those that rest have old counters.
        newest = newest.max((own.stamp, cells_in_use(state)));
    }
    let (_, used) = newest;
    [used, vertices, oldest]
}

fn cells_in_use(state: &GeometryView) -> u32 {
    state.counters.newest.own[HEAD_USED - OWN as usize]
}

/// What the height function reads, of a kind's bindings.
fn height_buffers(bindings: &BindingResources) -> Option<[Buffer; 3]> {
    let buffer = |at: u32| match bindings.iter().find(|(binding, _)| *binding == at)? {
        (_, OwnedBindingResource::Buffer(buffer)) => Some(buffer.clone()),
        _ => None,
    };
    Some([buffer(0)?, buffer(1)?, buffer(2)?])
}

/// Room for so many vertices, and for what is there whatever a view asks for; `blocks` is the lattice of who chooses in
/// blocks.
fn pool_for(room: u32, blocks: Option<DetailLattice>) -> GeometryPool {
    let [vertices, primitives] = blocks.as_ref().map_or([0; 2], least_pools);
    GeometryPool {
        vertices: room.max(vertices),
        // Two a vertex, those at a border left out.
        primitives: room.saturating_mul(2).max(primitives),
    }
}

/// Says where the ground is drawn, and binds its data.
pub fn want<K: DetailKind>(
    mut producers: ResMut<Producers>,
    mut details: ResMut<DetailViews<K>>,
    (mut ground, rooms): (ResMut<ExtractedGround<K>>, Res<PoolRooms<K>>),
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    param: StaticSystemParam<<K as AsBindGroup>::Param>,
    mut told: Local<Vec<String>>,
) {
    let Some(producer) = producers.get_mut(detail_key::<K>()) else {
        return;
    };
    producer.wanted.clear();
    let ground = &mut *ground;
    if std::mem::take(&mut ground.newer)
        && let Some(kind) = &ground.kind
    {
        producer.set_defs(kind.material_defs());
        let newest = kind.clone();
        producer.numbers = Some(Arc::new(move |view| newest.view_numbers(view)));
        details.data_due = true;
    }
    if ground.terrain.is_none() {
        // The bind group would keep the buffers and the textures of the ground that was.
        producer.data = None;
        details.ground = None;
        details.data_due = true;
        return;
    }
    if ground.cameras.is_empty() {
        return;
    }
    if details.data_due
        && let Some(kind) = &ground.kind
    {
        let layout = producer
            .data_layout
            .get_or_insert_with(|| K::bind_group_layout_descriptor(&device));
        let mut param: SystemParamItem<<K as AsBindGroup>::Param> = param.into_inner();
        match kind.as_bind_group(layout, &device, &cache, &mut param) {
            Ok(prepared) => {
                producer.data = Some(prepared.bind_group);
                details.ground = height_buffers(&prepared.bindings);
                details.data_due = false;
                ground.kind = None;
            }
            // An image that has not arrived: again in the next frame.
            Err(AsBindGroupError::RetryNextUpdate) => {}
            Err(fault) => {
                let fault = fault.to_string();
                if is_news(&mut told, &fault) {
                    error!("{}: {fault}", producer.name);
                }
            }
        }
    }
    if let (Some(_), Some(terrain)) = (&producer.data, &ground.terrain) {
        let wanted = ground.cameras.iter().map(|(camera, detail)| {
            let most = detail.max_vertices;
            let pool = if detail.choice == Choice::Blocks && !ground.on_host {
                let room = rooms.vertices(*camera, most);
                pool_for(room, Some(lattice_of(terrain, detail.finest)))
            } else {
                pool_for(most, None)
            };
            let pool = pool.bounded([u64::MAX; 2], producer.traits.vertex_bytes());
            (*camera, pool)
        });
        producer.wanted.extend(wanted);
    }
}

/// Makes what is missing, and writes what views that changed are told.
pub fn prepare<K: DetailKind>(
    mut producers: ResMut<Producers>,
    mut details: ResMut<DetailViews<K>>,
    ground: Res<ExtractedGround<K>>,
    cameras: Query<&ExtractedView>,
    shaders: Res<DetailShaders>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    shared: Res<GeometryShared>,
) {
    let Some(producer) = producers.get_mut(detail_key::<K>()) else {
        return;
    };
    let details = &mut *details;
    // Patches of the ground read the data too, where no view chooses.
    producer.shared_bytes = ground.data_bytes;
    (producer.pipelines, producer.fault) = (0, None);
    let seeing: Vec<_> = ground
        .seeing(false)
        .filter(|(camera, _)| producer.views.contains_key(camera))
        .collect();
    let is_seeing = |entity: &Entity| seeing.iter().any(|(camera, _)| camera == entity);
    details.views.retain(|entity, _| is_seeing(entity));
    let (Some(data_layout), Some(terrain), false) =
        (&producer.data_layout, &ground.terrain, seeing.is_empty())
    else {
        details.views.clear();
        details.stores.clear();
        return;
    };
    let without = without(terrain);
    details.pipelines = details
        .pipelines
        .take()
        .filter(|known| known.without == without);
    let pipelines = details
        .pipelines
        .get_or_insert_with(|| DetailPipelines::new(&shaders, data_layout, without, &cache));
    producer.pipelines = pipelines.count();
    producer.fault = pipelines.fault(&cache);
    let one_sided = !producer.traits.double_sided;
    let DetailViews { stores, views, .. } = details;
    let edited = keep_stores(stores, terrain, &seeing, &device, &queue);
    producer.shared_bytes += stores.values().map(CellStore::bytes).sum::<u64>();
    // Of each store from which cells are to be dropped: those that no choice from this one on has looked at.
    let mut sweeps: HashMap<u32, u32> = HashMap::new();
    if !ground.on_host {
        for (finest, store) in &mut *stores {
            let [used, vertices, oldest] = news(views, producer, store);
            let Some(sweep) = store.sweep(used, vertices, oldest) else {
                continue;
            };
            sweeps.insert(*finest, sweep);
            // Who has rested for long marks its cells anew, so that the next sweep finds others.
            for (entity, own) in views.iter().filter(|(_, own)| own.is_of(store)) {
                if let Some(state) = producer.views.get_mut(entity) {
                    state.settled &= own.stamp + views.len() as u32 > store.stamp;
                }
            }
        }
    }
    for (entity, detail) in &seeing {
        let (Some(state), Ok(view)) = (producer.views.get_mut(entity), cameras.get(*entity)) else {
            continue;
        };
        let finest = detail.finest.to_bits();
        let Some(store) = stores.get_mut(&finest) else {
            continue;
        };
        let known = views
            .get(entity)
            .filter(|known| known.is_of(store) && known.detail.max_vertices == detail.max_vertices);
        if known.is_none() {
            views.insert(*entity, DetailState::new(&device, store, *detail));
            state.settled = false;
        }
        let Some(own) = views.get_mut(entity) else {
            continue;
        };
        state.own_bytes = own.bytes();
        state.looked_at = cells_in_use(state);
        // Whoever sees the part or not: the roots are made anew.
        state.settled &= !edited;
        // Shadow views see what the camera does not.
        let shadowed = !state.shadows.is_empty();
        let culled = detail
            .culled
            .then(|| (picture(&state.frame, one_sided), shadowed));
        let [solid, _] = state.shown;
        let seen = detail_view(view, &state.frame, ground.relief, detail);
        let chosen = Some((seen, ground.on_host));
        let counted = ground.counted.contains(entity);
        if counted != own.counted.is_some() {
            own.counted = counted.then(Counted::default);
            // What is drawn stays as it is, and is counted.
            state.settled &= !counted;
        }
        if own.detail != *detail
            || own.culled != culled
            || own.solid != solid
            || own.chosen != chosen
        {
            own.detail = *detail;
            own.culled = culled;
            own.solid = solid;
            own.chosen = chosen;
            state.settled = false;
        }
        if ground.on_host {
            if !state.settled {
                host::choose(own, &mut store.ground, seen, state, &queue, &shared);
            }
            continue;
        }
        let written = [&state.vertices, &state.indices, &state.work];
        let same = own
            .written
            .as_ref()
            .is_some_and(|known| known.iter().zip(written).all(|(a, b)| a.id() == b.id()));
        if !same {
            own.bind(&device, &cache, pipelines, written);
        }
        if !state.settled {
            own.tell(&queue, store, seen, state, sweeps.remove(&finest));
        }
    }
}
