//! Buffers of one view, and what its next choice is told.

use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, Buffer, BufferDescriptor, BufferUsages, PipelineCache,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bytemuck::{bytes_of, cast_slice};
use dolomite_geometry::render::GeometryView;

use super::head::Head;
use super::pipeline::BlockPipelines;
use super::record::Extras;
use super::store::BlockStore;
use crate::blocks::layout::{
    ARGUMENT_BYTES, BlockNumbers, COUNT_WORDS, LOOKED_BYTES, MOST_MADE, SEEN_BYTES, list_words,
    made_at,
};
use crate::detail::layout::DetailParams;
use crate::detail::{CullView, DetailGround, DetailView, HorizonView, TerrainLod};

/// Most rounds of looking and making before a choice is drawn: so that a frame whose time nobody minds makes more than
/// [`MOST_MADE`] blocks.
const MOST_ROUNDS: u32 = 16;

/// What a choice depends on, beside the blocks that there are.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::render) struct Inputs {
    pub detail: TerrainLod,
    pub view: DetailView,
    /// What is left out of view, and whether it is kept for shadows.
    pub culled: Option<(CullView, bool)>,
    /// Whether ground hides what is behind it: its edges alone do not.
    pub solid: bool,
    /// Whether the CPU chooses.
    pub on_host: bool,
}

impl Inputs {
    /// How the view looks at its horizon, where it does.
    fn horizon(&self, ground: &DetailGround, anchor_height: f32) -> Option<HorizonView> {
        let wanted = self.detail.occluded && self.solid;
        let (picture, _) = self.culled.as_ref().filter(|_| wanted)?;
        HorizonView::new(ground, &self.view, picture, anchor_height)
    }
}

/// One view's buffers.
pub(in crate::render) struct BlockState {
    pub inputs: Inputs,
    /// Slots that there are.
    pub slots: u32,
    /// Number of the newest choice.
    pub stamp: u32,
    /// Number of the first choice by these inputs.
    pub since: u32,
    /// Number of the first choice by this metric.
    pub metric_since: u32,
    /// Whether a choice by these inputs came to nothing that is still to be made.
    pub rests: bool,
    /// What the newest choice does beside what it always does, and in how many rounds.
    pub extras: Extras,
    pub rounds: u32,
    /// Whether a budget reads the curve of the view's work; the newest choice that was handed to it.
    pub counted: Option<u32>,
    pub params: Buffer,
    numbers: Buffer,
    /// Of the store: records and heads.
    pub records: Buffer,
    pub heads: Buffer,
    pub seen: Buffer,
    pub counts: Buffer,
    pub lists: Buffer,
    pub looked: Buffer,
    pub arguments: Buffer,
    /// Of others' buffers that the groups hold.
    bound: Vec<Buffer>,
    pub groups: Option<BlockGroups>,
}

/// Bind groups of one view.
pub(in crate::render) struct BlockGroups {
    pub shared: BindGroup,
    pub looked: BindGroup,
    pub arguments: BindGroup,
    pub triangles: BindGroup,
    pub ground: BindGroup,
    pub head: BindGroup,
}

impl BlockState {
    /// `newest` is the number of the newest choice of the kind.
    pub fn new(device: &RenderDevice, store: &BlockStore, inputs: Inputs, newest: u32) -> Self {
        let buffer = |label, size: u64, usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let storage = BufferUsages::STORAGE;
        let uniform = |label, size: usize| buffer(label, size as u64, BufferUsages::UNIFORM);
        let indirect = |label, size| buffer(label, size, storage | BufferUsages::INDIRECT);
        let slots = store.slots;
        Self {
            inputs,
            slots,
            stamp: 0,
            since: newest + 1,
            metric_since: newest + 1,
            rests: false,
            extras: Extras::default(),
            rounds: 1,
            counted: None,
            params: uniform("blocks_params", size_of::<DetailParams>()),
            numbers: uniform("blocks_numbers", size_of::<BlockNumbers>()),
            records: store.records.clone(),
            heads: store.heads.clone(),
            seen: buffer("blocks_seen", SEEN_BYTES * u64::from(slots), storage),
            counts: buffer(
                "blocks_counts",
                4 * COUNT_WORDS as u64,
                storage | BufferUsages::COPY_SRC,
            ),
            lists: buffer("blocks_lists", 4 * list_words(slots), storage),
            looked: indirect("blocks_looked", LOOKED_BYTES),
            arguments: indirect("blocks_arguments", ARGUMENT_BYTES),
            bound: Vec::new(),
            groups: None,
        }
    }

    /// Bytes of its own buffers, without those of the store.
    pub fn bytes(&self) -> u64 {
        let own = [
            &self.params,
            &self.numbers,
            &self.seen,
            &self.counts,
            &self.lists,
            &self.looked,
            &self.arguments,
        ];
        own.iter().map(|buffer| buffer.size()).sum()
    }

    /// Whether it stands on the blocks of a store.
    pub fn is_of(&self, store: &BlockStore) -> bool {
        self.records.id() == store.records.id()
    }

    /// Takes over what the choices to come depend on.
    pub fn follow(&mut self, inputs: Inputs, newest: u32) {
        if self.inputs == inputs {
            return;
        }
        if self.inputs.detail.metric != inputs.detail.metric {
            self.metric_since = newest + 1;
        }
        self.since = newest + 1;
        self.rests = false;
        self.inputs = inputs;
    }

    /// Lets the choices to come find out anew whether there is anything to make: what blocks stand on has changed.
    pub fn look_again(&mut self, newest: u32) {
        self.since = newest + 1;
        self.rests = false;
    }

    /// What has come back of a choice by the metric as it is.
    pub fn news(&self, state: &GeometryView) -> Option<Head> {
        Head::of(state).filter(|head| head.stamp >= self.metric_since)
    }

    /// Whether a head that came back is of a choice by the present inputs that left nothing to be made.
    pub fn is_done(&self, head: Head) -> bool {
        head.stamp >= self.since && head.made == 0
    }

    /// Writes what the newest choice of the store is told, which is this view's; `sweep` is from which choice on blocks are kept, if any are dropped;
    /// as many blocks as the budget are made at most.
    pub fn tell(
        &mut self,
        queue: &RenderQueue,
        store: &BlockStore,
        state: &GeometryView,
        sweep: Option<u32>,
        (budget, numbers): (u32, BlockNumbers),
    ) {
        self.stamp = store.stamp;
        let params = DetailParams {
            stamp: self.stamp,
            oldest: sweep.unwrap_or(0),
            anchor_height: state.frame.anchor.y as f32,
            ..DetailParams::new(
                &store.ground,
                self.inputs.view,
                self.slots,
                [state.pool.vertices, state.pool.primitives],
            )
        };
        let horizon = self.inputs.horizon(&store.ground, params.anchor_height);
        let params = match &self.inputs.culled {
            Some((picture, others)) => params.cull(picture, *others),
            None => params,
        };
        let params = horizon.map_or(params, |horizon| params.occlude(horizon));
        let params = params.edited(&store.edited);
        self.extras = Extras {
            roots: store.fresh.then_some(store.beginning.made.len() as u32),
            sweeps: params.oldest > 0,
            edits: store.edit_rounds(numbers.remade),
            occluded: horizon.is_some(),
        };
        self.rounds = budget.div_ceil(MOST_MADE).clamp(1, MOST_ROUNDS);
        queue.write_buffer(&self.params, 0, bytes_of(&params));
        queue.write_buffer(&self.numbers, 0, bytes_of(&numbers));
        if store.fresh {
            let at = 4 * made_at(self.slots);
            queue.write_buffer(&self.lists, at, cast_slice(&store.beginning.made));
        }
    }

    /// Binds its buffers and those of others, where these are not those that were bound: vertices, indices and head,
    /// which the passes write; data of the ground.
    pub fn bind(
        &mut self,
        device: &RenderDevice,
        cache: &PipelineCache,
        pipelines: &BlockPipelines,
        store: &BlockStore,
        written: [&Buffer; 3],
        data: &[Buffer; 3],
    ) {
        let others: Vec<_> = written.into_iter().chain(data).cloned().collect();
        let known = self.bound.iter().map(|buffer| buffer.id());
        if self.groups.is_some() && known.eq(others.iter().map(|buffer| buffer.id())) {
            return;
        }
        let [vertices, indices, head] = written;
        let [layers, table, uniform] = data;
        self.groups = Some(BlockGroups {
            shared: device.create_bind_group(
                "blocks_shared",
                &cache.get_bind_group_layout(&pipelines.shared),
                &BindGroupEntries::sequential((
                    self.params.as_entire_binding(),
                    self.numbers.as_entire_binding(),
                    self.records.as_entire_binding(),
                    self.heads.as_entire_binding(),
                    self.seen.as_entire_binding(),
                    self.counts.as_entire_binding(),
                    self.lists.as_entire_binding(),
                )),
            ),
            looked: device.create_bind_group(
                "blocks_looked",
                &cache.get_bind_group_layout(&pipelines.looked),
                &BindGroupEntries::single(self.looked.as_entire_binding()),
            ),
            arguments: device.create_bind_group(
                "blocks_arguments",
                &cache.get_bind_group_layout(&pipelines.arguments),
                &BindGroupEntries::sequential((
                    self.looked.as_entire_binding(),
                    self.arguments.as_entire_binding(),
                    store.stock.as_entire_binding(),
                )),
            ),
            triangles: device.create_bind_group(
                "blocks_triangles",
                &cache.get_bind_group_layout(&pipelines.triangles),
                &BindGroupEntries::sequential((
                    vertices.as_entire_binding(),
                    indices.as_entire_binding(),
                )),
            ),
            ground: device.create_bind_group(
                "blocks_ground",
                &cache.get_bind_group_layout(&pipelines.ground),
                &BindGroupEntries::sequential((
                    layers.as_entire_binding(),
                    table.as_entire_binding(),
                    uniform.as_entire_binding(),
                    store.samples.as_entire_binding(),
                )),
            ),
            head: device.create_bind_group(
                "blocks_head",
                &cache.get_bind_group_layout(&pipelines.head),
                &BindGroupEntries::with_indices((
                    (0, head.as_entire_binding()),
                    (2, store.stock.as_entire_binding()),
                )),
            ),
        });
        self.bound = others;
    }
}
