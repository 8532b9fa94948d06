//! Tiles of a map that have been read since: into the data of the ground on the GPU.

use std::collections::BTreeMap;

use bevy::render::render_resource::Buffer;
use bevy::render::renderer::RenderQueue;
use bytemuck::cast_slice;
use dolomite_terrain::{HeightMap, MapWrite, Readable, Terrain};

/// What is on its way into the data of a ground, and what these hold then.
#[derive(Default)]
pub(super) struct Tiles {
    /// Word of the data from which on the map stands.
    first: u64,
    /// Which map's they are ([`Stream::id`](dolomite_terrain::Stream::id)).
    of: u64,
    /// Until when the map has told.
    now: u64,
    /// By where they go. They gather while data are laid out that are yet to be bound, and while nobody looks.
    writes: BTreeMap<u64, Vec<u32>>,
    /// What may be read of each level once all is written.
    pub readable: Vec<Readable>,
    /// Whether more is being read.
    pub awaited: bool,
}

impl Tiles {
    /// Takes what has been read since the last frame. `None`: no map of the terrain is read by tiles. Between two frames of the main
    /// world, so that what is taken is of the data which that world has laid out last.
    pub fn extract(known: Option<Self>, terrain: &Terrain) -> Option<Self> {
        let stream = terrain.streamed().and_then(HeightMap::stream)?;
        let known = known.filter(|known| known.of == stream.id());
        let mut tiles = known.unwrap_or_else(|| Self {
            of: stream.id(),
            now: stream.laid_out(),
            ..Self::default()
        });
        // Data that were laid out anew meanwhile hold some of it already: it is the same.
        let news = stream.news(tiles.now);
        tiles.now = news.now;
        tiles.first = terrain.streamed_at()?;
        let news_at = |MapWrite { at, words }| (at, words);
        tiles.writes.extend(news.list.into_iter().map(news_at));
        tiles.readable = news.readable;
        tiles.awaited = stream.is_awaited();
        Some(tiles)
    }

    /// Writes it. Whether the data have changed.
    pub fn write(&mut self, data: &Buffer, queue: &RenderQueue) -> bool {
        let changed = !self.writes.is_empty();
        for (at, words) in std::mem::take(&mut self.writes) {
            queue.write_buffer(data, 4 * (self.first + at), cast_slice(&words));
        }
        changed
    }
}
