//! Which views choose their ground, and what of them is made or told anew.

use std::collections::HashMap;
use std::marker::PhantomData;

use bevy::prelude::*;
use bevy::render::render_resource::PipelineCache;
use bevy::render::renderer::{RenderAdapterInfo, RenderDevice, RenderQueue};
use bevy::render::view::ExtractedView;
use dolomite_geometry::render::{GeometryShared, GeometryView, Producer, Producers};
use dolomite_terrain::Terrain;

use super::BlockShaders;
use super::head::Head;
use super::host;
use super::pace::Pace;
use super::pipeline::BlockPipelines;
use super::state::{BlockState, Inputs};
use super::store::{BlockStore, slots_for};
use crate::blocks::gate::Gate;
use crate::blocks::layout::BlockNumbers;
use crate::detail::layout::without;
use crate::detail::{DetailLattice, Metric, TerrainLod};
use crate::render::detail::extract::ExtractedGround;
use crate::render::detail::view::{detail_view, picture};
use crate::render::detail::want::DetailData;
use crate::render::detail::{DetailKind, detail_key};
use crate::render::drawn::DrawnGround;
use crate::render::pools::PoolRooms;

/// Every view that chooses its ground, and what all have in common.
#[derive(Resource)]
pub struct BlockViews<K> {
    pub(super) pipelines: Option<BlockPipelines>,
    pub(in crate::render) views: HashMap<Entity, BlockState>,
    /// The blocks that views share, by the bits of the side of their smallest cell.
    pub(super) stores: HashMap<u32, BlockStore>,
    pub(super) pace: Option<Pace>,
    /// Whether tiles of a map are on their way.
    waits: bool,
    /// Number of the newest choice.
    stamp: u32,
    kind: PhantomData<fn() -> K>,
}

impl<K> Default for BlockViews<K> {
    fn default() -> Self {
        Self {
            pipelines: None,
            views: HashMap::new(),
            stores: HashMap::new(),
            pace: None,
            waits: false,
            stamp: 0,
            kind: PhantomData,
        }
    }
}

impl<K> BlockViews<K> {
    /// The lattice of a view's ground, and its metric.
    pub(in crate::render) fn lattice(&self, view: Entity) -> Option<(&DetailLattice, Metric)> {
        let detail = self.views.get(&view)?.inputs.detail;
        let store = self.stores.get(&detail.finest.to_bits())?;
        Some((&store.ground.lattice, detail.metric))
    }

    /// What a view has drawn.
    pub(in crate::render) fn drawn(
        &self,
        view: Entity,
        state: &GeometryView,
    ) -> Option<DrawnGround> {
        let own = self.views.get(&view)?;
        Some(DrawnGround {
            drawn: state.is_shown(),
            settled: state.settled && state.filled && own.rests && !self.waits,
            held: match own.inputs.detail.metric {
                Metric::ErrorBound { pixels } | Metric::EdgeLength { pixels } => {
                    own.news(state).map(|head| pixels * head.held())
                }
                Metric::Classic { .. } => None,
            },
        })
    }
}

/// An edit makes anew as many blocks as so many frames make; the others that it reaches are dropped, the finest of them, and
/// are made as all that is missing. Those that are only refreshed do not count: no height is looked up for them.
const EDIT_FRAMES: u32 = 4;

/// The stores that the cameras need: one for each size of the smallest cell, as large as the greatest view of it asks
/// for. Which of those that stay were edited, where blocks may be.
fn keep_stores(
    stores: &mut HashMap<u32, BlockStore>,
    terrain: &Terrain,
    cameras: &[(Entity, TerrainLod)],
    (device, queue): (&RenderDevice, &RenderQueue),
    stamp: u32,
) -> Vec<u32> {
    let mut wanted: HashMap<u32, u32> = HashMap::new();
    let mut edited = Vec::new();
    for (_, detail) in cameras {
        let slots = slots_for(device, detail);
        let most = wanted.entry(detail.finest.to_bits()).or_default();
        *most = slots.max(*most);
    }
    stores.retain(|finest, store| {
        let stays = wanted.get(finest) == Some(&store.slots);
        let follows = stays.then(|| store.follow_edits(terrain)).flatten();
        edited.extend(follows.filter(|edited| *edited).map(|_| *finest));
        follows.is_some()
    });
    for (finest, slots) in wanted {
        stores.entry(finest).or_insert_with(|| {
            BlockStore::new(
                device,
                queue,
                terrain,
                (f32::from_bits(finest), slots),
                stamp,
            )
        });
    }
    edited
}

/// What the views of a store come to.
struct News {
    /// Blocks in use, as of the newest choice that has come back.
    used: u32,
    /// Blocks that the views look at.
    needed: u32,
    /// The oldest choice of a view that draws.
    oldest: u32,
    /// Whether a view rests that wishes for more.
    hungry: bool,
}

fn news(views: &HashMap<Entity, BlockState>, producer: &Producer, store: &BlockStore) -> News {
    let mut news = News {
        used: 0,
        needed: 0,
        oldest: store.stamp,
        hungry: false,
    };
    let mut newest = 0;
    for (entity, own) in views.iter().filter(|(_, own)| own.is_of(store)) {
        let Some(head) = producer.views.get(entity).and_then(Head::of) else {
            continue;
        };
        news.needed = news.needed.saturating_add(head.candidates);
        news.oldest = news.oldest.min(own.stamp);
        news.hungry |= own.rests && head.wishes > 0;
        // Those that rest have old counters.
        if head.stamp >= newest {
            (newest, news.used) = (head.stamp, head.used);
        }
    }
    news
}

/// Of each store from which blocks are to be dropped: those that no choice from this one on has looked at.
fn sweeps<K>(blocks: &mut BlockViews<K>, producer: &mut Producer) -> HashMap<u32, u32> {
    let mut sweeps = HashMap::new();
    let BlockViews { stores, views, .. } = blocks;
    for (finest, store) in stores {
        let news = news(views, producer, store);
        let before = store.is_swept();
        let Some(sweep) = store.sweep(news.used, news.needed, news.oldest) else {
            continue;
        };
        sweeps.insert(*finest, sweep);
        let count = views.len() as u32;
        for own in views.values_mut().filter(|own| own.is_of(store)) {
            // Who has rested for long marks its blocks anew, so that the next sweep finds others; and who had no room
            // looks whether there is some now.
            let is_old = own.stamp + count <= store.stamp;
            let has_hope = news.hungry && !before;
            own.rests &= !(is_old || has_hope);
        }
    }
    sweeps
}

/// Makes what is missing, and writes what views are told that choose anew.
pub fn prepare<K: DetailKind>(
    mut producers: ResMut<Producers>,
    mut blocks: ResMut<BlockViews<K>>,
    (bound, mut ground, mut rooms): (
        Res<DetailData<K>>,
        ResMut<ExtractedGround<K>>,
        ResMut<PoolRooms<K>>,
    ),
    cameras: Query<&ExtractedView>,
    (shaders, cache, shared): (Res<BlockShaders>, Res<PipelineCache>, Res<GeometryShared>),
    (device, queue, adapter): (Res<RenderDevice>, Res<RenderQueue>, Res<RenderAdapterInfo>),
) {
    let Some(producer) = producers.get_mut(detail_key::<K>()) else {
        return;
    };
    let blocks = &mut *blocks;
    // Patches of the ground read the data too, where no view chooses.
    producer.shared_bytes = ground.data_bytes;
    (producer.pipelines, producer.fault) = (0, None);
    let seeing = ground.cameras.iter().copied();
    let seeing: Vec<_> = seeing
        .filter(|(camera, _)| producer.views.contains_key(camera))
        .collect();
    let is_seeing = |entity: &Entity| seeing.iter().any(|(camera, _)| camera == entity);
    blocks.views.retain(|entity, _| is_seeing(entity));
    rooms.keep(is_seeing);
    let ground = &mut *ground;
    let tiles = &mut ground.tiles;
    let (Some(data), Some(terrain), false) = (&bound.heights, &ground.terrain, seeing.is_empty())
    else {
        blocks.views.clear();
        blocks.stores.clear();
        blocks.pace = None;
        return;
    };
    blocks.waits = tiles.as_ref().is_some_and(|tiles| tiles.awaited);
    // Those of this terrain have to be bound. Until they are nothing is chosen.
    if let Some(tiles) = tiles.as_mut().filter(|_| !bound.is_due)
        && tiles.write(&data[1], &queue)
    {
        for own in blocks.views.values_mut() {
            own.look_again(blocks.stamp);
        }
    }
    let without = without(terrain);
    let known = blocks.pipelines.take();
    let known = known.filter(|known| known.without == without);
    if known.is_none() {
        // Other code may round otherwise: what it makes does not meet what was made before, to the bit.
        blocks.stores.clear();
    }
    let pipelines = known.unwrap_or_else(|| BlockPipelines::new(&shaders, without, &cache));
    producer.pipelines = pipelines.count();
    producer.fault = pipelines.fault(&cache);
    let edited = keep_stores(
        &mut blocks.stores,
        terrain,
        &seeing,
        (&device, &queue),
        blocks.stamp,
    );
    for own in blocks.views.values_mut() {
        // Roots are reached, which every view draws.
        if edited.contains(&own.inputs.detail.finest.to_bits()) {
            own.look_again(blocks.stamp);
        }
    }
    let bytes = blocks.stores.values().map(BlockStore::bytes);
    producer.shared_bytes += bytes.sum::<u64>();
    let mut sweeps = sweeps(blocks, producer);
    let pace = blocks
        .pace
        .get_or_insert_with(|| Pace::new(&device, adapter.device_type));
    let views = seeing.len() as u32;
    let budget = match ground.making.blocks {
        Some(blocks) => blocks.div_ceil(views),
        None => pace.budget(views),
    };
    let one_sided = !producer.traits.double_sided;
    for (entity, detail) in &seeing {
        let (Some(state), Ok(view)) = (producer.views.get_mut(entity), cameras.get(*entity)) else {
            continue;
        };
        let finest = detail.finest.to_bits();
        let Some(store) = blocks.stores.get_mut(&finest) else {
            continue;
        };
        // Shadow views see what the camera does not.
        let shadowed = !state.shadows.is_empty();
        let [solid, _] = state.shown;
        let inputs = Inputs {
            detail: *detail,
            view: detail_view(view, &state.frame, ground.relief, detail),
            culled: detail
                .culled
                .then(|| (picture(&state.frame, one_sided), shadowed)),
            solid,
            on_host: ground.on_host,
        };
        let known = blocks.views.get(entity);
        if known.is_none_or(|known| !known.is_of(store)) {
            let own = BlockState::new(&device, store, inputs.clone(), blocks.stamp);
            blocks.views.insert(*entity, own);
            state.settled = false;
        }
        let Some(own) = blocks.views.get_mut(entity) else {
            continue;
        };
        own.follow(inputs, blocks.stamp);
        let counted = ground.counted.contains(entity) && !ground.on_host;
        if counted != own.counted.is_some() {
            own.counted = counted.then_some(0);
        }
        state.own_bytes = own.bytes();
        if let Some(head) = own.news(state) {
            state.looked_at = head.candidates;
            let roots = store.ground.lattice.roots;
            let needed = head.needed(roots.x * roots.y);
            let grows = rooms.fit(*entity, needed, detail.max_vertices);
            own.rests |= state.settled && own.is_done(head);
            own.rests &= !grows;
        }
        state.settled &= own.rests;
        if ground.on_host {
            if !state.settled {
                blocks.stamp += 1;
                store.stamp = blocks.stamp;
                host::choose(own, store, state, (&queue, &shared));
            }
            continue;
        }
        let written = [&state.vertices, &state.indices, &state.work];
        own.bind(&device, &cache, &pipelines, store, written, data);
        if !state.settled {
            blocks.stamp += 1;
            store.stamp = blocks.stamp;
            let gate = tiles
                .as_ref()
                .and_then(|tiles| Gate::new(terrain, &store.ground.lattice, &tiles.readable));
            let numbers = BlockNumbers::new(budget).remaking(budget.saturating_mul(EDIT_FRAMES));
            let numbers = gate.map_or(numbers, |gate| numbers.gated(&gate));
            let sweep = sweeps.remove(&finest);
            own.tell(&queue, store, state, sweep, (budget, numbers));
        }
    }
    blocks.pipelines = Some(pipelines);
}
