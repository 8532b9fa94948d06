//! Buffers of each view, and what its passes are told.

use std::any::TypeId;
use std::collections::HashMap;

use bevy::math::{DVec3, Vec3};
use bevy::prelude::*;
use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, Buffer, BufferBinding, BufferDescriptor, BufferInitDescriptor,
    BufferUsages, PipelineCache,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::view::ExtractedView;
use bytemuck::{Zeroable, bytes_of, cast_slice};

use super::pipeline::DetailPipelines;
use super::{DetailShaders, ExtractedDetail, ExtractedGround};
use crate::detail::lattice::MAX_DEPTH;
use crate::detail::layout::{
    Beginning, COUNT_WORDS, DetailParams, DetailPass, LEAST_CAPACITY, VIEW_CELL_BYTES,
};
use crate::detail::{Detail, DetailCells, DetailView};
use crate::render::ground::GroundKind;
use crate::render::stage::prepare::{StageKinds, ViewKind};
use crate::stage::layout::StageView;

/// Bytes between the slots of a uniform buffer.
pub(super) const SLOT: u64 = 256;

/// Every view that chooses its ground, and what all have in common.
#[derive(Resource, Default)]
pub struct DetailViews {
    pub(super) pipelines: Option<DetailPipelines>,
    pub(super) views: HashMap<Entity, DetailState>,
}

/// One view's buffers.
pub(super) struct DetailState {
    /// The roots, without any cell made on the CPU.
    ground: DetailCells,
    detail: Detail,
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
    /// Of the view's buffers that the groups hold.
    written: Option<[Buffer; 3]>,
    /// Shared, then for vertices, triangles and the head.
    pub groups: Option<[BindGroup; 4]>,
    pub depth: u32,
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
        // Twice as many cells as vertices: those that are looked at, and what the last views left.
        let capacity = (detail.max_vertices * 2)
            .next_power_of_two()
            .clamp(LEAST_CAPACITY, 1 << 20);
        let empty = |label, size: u64| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
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
            empty("detail_counts", 4 * COUNT_WORDS as u64),
            empty("detail_lists", 2 * room),
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
            written: None,
            groups: None,
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
        queue.write_buffer(&self.uniform, 0, bytes_of(&params));
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

    /// Forgets what was made, where less than half of the room is left: a camera that jumps finds room for
    /// all that it sees.
    fn forget_if_full(&mut self, queue: &RenderQueue, used: u32) {
        if used > self.capacity / 2 {
            self.fresh = true;
            queue.write_buffer(&self.kept[1], 0, cast_slice(&self.beginning.links));
        }
    }
}

/// The view as the choice sees it: heights are absolute, x and z relative to the stage's anchor.
fn detail_view(
    view: &ExtractedView,
    stage: &StageView,
    relief: f32,
    detail: &Detail,
) -> DetailView {
    let anchor = Vec3::from(stage.anchor).as_dvec3();
    let mut out = DetailView::zeroed();
    out.planes = stage.planes.map(|[x, y, z, d]| {
        let raised = f64::from(d) - f64::from(y) * anchor.y;
        [x, y, z, raised as f32]
    });
    let turn = view.world_from_view.affine().matrix3;
    let eye = view.world_from_view.translation().as_dvec3() - DVec3::new(anchor.x, 0.0, anchor.z);
    out.eye = eye.as_vec3().to_array();
    let axis = |axis: Vec3| axis.normalize_or_zero().to_array();
    out.right = axis(turn.x_axis.into());
    out.up = axis(turn.y_axis.into());
    out.forward = axis(-Vec3::from(turn.z_axis));
    let clip = &view.clip_from_view;
    out.scale = 0.5 * view.viewport.w as f32 * clip.y_axis.y;
    out.orthographic = stage.orthographic;
    // Of Bevy's perspective, infinite and reversed: z of clip space is the near distance.
    out.near = if clip.w_axis.z > 0.0 {
        clip.w_axis.z
    } else {
        0.1
    };
    let (x, y) = (1.0 / clip.x_axis.x, 1.0 / clip.y_axis.y);
    out.cos_corner = 1.0 / (1.0 + x * x + y * y).sqrt();
    let sweep = Vec3::new(stage.sweep[0], stage.sweep[1], stage.sweep[2]);
    if let Some(along) = sweep.try_normalize() {
        // 0.05: below 3 degrees of sun the shadows of everything reach everywhere.
        out.sweep = (along * (relief / (-along.y).max(0.05))).to_array();
    }
    out.anchor = [anchor.x as i32, anchor.z as i32];
    out.set_metric(detail);
    out
}

/// Makes what is missing, and writes what views that changed are told.
pub fn prepare(
    mut kinds: ResMut<StageKinds>,
    mut details: ResMut<DetailViews>,
    ground: Res<ExtractedGround>,
    cameras: Query<(Entity, &ExtractedView, Option<&ExtractedDetail>)>,
    shaders: Res<DetailShaders>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    let kind = kinds.0.get_mut(&TypeId::of::<GroundKind>());
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
    let pipelines = details
        .pipelines
        .get_or_insert_with(|| DetailPipelines::new(&shaders, data_layout, &cache));
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
        let written = [&state.vertices, &state.indices, &state.work];
        let same = own
            .written
            .as_ref()
            .is_some_and(|known| known.iter().zip(written).all(|(a, b)| a.id() == b.id()));
        if !same {
            own.bind(&device, &cache, pipelines, written);
        }
        if !state.settled {
            own.forget_if_full(&queue, state.counters.newest.kept_cells);
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
        let emit = |buffer: &Buffer| {
            device.create_bind_group(
                "detail_emit",
                &cache.get_bind_group_layout(&pipelines.emit),
                &BindGroupEntries::sequential((
                    self.corners.as_entire_binding(),
                    buffer.as_entire_binding(),
                )),
            )
        };
        let [vertices, indices, head] = written.map(emit);
        self.groups = Some([shared, vertices, indices, head]);
        self.written = Some(written.map(Clone::clone));
    }
}
