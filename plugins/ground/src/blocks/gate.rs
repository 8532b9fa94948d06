//! Which blocks can be made of a map that is read by tiles: those whose samples stand on samples that are there.
//!
//! A block's samples stand a quarter of a cell apart. Where that is 2ᵏ samples of the map, those of level k tell the same bits as the map itself, and the level's deviations
//! what lies between them. So a block waits for its level, not for a finer one; and until it is there, the view keeps to the bound of what has
//! been made, as for any block that has not.

use bevy::math::DVec2;
use dolomite_terrain::{HeightMap, MOST_LEVELS, Readable, Terrain};

use super::place::BlockPlace;
use super::triangle::{AROUND, STEPS};
use crate::detail::DetailLattice;

/// Beyond every place of a lattice.
const FAR: i32 = 1 << 30;

/// About which places of a lattice samples are there; see `shaders/src/blocks/gate.wgsl`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gate {
    /// Steps of the lattice between samples of the map, as a power of two.
    pub shift: u32,
    /// Of each level: first x and z, last x and z.
    pub readable: Vec<[i32; 4]>,
}

/// Whether a lattice stands on the samples of a map, from the first one on, so that every 2ᵏth of its lines does on level k.
#[must_use]
pub fn stands_on(lattice: &DetailLattice, terrain: &Terrain, map: &HeightMap) -> bool {
    let cells = (lattice.roots << (lattice.depth + 1)).as_dvec2();
    let width = f64::from(lattice.border.width);
    let (extent, whole) = (terrain.extent(), map.rect());
    let near =
        |a: DVec2, b: DVec2| (a - b).abs().max_element() < 1e-3 * map.spacing().min_element();
    width > 0.0
        && near(extent.min, whole.min)
        && near(extent.max, whole.max)
        && cells == ((whole.max - whole.min) / map.spacing()).round() * width
}

impl Gate {
    /// Of the map of a terrain that is read by tiles, with what may be read of it; `None`: there is no such map.
    #[must_use]
    pub fn new(terrain: &Terrain, lattice: &DetailLattice, readable: &[Readable]) -> Option<Self> {
        let map = terrain.streamed()?;
        let stream = map.stream()?;
        let shift = lattice.border.width.max(1).trailing_zeros();
        let levels = readable.iter().take(MOST_LEVELS).enumerate();
        let of_level = |(level, readable): (usize, &Readable)| {
            let Some([low, high]) = readable else {
                return [FAR, FAR, -FAR, -FAR];
            };
            let samples = stream.tiles().samples(level as u32);
            let place = |sample: i64| {
                let place = sample << (level as u32 + shift);
                place.clamp(-i64::from(FAR), i64::from(FAR)) as i32
            };
            // Catmull-Rom takes one sample before and two after; and one more may be taken where rounding puts a place before its sample.
            // Beyond the map its border goes on.
            let first = |k: usize| match low[k] {
                0 => -FAR,
                low => place(i64::from(low) + 2),
            };
            let last = |k: usize| match high[k] + 1 >= samples[k] {
                true => FAR,
                false => place(i64::from(high[k]) - 3),
            };
            [first(0), first(1), last(0), last(1)]
        };
        Some(Self {
            shift,
            readable: levels.map(of_level).collect(),
        })
    }

    /// Whether a block can be made.
    #[must_use]
    pub fn holds(&self, place: BlockPlace) -> bool {
        let step = place.sample_step();
        let finer = step.max(1).ilog2().saturating_sub(self.shift) as usize;
        let Some(there) = self
            .readable
            .get(finer.min(self.readable.len().saturating_sub(1)))
        else {
            return true;
        };
        let cell = place.cell();
        let reach = (cell.half + AROUND as u32 * STEPS as u32 * step) as i32;
        let centre = cell.centre.as_ivec2();
        let (low, high) = (centre - reach, centre + reach);
        low.x >= there[0] && low.y >= there[1] && high.x <= there[2] && high.y <= there[3]
    }
}
