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
use super::record::SLOT;
use super::view::{detail_view, picture};
use super::{DetailKind, DetailShaders, ExtractedGround, detail_key, host};
use crate::detail::lattice::MAX_DEPTH;
use crate::detail::layout::{
    ALL_COUNT_WORDS, ARGUMENT_BYTES, Beginning, CLOSING_BYTES, DetailParams, DetailPass, HEAD_USED,
    LEAST_CAPACITY, LIST_BYTES, RECORD_BYTES, VIEW_CELL_BYTES, without,
};
use crate::detail::{Cell, Detail, DetailCells, DetailView, HorizonView, Picture};
use dolomite_geometry::layout::OWN;
use dolomite_geometry::render::{GeometryPool, GeometryShared, GeometryView, Producers};

/// Most cells that are kept: 900 MB.
const MOST_CELLS: u64 = 1 << 22;

/// Every view that chooses its ground, and what all have in common.
#[derive(Resource)]
pub struct DetailViews<K> {
    pub(super) pipelines: Option<DetailPipelines>,
    pub(super) views: HashMap<Entity, DetailState>,
    /// Whether the bind group is older than the kind's data.
    pub(super) data_due: bool,
    kind: PhantomData<fn() -> K>,
}

impl<K> Default for DetailViews<K> {
    fn default() -> Self {
        Self {
            pipelines: None,
            views: HashMap::new(),
            data_due: true,
            kind: PhantomData,
        }
    }
}

/// One view's buffers.
pub(super) struct DetailState {
    /// The roots; cells that were made on the CPU, where it chooses.
    pub(super) ground: DetailCells,
    pub(super) detail: Detail,
    pub beginning: Beginning,
    pub capacity: u32,
    pub stamp: u32,
    /// Whether nothing has been made yet.
    pub fresh: bool,
    pub uniform: Buffer,
    depths: Buffer,
    pub corners: Buffer,
    /// Cells, links, the cells in the view, counts, lists.
    pub kept: [Buffer; 5],
    /// Arguments of the dispatches: of even and odd depths, and of those that close the choice.
    pub arguments: [Buffer; 2],
    pub closing: Buffer,
    /// What heights of vertices depend on.
    records: Buffer,
    /// Of the view's buffers that the groups hold.
    written: Option<[Buffer; 3]>,
    pub groups: Option<DetailGroups>,
    /// What was left out of the picture, and whether it was kept for shadows.
    pub(super) culled: Option<(Picture, bool)>,
    /// Whether ground hides what is behind it: its edges alone do not.
    pub(super) solid: bool,
    /// Whether the newest choice looks for what nearer ground hides.
    pub(super) occluded: bool,
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
    fn new(
        device: &RenderDevice,
        queue: &RenderQueue,
        terrain: &dolomite_terrain::Terrain,
        detail: Detail,
    ) -> Self {
        let ground = DetailCells::new(terrain.clone(), detail.finest);
        let beginning = Beginning::new(&ground);
        // A view looks at some two cells a vertex; as many again for what the last views left.
        let most = device.limits().max_storage_buffer_binding_size / size_of::<Cell>() as u64;
        let most = most.clamp(u64::from(LEAST_CAPACITY), MOST_CELLS) as u32;
        let capacity = detail
            .max_vertices
            .saturating_mul(4)
            .clamp(LEAST_CAPACITY, most)
            / 4
            * 4;
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
            empty("detail_cells", 96 * room),
            empty("detail_links", 16 * room),
            empty("detail_seen", VIEW_CELL_BYTES * room),
            empty("detail_counts", 4 * ALL_COUNT_WORDS as u64),
            empty("detail_lists", LIST_BYTES * room),
        ];
        queue.write_buffer(&kept[1], 0, cast_slice(&beginning.links));
        Self {
            uniform: device.create_buffer(&BufferDescriptor {
                label: Some("detail_params"),
                size: size_of::<DetailParams>() as u64,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            depths: filled("detail_depths", &depths, BufferUsages::UNIFORM),
            corners: filled(
                "detail_corners",
                cast_slice(&beginning.corners),
                BufferUsages::STORAGE,
            ),
            depth: ground.lattice.depth,
            ground,
            detail,
            beginning,
            capacity,
            stamp: 0,
            fresh: true,
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
            occluded: false,
            chosen: None,
        }
    }

    /// Bytes of its buffers.
    fn bytes(&self) -> u64 {
        let kept = self.kept.iter().chain(&self.arguments);
        let others = [
            &self.uniform,
            &self.depths,
            &self.corners,
            &self.closing,
            &self.records,
        ];
        kept.chain(others).map(|buffer| buffer.size()).sum()
    }

    /// Writes what the next choice is told.
    fn tell(&mut self, queue: &RenderQueue, view: DetailView, state: &GeometryView) {
        self.stamp += 1;
        let params = DetailParams {
            stamp: self.stamp,
            anchor_height: state.frame.anchor.y as f32,
            ..DetailParams::new(
                &self.ground,
                view,
                self.capacity,
                [
                    state.pool.vertices.min(self.detail.max_vertices),
                    state.pool.primitives,
                ],
            )
        };
        let horizon = self.horizon(&view, params.anchor_height);
        let params = match &self.culled {
            Some((picture, others)) => params.cull(picture, *others),
            None => params,
        };
        let params = horizon.map_or(params, |horizon| params.occlude(horizon));
        self.occluded = horizon.is_some();
        queue.write_buffer(&self.uniform, 0, bytes_of(&params));
        let arguments = self.beginning.arguments(self.fresh);
        for buffer in &self.arguments {
            queue.write_buffer(buffer, 0, cast_slice(&arguments));
        }
        queue.write_buffer(&self.closing, 0, cast_slice(&Beginning::CLOSING));
        let counts = self.beginning.counts(self.fresh);
        let kept = usize::from(!self.fresh);
        queue.write_buffer(&self.kept[3], 4 * kept as u64, cast_slice(&counts[kept..]));
        let blocks = &self.beginning.blocks;
        queue.write_buffer(&self.kept[4], 0, cast_slice(blocks));
        if self.fresh {
            let back: Vec<u32> = blocks.iter().rev().copied().collect();
            let at = 4 * (u64::from(self.capacity / 2) - back.len() as u64);
            queue.write_buffer(&self.kept[4], at, cast_slice(&back));
        }
    }

    /// How the view looks at its horizon, where it does.
    pub(super) fn horizon(&self, view: &DetailView, anchor_height: f32) -> Option<HorizonView> {
        let wanted = self.detail.occluded && self.solid;
        let (picture, _) = self.culled.as_ref().filter(|_| wanted)?;
        HorizonView::new(&self.ground, view, picture, anchor_height)
    }

    /// Forgets what was made, where little room is left; or less than half, and most of it is of views long
    /// gone: a camera that jumps finds room for all that it sees. A view that needs half of the room itself
    /// keeps what it has.
    fn forget_if_full(&mut self, queue: &RenderQueue, used: u32, vertices: u32) {
        // Some two cells are looked at for a vertex.
        let needed = vertices.saturating_mul(2);
        let crowded = used > self.capacity / 2 && used / 2 > needed;
        if crowded || used > self.capacity / 8 * 7 {
            self.fresh = true;
            queue.write_buffer(&self.kept[1], 0, cast_slice(&self.beginning.links));
        }
    }
}

/// Says where the ground is drawn, and binds its data.
pub fn want<K: DetailKind>(
    mut producers: ResMut<Producers>,
    mut details: ResMut<DetailViews<K>>,
    mut ground: ResMut<ExtractedGround<K>>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    param: StaticSystemParam<<K as AsBindGroup>::Param>,
) {
    let Some(producer) = producers.get_mut(detail_key::<K>()) else {
        return;
    };
    producer.wanted.clear();
    let ground = &mut *ground;
    if std::mem::take(&mut ground.newer)
        && let Some(kind) = &ground.kind
    {
        let newest = kind.clone();
        producer.numbers = Some(Arc::new(move |view| newest.view_numbers(view)));
        details.data_due = true;
    }
    if ground.terrain.is_none() || ground.cameras.is_empty() {
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
            Err(fault) => error!("{}: {fault}", producer.name),
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
        return;
    };
    details
        .views
        .retain(|entity, _| producer.views.contains_key(entity));
    if producer.views.is_empty() {
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
    for (entity, detail) in &ground.cameras {
        let (Some(state), Ok(view)) = (producer.views.get_mut(entity), cameras.get(*entity)) else {
            continue;
        };
        let known = details.views.get(entity).filter(|known| {
            known.ground.terrain().same(terrain)
                && known.detail.finest == detail.finest
                && known.detail.max_vertices == detail.max_vertices
        });
        if known.is_none() {
            let new = DetailState::new(&device, &queue, terrain, *detail);
            details.views.insert(*entity, new);
            state.settled = false;
        }
        let Some(own) = details.views.get_mut(entity) else {
            continue;
        };
        state.own_bytes = own.bytes();
        state.looked_at = state.counters.newest.own[HEAD_USED - OWN as usize];
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
                host::choose(own, seen, state, &queue, &shared);
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
            let newest = state.counters.newest;
            own.forget_if_full(&queue, state.looked_at, newest.vertices);
            own.tell(&queue, seen, state);
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
                &BindGroupEntries::single(head.as_entire_binding()),
            ),
        });
        self.written = Some(written.map(Clone::clone));
    }
}
