//! Buffers of each view, and what its passes are told.

use std::collections::HashMap;
use std::marker::PhantomData;
use std::sync::Arc;

use bevy::ecs::system::{StaticSystemParam, SystemParamItem};
use bevy::prelude::*;
use bevy::render::render_resource::{
    AsBindGroup, AsBindGroupError, BindGroup, BindGroupEntries, Buffer, BufferBinding,
    BufferDescriptor, BufferInitDescriptor, BufferUsages, PipelineCache,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::view::ExtractedView;
use bytemuck::{bytes_of, cast_slice};

use super::pipeline::DetailPipelines;
use super::record::{Extras, SLOT};
use super::store::{CellStore, capacity_for};
use super::view::{detail_view, picture};
use super::{DetailKind, DetailShaders, ExtractedGround, detail_key, host};
use crate::detail::lattice::MAX_DEPTH;
use crate::detail::layout::{
    ALL_COUNT_WORDS, ARGUMENT_BYTES, Beginning, CLOSING_BYTES, DetailParams, DetailPass, HEAD_USED,
    LIST_BYTES, RECORD_BYTES, VIEW_CELL_BYTES, without,
};
use crate::detail::{CullView, DetailCells, DetailView, HorizonView, TerrainLod};
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
    kind: PhantomData<fn() -> K>,
}

impl<K> Default for DetailViews<K> {
    fn default() -> Self {
        Self {
            pipelines: None,
            views: HashMap::new(),
            stores: HashMap::new(),
            data_due: true,
            kind: PhantomData,
        }
    }
}

/// One view's buffers.
pub(super) struct DetailState {
    pub(super) detail: TerrainLod,
    /// Cells that there is room for.
    pub capacity: u32,
    /// Number of the newest choice.
    pub stamp: u32,
    pub uniform: Buffer,
    depths: Buffer,
    /// Of the store: corners of the roots.
    pub corners: Buffer,
    /// Cells and links of the store; the cells in the view, counts, lists.
    pub kept: [Buffer; 5],
    /// Of the store: what is in use.
    stock: Buffer,
    /// Arguments of the dispatches: of even and odd depths, and of those that close the choice.
    pub arguments: [Buffer; 2],
    pub closing: Buffer,
    /// What heights of vertices depend on.
    records: Buffer,
    /// Of the view's buffers that the groups hold.
    written: Option<[Buffer; 3]>,
    pub groups: Option<DetailGroups>,
    /// What was left out of view, and whether it was kept for shadows.
    pub(super) culled: Option<(CullView, bool)>,
    /// Whether ground hides what is behind it: its edges alone do not.
    pub(super) solid: bool,
    /// What the newest choice does beside what it always does.
    pub(super) extras: Extras,
    /// The view that was chosen for, and whether by the CPU.
    pub(super) chosen: Option<(DetailView, bool)>,
    pub depth: u32,
}

/// Bind groups of one view.
pub(super) struct DetailGroups {
    pub shared: BindGroup,
    /// What even depths write, and odd ones.
    pub arguments: [BindGroup; 2],
    pub vertices: BindGroup,
    pub triangles: BindGroup,
    pub head: BindGroup,
}

impl DetailState {
    fn new(device: &RenderDevice, store: &CellStore, detail: TerrainLod) -> Self {
        let capacity = store.capacity;
        let buffer = |label, size: u64, usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let empty = |label, size| buffer(label, size, BufferUsages::empty());
        let indirect = |label, size| buffer(label, size, BufferUsages::INDIRECT);
        let filled = |label, contents: &[u8], usage| {
            device.create_buffer_with_data(&BufferInitDescriptor {
                label: Some(label),
                contents,
                usage,
            })
        };
        let mut depths = vec![0_u8; (SLOT * u64::from(MAX_DEPTH + 1)) as usize];
        for depth in 0..=MAX_DEPTH {
            let pass = DetailPass {
                depth,
                ..DetailPass::default()
            };
            let at = (u64::from(depth) * SLOT) as usize;
            depths[at..at + size_of::<DetailPass>()].copy_from_slice(bytes_of(&pass));
        }
        let room = u64::from(capacity);
        let kept = [
            store.cells.clone(),
            store.links.clone(),
            empty("detail_seen", VIEW_CELL_BYTES * room),
            empty("detail_counts", 4 * ALL_COUNT_WORDS as u64),
            empty("detail_lists", LIST_BYTES * room),
        ];
        Self {
            uniform: device.create_buffer(&BufferDescriptor {
                label: Some("detail_params"),
                size: size_of::<DetailParams>() as u64,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            depths: filled("detail_depths", &depths, BufferUsages::UNIFORM),
            corners: store.corners.clone(),
            stock: store.stock.clone(),
            depth: store.ground.lattice.depth,
            detail,
            capacity,
            stamp: 0,
            kept,
            arguments: [0, 1].map(|_| indirect("detail_arguments", ARGUMENT_BYTES)),
            closing: indirect("detail_closing", CLOSING_BYTES),
            records: empty(
                "detail_records",
                RECORD_BYTES * u64::from(detail.max_vertices),
            ),
            written: None,
            groups: None,
            culled: None,
            solid: true,
            extras: Extras::default(),
            chosen: None,
        }
    }

    /// Bytes of its own buffers, without those of the store.
    fn bytes(&self) -> u64 {
        let own = self.kept[2..].iter().chain(&self.arguments);
        let others = [&self.uniform, &self.depths, &self.closing, &self.records];
        own.chain(others).map(|buffer| buffer.size()).sum()
    }

    /// Whether it stands on the cells of a store.
    fn is_of(&self, store: &CellStore) -> bool {
        self.kept[0].id() == store.cells.id()
    }

    /// Writes what the next choice is told; `sweep` is from which choice on cells are kept, if any are dropped.
    fn tell(
        &mut self,
        queue: &RenderQueue,
        store: &mut CellStore,
        view: DetailView,
        state: &GeometryView,
        sweep: Option<u32>,
    ) {
        self.stamp = store.next_stamp();
        let params = DetailParams {
            stamp: self.stamp,
            oldest: sweep.unwrap_or(0),
            anchor_height: state.frame.anchor.y as f32,
            ..DetailParams::new(
                &store.ground,
                view,
                self.capacity,
                [
                    state.pool.vertices.min(self.detail.max_vertices),
                    state.pool.primitives,
                ],
            )
        };
        let horizon = self.horizon(&store.ground, &view, params.anchor_height);
        let params = match &self.culled {
            Some((picture, others)) => params.cull(picture, *others),
            None => params,
        };
        let params = horizon.map_or(params, |horizon| params.occlude(horizon));
        self.extras = Extras {
            sweeps: sweep.is_some(),
            occluded: horizon.is_some(),
        };
        queue.write_buffer(&self.uniform, 0, bytes_of(&params));
        let beginning = &store.beginning;
        let arguments = beginning.arguments(store.fresh);
        for buffer in &self.arguments {
            queue.write_buffer(buffer, 0, cast_slice(&arguments));
        }
        queue.write_buffer(&self.closing, 0, cast_slice(&Beginning::CLOSING));
        let counts = beginning.counts(store.fresh);
        queue.write_buffer(&self.kept[3], 0, cast_slice(&counts));
        let blocks = &beginning.blocks;
        queue.write_buffer(&self.kept[4], 0, cast_slice(blocks));
        if store.fresh {
            let back: Vec<u32> = blocks.iter().rev().copied().collect();
            let at = 4 * (u64::from(self.capacity / 2) - back.len() as u64);
            queue.write_buffer(&self.kept[4], at, cast_slice(&back));
        }
    }

    /// How the view looks at its horizon, where it does.
    pub(super) fn horizon(
        &self,
        ground: &DetailCells,
        view: &DetailView,
        anchor_height: f32,
    ) -> Option<HorizonView> {
        let wanted = self.detail.occluded && self.solid;
        let (picture, _) = self.culled.as_ref().filter(|_| wanted)?;
        HorizonView::new(ground, view, picture, anchor_height)
    }
}

/// The stores that the cameras need: one for each size of the smallest cell, as large as the greatest view of it asks
/// for.
fn keep_stores(
    stores: &mut HashMap<u32, CellStore>,
    terrain: &Terrain,
    cameras: &[(Entity, TerrainLod)],
    device: &RenderDevice,
    queue: &RenderQueue,
) {
    let mut wanted: HashMap<u32, u32> = HashMap::new();
    for (_, detail) in cameras {
        let room = capacity_for(device, detail);
        let most = wanted.entry(detail.finest.to_bits()).or_default();
        *most = room.max(*most);
    }
    stores.retain(|finest, store| {
        wanted.get(finest) == Some(&store.capacity) && store.ground.terrain().same(terrain)
    });
    for (finest, capacity) in wanted {
        stores.entry(finest).or_insert_with(|| {
            CellStore::new(device, queue, terrain, f32::from_bits(finest), capacity)
        });
    }
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

/// Says where the ground is drawn, and binds its data.
pub fn want<K: DetailKind>(
    mut producers: ResMut<Producers>,
    mut details: ResMut<DetailViews<K>>,
    mut ground: ResMut<ExtractedGround<K>>,
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
    if producer.data.is_some() {
        let wanted = ground.cameras.iter().map(|(camera, detail)| {
            let pool = GeometryPool {
                vertices: detail.max_vertices,
                // Two a vertex, those at a border left out.
                primitives: detail.max_vertices.saturating_mul(2),
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
    let (Some(data_layout), Some(terrain)) = (&producer.data_layout, &ground.terrain) else {
        details.views.clear();
        details.stores.clear();
        producer.shared_bytes = 0;
        return;
    };
    details
        .views
        .retain(|entity, _| producer.views.contains_key(entity));
    if producer.views.is_empty() {
        details.stores.clear();
        producer.shared_bytes = 0;
        return;
    }
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
    keep_stores(stores, terrain, &ground.cameras, &device, &queue);
    producer.shared_bytes = stores.values().map(CellStore::bytes).sum();
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
    for (entity, detail) in &ground.cameras {
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
        // Shadow views see what the camera does not.
        let shadowed = !state.shadows.is_empty();
        let culled = detail
            .culled
            .then(|| (picture(&state.frame, one_sided), shadowed));
        let [solid, _] = state.shown;
        let seen = detail_view(view, &state.frame, ground.relief, detail);
        let chosen = Some((seen, ground.on_host));
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

impl DetailState {
    fn bind(
        &mut self,
        device: &RenderDevice,
        cache: &PipelineCache,
        pipelines: &DetailPipelines,
        written: [&Buffer; 3],
    ) {
        let slot = bevy::render::render_resource::BindingResource::Buffer(BufferBinding {
            buffer: &self.depths,
            offset: 0,
            size: (size_of::<DetailPass>() as u64).try_into().ok(),
        });
        let [cells, links, seen, counts, lists] = &self.kept;
        let shared = device.create_bind_group(
            "detail_shared",
            &cache.get_bind_group_layout(&pipelines.shared),
            &BindGroupEntries::sequential((
                self.uniform.as_entire_binding(),
                slot,
                cells.as_entire_binding(),
                links.as_entire_binding(),
                seen.as_entire_binding(),
                counts.as_entire_binding(),
                lists.as_entire_binding(),
            )),
        );
        let [vertices, indices, head] = written;
        let arguments = |turn: usize| {
            device.create_bind_group(
                "detail_arguments",
                &cache.get_bind_group_layout(&pipelines.arguments),
                &BindGroupEntries::sequential((
                    // Of the next depth.
                    self.arguments[1 - turn].as_entire_binding(),
                    self.closing.as_entire_binding(),
                    self.stock.as_entire_binding(),
                )),
            )
        };
        self.groups = Some(DetailGroups {
            shared,
            arguments: [0, 1].map(arguments),
            vertices: device.create_bind_group(
                "detail_vertices",
                &cache.get_bind_group_layout(&pipelines.vertices),
                &BindGroupEntries::sequential((
                    self.corners.as_entire_binding(),
                    vertices.as_entire_binding(),
                    self.records.as_entire_binding(),
                )),
            ),
            triangles: device.create_bind_group(
                "detail_triangles",
                &cache.get_bind_group_layout(&pipelines.triangles),
                &BindGroupEntries::sequential((
                    vertices.as_entire_binding(),
                    indices.as_entire_binding(),
                )),
            ),
            head: device.create_bind_group(
                "detail_head",
                &cache.get_bind_group_layout(&pipelines.head),
                &BindGroupEntries::sequential((
                    head.as_entire_binding(),
                    self.closing.as_entire_binding(),
                    self.stock.as_entire_binding(),
                )),
            ),
        });
        self.written = Some(written.map(Clone::clone));
    }
}
