//! Buffers of each view, and what its passes are told.

use std::any::TypeId;
use std::collections::HashMap;
use std::marker::PhantomData;

use bevy::prelude::*;
use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, Buffer, BufferBinding, BufferDescriptor, BufferInitDescriptor,
    BufferUsages, PipelineCache,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::view::ExtractedView;
use bytemuck::{bytes_of, cast_slice};

use super::pipeline::DetailPipelines;
use super::view::{detail_view, picture};
use super::{DetailKind, DetailShaders, ExtractedDetail, ExtractedGround, host};
use crate::detail::lattice::MAX_DEPTH;
use crate::detail::layout::{
    ALL_COUNT_WORDS, ARGUMENT_BYTES, Beginning, CLOSING_BYTES, DetailParams, DetailPass,
    LEAST_CAPACITY, LIST_BYTES, RECORD_BYTES, VIEW_CELL_BYTES, without,
};
use crate::detail::{Cell, Detail, DetailCells, DetailView, HorizonView, Picture};
use dolomite_tessellation::render::prepare::{StageKinds, ViewKind};
use dolomite_tessellation::render::stats::StageShared;

/// Bytes between the slots of a uniform buffer.
pub(super) const SLOT: u64 = 256;

/// Most cells that are kept: 900 MB.
const MOST_CELLS: u64 = 1 << 22;

/// Every view that chooses its ground, and what all have in common.
#[derive(Resource)]
pub struct DetailViews<K> {
    pub(super) pipelines: Option<DetailPipelines>,
    pub(super) views: HashMap<Entity, DetailState>,
    kind: PhantomData<fn() -> K>,
}

impl<K> Default for DetailViews<K> {
    fn default() -> Self {
        Self {
            pipelines: None,
            views: HashMap::new(),
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
        }
    }

    /// Writes what the next choice is told.
    fn tell(&mut self, queue: &RenderQueue, view: DetailView, state: &ViewKind) {
        let stage = state.params();
        self.stamp += 1;
        let params = DetailParams {
            stamp: self.stamp,
            anchor_height: stage.view.anchor[1],
            ..DetailParams::new(
                &self.ground,
                view,
                self.capacity,
                [
                    stage.max_vertices.min(self.detail.max_vertices),
                    stage.max_primitives,
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

/// Makes what is missing, and writes what views that changed are told.
pub fn prepare<K: DetailKind>(
    mut kinds: ResMut<StageKinds>,
    mut details: ResMut<DetailViews<K>>,
    ground: Res<ExtractedGround<K>>,
    cameras: Query<(Entity, &ExtractedView, Option<&ExtractedDetail>)>,
    shaders: Res<DetailShaders>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    shared: Res<StageShared>,
) {
    let kind = kinds.0.get_mut(&TypeId::of::<K>());
    let (Some(kind), Some(terrain)) = (kind.filter(|kind| kind.given), &ground.terrain) else {
        details.views.clear();
        return;
    };
    let Some(data_layout) = &kind.data_layout else {
        return;
    };
    let details = &mut *details;
    details
        .views
        .retain(|entity, _| kind.views.contains_key(entity));
    let without = without(terrain);
    details.pipelines = details
        .pipelines
        .take()
        .filter(|known| known.without == without);
    let pipelines = details
        .pipelines
        .get_or_insert_with(|| DetailPipelines::new(&shaders, data_layout, without, &cache));
    for (entity, view, detail) in &cameras {
        let Some(state) = kind.views.get_mut(&entity) else {
            continue;
        };
        let detail = detail.map_or_else(Detail::default, |detail| detail.0);
        let known = details.views.get(&entity).filter(|known| {
            known.ground.terrain().same(terrain)
                && known.detail.finest == detail.finest
                && known.detail.max_vertices == detail.max_vertices
        });
        if known.is_none() {
            let new = DetailState::new(&device, &queue, terrain, detail);
            details.views.insert(entity, new);
            state.settled = false;
        }
        let Some(own) = details.views.get_mut(&entity) else {
            continue;
        };
        if own.detail != detail {
            own.detail = detail;
            state.settled = false;
        }
        // Shadow views see what the camera does not.
        let shadowed = !state.shadows.is_empty();
        let culled = detail
            .culled
            .then(|| (picture(view, state, kind.traits), shadowed));
        let [solid, _] = state.shown;
        if own.culled != culled || own.solid != solid {
            own.culled = culled;
            own.solid = solid;
            state.settled = false;
        }
        if ground.on_host {
            if !state.settled {
                let view = detail_view(view, &state.params().view, ground.relief, &detail);
                host::choose(own, view, state, &queue, &shared);
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
            own.forget_if_full(&queue, newest.kept_cells, newest.vertices);
            let view = detail_view(view, &state.params().view, ground.relief, &detail);
            own.tell(&queue, view, state);
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
