//! Tiles of maps are read in the background, about the place that a [`MapFocus`] names.

use crate::height_map::{HeightMap, Stream, TileRequest};
use crate::terrain::Terrain;
use bevy::ecs::prelude::*;
use bevy::ecs::reflect::ReflectResource;
use bevy::math::DVec2;
use bevy::platform::time::Instant;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once};
use dolomite_elevation::{ElevationError, TileSamples};
use std::sync::Arc;
use std::time::Duration;

/// How maps are read by tiles. Without such a map nothing of it runs.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default)]
pub struct MapStreaming {
    /// Tiles that are read at a time, each in a task of its own.
    pub tasks: u32,
    /// Most tiles that are taken over in a frame: 64 KiB each, of coarser levels 192, copied once in memory and once to a GPU.
    pub tiles_a_frame: u32,
}

impl Default for MapStreaming {
    fn default() -> Self {
        Self {
            tasks: 4,
            tiles_a_frame: 8,
        }
    }
}

/// Where fine ground is wanted, (x, z) in metres. `dolomite_ground` keeps it at the first camera that sees the ground; without a renderer
/// whoever needs true ground somewhere does. `None`: nothing is read.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Resource, Default)]
pub struct MapFocus(pub Option<DVec2>);

/// What has been read by tiles so far.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default)]
pub struct MapStreamingStats {
    /// Tiles that were taken over.
    pub arrived: u64,
    /// Tiles that came too late and were thrown away.
    pub late: u64,
    /// Tiles that could not be read.
    pub failed: u64,
    /// Tiles that are wanted now and not there.
    pub missing: u32,
    /// Most tiles that were taken over in a frame.
    pub most_a_frame: u32,
}

/// What went wrong while tiles were read, once a map. `dolomite_ground` tells it and takes it out.
#[derive(Resource, Clone, Debug, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct MapFaults(pub Vec<String>);

/// How long tiles gather while more are on their way, before [`Terrain`] is told of them.
const TELLS: Duration = Duration::from_millis(500);

/// A tile on its way.
struct Read {
    map: Arc<Stream>,
    request: TileRequest,
    task: Task<Result<TileSamples, ElevationError>>,
}

/// What is on its way.
#[derive(Resource, Default)]
pub(crate) struct Reads {
    running: Vec<Read>,
}

/// Whether any terrain has such a map, or a read of one that is gone is still on its way.
pub(crate) fn any_map_by_tiles(terrains: Query<&Terrain>, reads: Res<Reads>) -> bool {
    !reads.running.is_empty() || terrains.iter().any(|terrain| terrain.streamed().is_some())
}

/// Takes over what has arrived, and asks for what is missing. Waits for nothing.
pub(crate) fn read_tiles(
    mut terrains: Query<&mut Terrain>,
    focus: Res<MapFocus>,
    settings: Res<MapStreaming>,
    mut stats: ResMut<MapStreamingStats>,
    mut faults: ResMut<MapFaults>,
    mut reads: ResMut<Reads>,
    mut told: Local<Option<Instant>>,
) {
    let maps: Vec<HeightMap> = terrains
        .iter()
        .filter_map(Terrain::streamed)
        .cloned()
        .collect();
    // Terrains may share a map: it is read once.
    let mut streams: Vec<Arc<Stream>> = Vec::new();
    for stream in maps.iter().filter_map(HeightMap::shared_stream) {
        if !streams.iter().any(|known| Arc::ptr_eq(known, &stream)) {
            streams.push(stream);
        }
    }
    let is_used = |map: &Arc<Stream>| streams.iter().any(|used| Arc::ptr_eq(used, map));
    // A task that is dropped is not read to its end.
    reads.running.retain(|read| is_used(&read.map));
    let (Some(place), false) = (focus.0, streams.is_empty()) else {
        return;
    };
    for map in &maps {
        map.follow(place);
    }
    let mut taken = 0;
    let mut running = Vec::new();
    for mut read in std::mem::take(&mut reads.running) {
        if taken >= settings.tiles_a_frame.max(1) {
            running.push(read);
            continue;
        }
        match block_on(poll_once(&mut read.task)) {
            None => running.push(read),
            Some(Ok(tile)) => {
                taken += 1;
                match read.map.put(read.request, &tile) {
                    true => stats.arrived += 1,
                    false => stats.late += 1,
                }
            }
            Some(Err(fault)) => {
                stats.failed += 1;
                if !read.map.is_given_up() {
                    faults.0.push(format!("{fault}; the ground stays as it is"));
                    read.map.give_up();
                }
            }
        }
    }
    reads.running = running;
    stats.most_a_frame = stats.most_a_frame.max(taken);
    stats.missing = 0;
    for map in &streams {
        let missing = map.missing(false);
        stats.missing += missing.len() as u32;
        if map.is_given_up() {
            continue;
        }
        for request in missing {
            if reads.running.len() >= settings.tasks.max(1) as usize {
                break;
            }
            let is_it = |read: &Read| Arc::ptr_eq(&read.map, map) && read.request == request;
            if reads.running.iter().any(is_it) {
                continue;
            }
            let stream = Arc::clone(map);
            let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
            let task = pool.spawn(async move { stream.load(request) });
            reads.running.push(Read {
                map: Arc::clone(map),
                request,
                task,
            });
        }
    }
    // Whoever stands on the ground looks where it has become finer; not with each of many tiles that come at once.
    let is_due = stats.missing == 0 || told.is_none_or(|last| last.elapsed() >= TELLS);
    if is_due {
        *told = Some(Instant::now());
        for mut terrain in &mut terrains {
            let now = terrain.with_arrived();
            if !now.same_arrived(&terrain) {
                *terrain = now;
            }
        }
    }
}
