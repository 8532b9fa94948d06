//! Buffers of one view, and what its next choice is told.

use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, BindingResource, Buffer, BufferBinding, BufferDescriptor,
    BufferInitDescriptor, BufferUsages, PipelineCache,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bytemuck::{bytes_of, cast_slice};

use super::counted::Counted;
use super::pipeline::DetailPipelines;
use super::record::{Extras, SLOT};
use super::store::CellStore;
use crate::detail::lattice::MAX_DEPTH;
use crate::detail::layout::{
    ALL_COUNT_WORDS, ARGUMENT_BYTES, Beginning, CLOSING_BYTES, COUNTED, DetailParams, DetailPass,
    LIST_BYTES, RECORD_BYTES, VIEW_CELL_BYTES,
};
use crate::detail::{CullView, DetailCells, DetailView, HorizonView, TerrainLod};
use dolomite_geometry::render::GeometryView;

/// One view's buffers.
pub(super) struct DetailState {
    pub detail: TerrainLod,
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
    pub written: Option<[Buffer; 3]>,
    pub groups: Option<DetailGroups>,
    /// What was left out of view, and whether it was kept for shadows.
    pub culled: Option<(CullView, bool)>,
    /// Whether ground hides what is behind it: its edges alone do not.
    pub solid: bool,
    /// What the newest choice does beside what it always does.
    pub extras: Extras,
    /// Histograms on their way to the budget of the view's camera, where it has one.
    pub counted: Option<Counted>,
    /// The view that was chosen for, and whether by the CPU.
    pub chosen: Option<(DetailView, bool)>,
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
    pub fn new(device: &RenderDevice, store: &CellStore, detail: TerrainLod) -> Self {
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
            buffer(
                "detail_counts",
                4 * ALL_COUNT_WORDS as u64,
                BufferUsages::COPY_SRC,
            ),
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
            counted: None,
        }
    }

    /// Vertices that are there whatever the tolerance: the corners of the roots.
    pub fn always(&self) -> f32 {
        (self.corners.size() / 16) as f32
    }

    /// Bytes of its own buffers, without those of the store.
    pub fn bytes(&self) -> u64 {
        let own = self.kept[2..].iter().chain(&self.arguments);
        let others = [&self.uniform, &self.depths, &self.closing, &self.records];
        own.chain(others).map(|buffer| buffer.size()).sum()
    }

    /// Whether it stands on the cells of a store.
    pub fn is_of(&self, store: &CellStore) -> bool {
        self.kept[0].id() == store.cells.id()
    }

    /// Writes what the next choice is told; `sweep` is from which choice on cells are kept, if any are dropped.
    pub fn tell(
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
        let params = params.edited(&store.edited);
        let horizon = self.horizon(&store.ground, &view, params.anchor_height);
        let params = match &self.culled {
            Some((picture, others)) => params.cull(picture, *others),
            None => params,
        };
        let mut params = horizon.map_or(params, |horizon| params.occlude(horizon));
        if self.counted.is_some() {
            params.flags |= COUNTED;
        }
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
    pub fn horizon(
        &self,
        ground: &DetailCells,
        view: &DetailView,
        anchor_height: f32,
    ) -> Option<HorizonView> {
        let wanted = self.detail.occluded && self.solid;
        let (picture, _) = self.culled.as_ref().filter(|_| wanted)?;
        HorizonView::new(ground, view, picture, anchor_height)
    }

    /// Binds its buffers and those that the passes write.
    pub fn bind(
        &mut self,
        device: &RenderDevice,
        cache: &PipelineCache,
        pipelines: &DetailPipelines,
        written: [&Buffer; 3],
    ) {
        let slot = BindingResource::Buffer(BufferBinding {
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
