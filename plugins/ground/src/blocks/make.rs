//! A block from its samples; the order of computing is that of [`super::record`].

use bevy::math::{IVec2, Vec2};
use dolomite_terrain::{GpuTerrainUniform, GroundPoint, Height, Planes, Terrain};

use super::between::Between;
use super::errors::{BED_SHARE, Inside, nested};
use super::place::{
    BlockPlace, CELLS, CORNER_COUNT, CornerKind, VERTICES, centre_number, centre_parents,
    corner_kind, corner_number, mixed_parents, vertex_at,
};
use super::record::{
    ALWAYS, Block, BlockHead, EMPTY, NEST, NO_BLOCK, RING, RINGED, RINGED_COUNT, pack_gradient,
    ring_number, ringed_number,
};
use super::triangle::{AROUND, SAMPLE_COUNT, SAMPLES, STEPS, Surface, WIDE, greater};
use crate::detail::DetailLattice;
use crate::range::OPAQUE_DEPTH;

/// How much the cut from above has changed: what the tail did not foresee.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CutCount {
    /// Vertices that had parents to be cut by, and any error.
    pub vertices: u32,
    /// Of these, how many were cut.
    pub cut: u32,
    /// The least share that was left of an error.
    pub least: f32,
}

/// What is known where nothing was made: a block of zeros at a place.
fn blank(place: BlockPlace) -> Block {
    Block {
        head: BlockHead {
            centre: place.cell().centre,
            half: place.cell().half,
            parent: NO_BLOCK,
            children: [NO_BLOCK; 4],
            looked: 0,
            mixed_error: 0.0,
            low: EMPTY[0],
            high: EMPTY[1],
        },
        heights: [0.0; VERTICES],
        gradients: [0; VERTICES],
        errors: [0.0; VERTICES],
        lows: [EMPTY[0]; VERTICES],
        highs: [EMPTY[1]; VERTICES],
        ring_errors: [0.0; RING],
        cell_lows: [EMPTY[0]; RINGED_COUNT],
        cell_highs: [EMPTY[1]; RINGED_COUNT],
    }
}

/// Number of the sample that stands so many half cells from the block's corner.
const fn sample_at(half_cells: IVec2) -> usize {
    let step = STEPS as i32 / 2;
    let around = AROUND * STEPS as i32;
    (half_cells.y * step + around) as usize * SAMPLES + (half_cells.x * step + around) as usize
}

/// Which samples of a block lie on the lattice.
fn inside(lattice: &DetailLattice, place: BlockPlace) -> Inside {
    let first = sample_on_lattice(place, IVec2::ZERO);
    let step = i64::from(place.sample_step());
    let far = (lattice.roots << (lattice.depth + 1))
        .as_i64vec2()
        .to_array();
    let most = SAMPLES as i64 - 1;
    Inside {
        first: first.map(|first| (-first / step).clamp(0, most) as i32),
        last: [0, 1].map(|axis| ((far[axis] - first[axis]) / step).clamp(0, most) as i32),
    }
}

/// Lattice coordinates of sample (i, j) of a block; before the lattice's first line they are below 0.
fn sample_on_lattice(place: BlockPlace, at: IVec2) -> [i64; 2] {
    let step = i64::from(place.sample_step());
    let first = place.cell().centre.as_i64vec2() - i64::from(place.cell().half);
    let at = first + (at - AROUND * STEPS as i32).as_i64vec2() * step;
    at.to_array()
}

/// Places of a block's samples, row by row.
pub fn sample_places(
    lattice: &DetailLattice,
    place: BlockPlace,
) -> impl Iterator<Item = GroundPoint> {
    (0..SAMPLE_COUNT as i32).map(move |k| {
        let at = IVec2::new(k % SAMPLES as i32, k / SAMPLES as i32);
        lattice.signed_point(sample_on_lattice(place, at))
    })
}

/// Where columns and rows of samples stand, in steps, if they do not stand evenly: beside the border of an
/// aligned lattice.
fn rulers(lattice: &DetailLattice, place: BlockPlace) -> Option<[Vec<f32>; 2]> {
    let along = |axis: usize| {
        let at = |k: usize| {
            let at = sample_on_lattice(place, IVec2::splat(k as i32));
            lattice.signed_point(at).to_fixed()[axis]
        };
        let step = lattice.step[axis] as f64 * f64::from(place.sample_step());
        let first = at(0);
        let all = (0..SAMPLES).map(|k| (at(k).wrapping_sub(first) as f64 / step) as f32);
        all.collect::<Vec<f32>>()
    };
    // Step by step: a narrow first column and a wide last one may have the length of two like the others.
    let uneven = |ruler: &Vec<f32>| {
        ruler
            .array_windows()
            .any(|[a, b]| (b - a - 1.0).abs() > 1e-4)
    };
    let rulers = [along(0), along(1)];
    (lattice.border.width > 0 && rulers.iter().any(uneven)).then_some(rulers)
}

/// The ground at the samples of a block.
#[must_use]
pub fn samples(terrain: &Terrain, lattice: &DetailLattice, place: BlockPlace) -> Vec<Height> {
    let points: Vec<_> = sample_places(lattice, place).collect();
    let mut planes = [(); 3].map(|()| vec![0.0; points.len()]);
    let [value, dx, dz] = &mut planes;
    terrain
        .fill_points(&points, Planes { value, dx, dz })
        .expect("three planes as long as the list");
    (0..points.len())
        .map(|k| Height {
            value: planes[0][k],
            gradient: Vec2::new(planes[1][k], planes[2][k]),
        })
        .collect()
}

/// Makes a block of a terrain. `parent` is the record of its parent, `None` for a root.
#[must_use]
pub fn make(
    terrain: &Terrain,
    lattice: &DetailLattice,
    place: BlockPlace,
    parent: Option<&Block>,
) -> (Box<Block>, CutCount) {
    let sea = terrain.sea_level().unwrap_or(GpuTerrainUniform::NO_SEA);
    let heights = samples(terrain, lattice, place);
    let drawn: Vec<f32> = heights.iter().map(|h| h.value.max(sea)).collect();
    let bed: Vec<f32> = heights
        .iter()
        .map(|h| h.value.clamp(sea - OPAQUE_DEPTH, sea))
        .collect();
    let mut surfaces = vec![(Surface(&drawn), 1.0)];
    // Else the bed is nowhere seen through water, and flat here.
    if heights.iter().any(|h| h.value < sea) && heights.iter().any(|h| h.value > sea - OPAQUE_DEPTH)
    {
        surfaces.push((Surface(&bed), BED_SHARE));
    }
    let raw: Vec<f32> = heights.iter().map(|h| h.value).collect();
    let with = (lattice, place);
    let between = Between::new(terrain, with, Surface(&raw), &surfaces, sea);
    let rulers = rulers(lattice, place);
    let inside = inside(lattice, place);
    let nested = nested(&surfaces, &between.tails, inside, rulers.as_ref());
    let mut block = Box::new(blank(place));
    let mut made = Made {
        lattice,
        place,
        parent,
        block: &mut block,
        count: CutCount {
            least: 1.0,
            ..CutCount::default()
        },
    };
    made.heights(&heights);
    made.errors(&nested);
    made.intervals(&between, sea);
    let count = made.count;
    if let Some(parent) = parent {
        from_parent(&mut block, place, parent);
    }
    finish(&mut block);
    (block, count)
}

/// A block that is being made.
struct Made<'a> {
    lattice: &'a DetailLattice,
    place: BlockPlace,
    parent: Option<&'a Block>,
    block: &'a mut Block,
    count: CutCount,
}

impl Made<'_> {
    fn heights(&mut self, heights: &[Height]) {
        for number in 0..VERTICES {
            let height = &heights[sample_at(vertex_at(number))];
            self.block.heights[number] = height.value;
            self.block.gradients[number] = pack_gradient(height.gradient);
        }
    }

    /// An error cut from above by the least of its parents'; `None`s are not on the lattice.
    fn cut(&mut self, error: f32, parents: [Option<f32>; 2]) -> f32 {
        let least = parents.into_iter().flatten().fold(ALWAYS, f32::min);
        if least == ALWAYS {
            return error;
        }
        let most = NEST * least;
        if error > 0.0 {
            self.count.vertices += 1;
            if error > most {
                self.count.cut += 1;
                self.count.least = self.count.least.min(most / error);
            }
        }
        error.min(most)
    }

    fn errors(&mut self, nested: &[f32]) {
        // Mixed corners, −1 to 17, in a grid of their own.
        const SIDE: i32 = CELLS + 3;
        let number = |at: IVec2| ((at.y + 1) * SIDE + at.x + 1) as usize;
        let mut mixed = vec![0.0; (SIDE * SIDE) as usize];
        for y in -1..=CELLS + 1 {
            for x in -1..=CELLS + 1 {
                let at = IVec2::new(x, y);
                // Odd ones from −1 to 17, even ones from 0 to 16: those of the cells of the ring of one.
                if corner_kind(at) == CornerKind::Mixed {
                    mixed[number(at)] = self.mixed_error(nested, at);
                }
            }
        }
        for y in -1..=CELLS {
            for x in -1..=CELLS {
                let at = IVec2::new(x, y);
                if !self.lattice.holds(self.place.cell_at(at)) {
                    continue;
                }
                let parents = centre_parents(at).map(|corner| Some(mixed[number(corner)]));
                let error = self.cut(nested[sample_at(at * 2 + 1)], parents);
                match ring_number(at) {
                    Some(number) => self.block.ring_errors[number] = error,
                    None => self.block.errors[centre_number(at)] = error,
                }
            }
        }
        for k in 0..CORNER_COUNT {
            let corner = vertex_at(k) / 2;
            self.block.errors[k] = match corner_kind(corner) {
                CornerKind::Mixed => mixed[number(corner)],
                // Of a root; other blocks take theirs from the parent.
                _ => ALWAYS,
            };
        }
        if self.parent.is_none() {
            for k in 0..CORNER_COUNT {
                self.block.errors[k] = ALWAYS;
            }
        }
    }

    /// Error of a mixed corner, in the ring too. [`ALWAYS`] where a root has it.
    fn mixed_error(&mut self, nested: &[f32], at: IVec2) -> f32 {
        let parents = mixed_parents(at);
        let mut above = [None; 2];
        for (above, centre) in above.iter_mut().zip(parents) {
            let cell = self.place.cell_at(centre).parent();
            if self.lattice.holds(cell) {
                let there = self.place.cell_in_parent(centre);
                *above = self.parent.map(|parent| parent.centre_error(there));
            }
        }
        if self.parent.is_none() {
            return ALWAYS;
        }
        self.cut(nested[sample_at(at * 2)], above)
    }

    fn intervals(&mut self, between: &Between, sea: f32) {
        let mut lows = vec![EMPTY[0]; WIDE * WIDE];
        let mut highs = vec![EMPTY[1]; WIDE * WIDE];
        for k in 0..WIDE * WIDE {
            let at = IVec2::new((k % WIDE) as i32, (k / WIDE) as i32);
            let cell = at - AROUND;
            // No vertex reaches farther.
            if cell.min_element() < -2 || cell.max_element() > CELLS + 1 {
                continue;
            }
            if !self.lattice.holds(self.place.cell_at(cell)) {
                continue;
            }
            [lows[k], highs[k]] = between.interval(at, sea);
            if let Some(parent) = self.parent {
                let [low, high] = parent.cell_interval(self.place.cell_in_parent(cell));
                (lows[k], highs[k]) = (lows[k].max(low), highs[k].min(high));
            }
        }
        for k in 0..RINGED_COUNT {
            let at = IVec2::new((k % RINGED) as i32, (k / RINGED) as i32) - 1;
            let wide = (at.y + AROUND) as usize * WIDE + (at.x + AROUND) as usize;
            self.block.cell_lows[ringed_number(at)] = lows[wide];
            self.block.cell_highs[ringed_number(at)] = highs[wide];
        }
        for number in 0..VERTICES {
            let at = vertex_at(number);
            // 3 × 3 cells about a centre, 4 × 4 about a corner; of the others the parent knows.
            let count = if number < CORNER_COUNT { 4 } else { 3 };
            let first = at / 2 - if number < CORNER_COUNT { 2 } else { 1 } + AROUND;
            let [mut low, mut high] = EMPTY;
            for z in first.y..first.y + count {
                for x in first.x..first.x + count {
                    let k = z as usize * WIDE + x as usize;
                    low = low.min(lows[k]);
                    high = high.max(highs[k]);
                }
            }
            self.block.lows[number] = low;
            self.block.highs[number] = high;
        }
    }
}

/// Takes what is older than the block from its parent.
pub(super) fn from_parent(block: &mut Block, place: BlockPlace, parent: &Block) {
    for number in 0..CORNER_COUNT {
        let corner = vertex_at(number) / 2;
        if corner_kind(corner) == CornerKind::Mixed {
            continue;
        }
        let there = place.number_in_parent(corner);
        block.heights[number] = parent.heights[there];
        block.gradients[number] = parent.gradients[there];
        block.errors[number] = parent.errors[there];
        block.lows[number] = parent.lows[there];
        block.highs[number] = parent.highs[there];
    }
}

/// What the block as a whole is looked at by.
fn finish(block: &mut Block) {
    let head = &mut block.head;
    for number in 0..VERTICES {
        let corner = vertex_at(number) / 2;
        let mixed = number < CORNER_COUNT && corner_kind(corner) == CornerKind::Mixed;
        if mixed {
            head.mixed_error = greater(head.mixed_error, block.errors[number]);
        }
        if mixed || number >= CORNER_COUNT {
            head.low = head.low.min(block.lows[number]);
            head.high = head.high.max(block.highs[number]);
        }
    }
    debug_assert_eq!(corner_number(IVec2::splat(CELLS)), CORNER_COUNT - 1);
}
