//! Heights and error bounds of a cell, made once from a few samples and kept.
//!
//! **Error.** The cell is sampled at [`SAMPLES`]² places. For each of the meshes that bisection makes of it, down
//! to triangles of two samples a side, the largest second difference is taken: how far a sample lies from
//! the plane of the triangle around it. A mesh's error is the largest of its own and of all finer ones
//! (a vertex must not hide those that need it), and what the samples may have missed:
//!
//! - [`TAIL`] times the finest second difference ε. Of a smooth surface no more than a third of that lies
//!   between the samples: halving the spacing quarters the error, ¼ + 1/16 + … of ε. Of noise whose
//!   octaves are as high as their wavelength is long, halving halves it: ½ + ¼ + … = 1. Octaves finer
//!   than the samples are in ε with all of their amplitude, since samples are not filtered; but few
//!   samples may all lie where noise is calm. So this is an estimate, which the lab's study `lod` tries.
//! - what stands alone and is narrower than the samples' spacing, [`Terrain::unseen`]: hills, and the
//!   samples of height maps.
//! - the rounding of heights in f32.
//!
//! **Water.** The drawn surface is the ground or the sea above it. The bed counts by half, as deep as it
//! can be seen: light is bent and absorbed on its way. Where samples are under water ground may rise out of it between
//! them, of which the drawn surface's own differences tell nothing: they are those of a level sea. So the bed's ε counts as
//! the surface's, less what its highest sample is too deep for ground to rise out by the (1 + [`TAIL`]) ε that dry ground
//! is given.
//!
//! **Interval.** Lowest and highest sample, less and more by the error: at least (1 + [`TAIL`]) ε. Of 22 800 cells of noise the worst lay
//! 2.0 ε beyond its samples.

use bevy::math::{DVec2, UVec2, Vec2};
use bevy::platform::collections::HashMap;
use bevy::tasks::{ComputeTaskPool, TaskPool};
use bytemuck::{Pod, Zeroable};
use dolomite_terrain::{GpuTerrainUniform, GroundPoint, GroundRect, Height, Planes, Terrain};

use super::errors::{COUNT, MeshErrors, STEPS, bend, mesh_errors};
use super::lattice::{CellPlace, DetailLattice};

pub use super::errors::SAMPLES;

/// The sample in the middle of a row.
const MIDDLE: usize = STEPS / 2;
/// What may lie between samples, as a multiple of the finest second difference.
pub const TAIL: f32 = 1.5;
/// Share by which a bed's error counts.
const BED_SHARE: f32 = 0.5;
/// Error of an f32 height as a share of the largest, twice what the accuracy tests of the terrain see.
const ROUNDING: f32 = 6e-7;

/// A vertex on the ground: the height of the bed, and its gradient.
pub type Corner = Height;

/// What is known of a cell; laid out as `Cell` in `shaders/src/detail/types.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Cell {
    /// Height (metres) and gradient of the ground at the centre.
    pub centre: [f32; 3],
    /// Lowest height of the drawn surface in the cell, metres.
    pub low: f32,
    /// Height and gradient in the middles of the sides.
    pub mids: [[f32; 3]; 4],
    /// Error bound of the cell as two triangles, and of every mesh that is finer, metres.
    pub error: f32,
    /// Highest height of the drawn surface, metres.
    pub high: f32,
    /// Error bounds of the triangles between centre and side, and of all that are finer, metres.
    pub quarters: [f32; 4],
    /// Error bound of every mesh that is finer still: of the quarters as cells.
    pub finer: f32,
    /// On the GPU: number of the choice that looked at it last. 0 here.
    pub looked: u32,
}

/// The middles of the sides among the samples (column, row).
const MIDS: [(usize, usize); 4] = [(0, MIDDLE), (MIDDLE, 0), (STEPS, MIDDLE), (MIDDLE, STEPS)];

const fn place_of_sample(i: usize, j: usize) -> usize {
    j * SAMPLES + i
}

/// What is drawn of heights, relative to the middle one: in a small cell heights differ by less than they are
/// rounded by.
fn about_middle(heights: &[Height], drawn: impl Fn(&Height) -> f32) -> [f32; COUNT] {
    let middle = drawn(&heights[place_of_sample(MIDDLE, MIDDLE)]);
    let middle = if middle.is_finite() { middle } else { 0.0 };
    std::array::from_fn(|k| drawn(&heights[k]) - middle)
}

/// The bed's ε as far as ground may rise out of the sea by it: less where all samples are deep, 0 where all are dry. What is not
/// a number counts nothing.
fn rising(heights: &[Height], sea: f32) -> f32 {
    let (low, high) = heights.iter().fold((f32::MAX, f32::MIN), |(low, high), h| {
        (low.min(h.value), high.max(h.value))
    });
    if low >= sea {
        return 0.0;
    }
    let depth = (sea - high).max(0.0);
    bend(&about_middle(heights, |h| h.value)) - depth / (1.0 + TAIL)
}

impl Cell {
    /// A cell from its samples, rows of constant z, in `SAMPLES`² places. `outer` is the corner of its
    /// parent where it lies; `unseen` what samples may have missed, metres.
    #[must_use]
    pub fn new(heights: &[Height], sea: f32, opaque_depth: f32, outer: usize, unseen: f32) -> Self {
        let surface = |h: &Height| h.value.max(sea);
        let bed = |h: &Height| h.value.clamp(sea - opaque_depth, sea);
        let (low, high) = heights
            .iter()
            .map(surface)
            .fold((f32::MAX, f32::MIN), |(low, high), s| {
                (low.min(s), high.max(s))
            });
        let mut errors = MeshErrors::default();
        // What is flat, the sea or a bed that nobody sees, is drawn as it is.
        if high > sea {
            errors = mesh_errors(&about_middle(heights, surface), outer);
        }
        let shallow = heights.iter().any(|h| h.value > sea - opaque_depth);
        if shallow && heights.iter().any(|h| h.value < sea) {
            errors = errors.or(&mesh_errors(&about_middle(heights, bed), outer), BED_SHARE);
        }
        errors = errors.bent(rising(heights, sea));
        let missed = TAIL * errors.finest + unseen + ROUNDING * low.abs().max(high.abs());
        let quarters = errors.quarters.map(|own| own.max(errors.finer) + missed);
        let error = quarters.into_iter().fold(errors.halves + missed, f32::max);
        let corner = |at: usize| {
            let h = heights[at];
            [h.value, h.gradient.x, h.gradient.y]
        };
        Self {
            centre: corner(place_of_sample(MIDDLE, MIDDLE)),
            low: low - error,
            mids: MIDS.map(|(i, j)| corner(place_of_sample(i, j))),
            error,
            high: high + error,
            quarters,
            finer: errors.finer + missed,
            looked: 0,
        }
    }

    /// The centre as a sample.
    #[must_use]
    pub fn centre(&self) -> Height {
        height(self.centre)
    }

    /// The middle of a side as a sample.
    #[must_use]
    pub fn mid(&self, side: usize) -> Height {
        height(self.mids[side & 3])
    }
}

fn height([value, x, z]: [f32; 3]) -> Height {
    Height {
        value,
        gradient: Vec2::new(x, z),
    }
}

/// The cells that were made so far, of one terrain on one lattice.
#[derive(Clone, Debug)]
pub struct DetailCells {
    /// Where cells stand.
    pub lattice: DetailLattice,
    terrain: Terrain,
    numbers: HashMap<UVec2, u32>,
    cells: Vec<Cell>,
    /// Heights of the roots' corners, row by row.
    corners: Vec<Height>,
    /// Most cells that are kept; beyond, all are forgotten and made again as they are asked for. A cell
    /// takes some 130 bytes.
    pub keep: usize,
}

/// [`DetailCells::keep`] if nothing else is said.
pub const KEPT: usize = 1 << 20;

impl DetailCells {
    /// No cells yet.
    #[must_use]
    pub fn new(terrain: Terrain, finest: f32) -> Self {
        let lattice = DetailLattice::new(terrain.extent(), finest);
        let step = 2 * lattice.root_half();
        let points: Vec<_> = (0..=lattice.roots.y)
            .flat_map(|z| (0..=lattice.roots.x).map(move |x| UVec2::new(x, z) * step))
            .map(|at| lattice.point(at))
            .collect();
        let corners = heights(&terrain, &points);
        Self {
            lattice,
            terrain,
            numbers: HashMap::default(),
            cells: Vec::new(),
            corners,
            keep: KEPT,
        }
    }

    /// The ground.
    #[must_use]
    pub const fn terrain(&self) -> &Terrain {
        &self.terrain
    }

    /// Takes the same ground over with other edits: cells in which it changed are forgotten, and the corners of roots
    /// there are found anew. The rectangles in which it did, in lattice lines; `None` where it is other ground, and nothing
    /// is done.
    pub fn follow_edits(&mut self, terrain: &Terrain) -> Option<Vec<[UVec2; 2]>> {
        let rects = terrain.changed_since(&self.terrain)?;
        self.terrain = terrain.clone();
        let side = 2 * self.lattice.root_half();
        let most = self.lattice.roots * side;
        let lines = rects.iter().map(|rect| {
            let [low, high] =
                [rect.min, rect.max].map(|xz| self.lattice.coordinates(GroundPoint::new(xz)));
            // A line more, against rounding.
            let low = (low.floor() - 1.0).max(DVec2::ZERO).as_uvec2().min(most);
            let high = (high.ceil() + 1.0).max(DVec2::ZERO).as_uvec2().min(most);
            [low, high]
        });
        let lines: Vec<[UVec2; 2]> = lines.collect();
        for [low, high] in &lines {
            let (first, last) = ((low + side - 1) / side, high / side);
            for z in first.y..=last.y {
                for x in first.x..=last.x {
                    let point = self.lattice.point(UVec2::new(x, z) * side);
                    let at = (z * (self.lattice.roots.x + 1) + x) as usize;
                    self.corners[at] = heights(&self.terrain, &[point])[0];
                }
            }
        }
        if !lines.is_empty() {
            self.numbers.retain(|centre, _| {
                let half = CellPlace::of_centre(*centre).half;
                !lines.iter().any(|[low, high]| {
                    (centre + half).cmpge(*low).all() && centre.cmple(high + half).all()
                })
            });
        }
        Some(lines)
    }

    /// How many cells have been made.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether none has been made.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Height of the water, or far below everything.
    #[must_use]
    pub fn sea(&self) -> f32 {
        self.terrain
            .sea_level()
            .unwrap_or(GpuTerrainUniform::NO_SEA)
    }

    /// A corner of roots.
    #[must_use]
    pub fn root_corner(&self, at: UVec2) -> Height {
        let at = at / (2 * self.lattice.root_half());
        self.corners[(at.y * (self.lattice.roots.x + 1) + at.x) as usize]
    }

    /// The cell of a number that [`Self::number`] gave since the last [`Self::forget_if_full`].
    #[must_use]
    pub fn cell(&self, number: u32) -> &Cell {
        &self.cells[number as usize]
    }

    /// The number of a cell that has been made.
    #[must_use]
    pub fn number(&self, place: CellPlace) -> Option<u32> {
        self.numbers.get(&place.centre).copied()
    }

    /// Forgets all cells when there are too many. Nothing depends on what is kept but time.
    pub fn forget_if_full(&mut self) {
        if self.cells.len() > self.keep {
            self.cells.clear();
            self.numbers.clear();
        }
    }

    /// Makes those of the cells that have not been made.
    pub fn make(&mut self, places: impl IntoIterator<Item = CellPlace>) {
        let first = self.cells.len();
        let mut made = Vec::new();
        for place in places {
            let number = (first + made.len()) as u32;
            self.numbers.entry(place.centre).or_insert_with(|| {
                made.push(place);
                number
            });
        }
        // Small lists are not worth a task.
        const PART: usize = 64;
        self.cells.resize(first + made.len(), Cell::default());
        let (lattice, terrain) = (&self.lattice, &self.terrain);
        let sea = terrain.sea_level().unwrap_or(GpuTerrainUniform::NO_SEA);
        let fresh = &mut self.cells[first..];
        if made.len() <= PART {
            make_cells(lattice, terrain, sea, &made, fresh);
            return;
        }
        ComputeTaskPool::get_or_init(TaskPool::default).scope(|scope| {
            for (places, out) in made.chunks(PART).zip(fresh.chunks_mut(PART)) {
                scope.spawn(async move { make_cells(lattice, terrain, sea, places, out) });
            }
        });
    }
}

fn heights(terrain: &Terrain, points: &[GroundPoint]) -> Vec<Height> {
    let mut planes = [(); 3].map(|()| vec![0.0; points.len()]);
    let [value, dx, dz] = &mut planes;
    terrain
        .fill_points(points, Planes { value, dx, dz })
        .expect("three planes as long as the list");
    (0..points.len())
        .map(|k| height([planes[0][k], planes[1][k], planes[2][k]]))
        .collect()
}

fn make_cells(
    lattice: &DetailLattice,
    terrain: &Terrain,
    sea: f32,
    places: &[CellPlace],
    out: &mut [Cell],
) {
    let mut points = Vec::with_capacity(places.len() * SAMPLES * SAMPLES);
    for place in places {
        points.extend(sample_places(lattice, *place));
    }
    let heights = heights(terrain, &points);
    let count = SAMPLES * SAMPLES;
    for ((place, heights), out) in places.iter().zip(heights.chunks(count)).zip(out) {
        let sides = lattice.sides(place.half);
        let centre = lattice.point(place.centre).to_dvec2();
        let rect = GroundRect::new(centre - sides / 2.0, centre + sides / 2.0);
        let unseen = terrain.unseen(&rect, sides.max_element() / (SAMPLES - 1) as f64);
        *out = Cell::new(
            heights,
            sea,
            crate::range::OPAQUE_DEPTH,
            place.quarter(),
            unseen,
        );
    }
}

/// Where a cell is sampled, row by row at equal steps, the corners and middles exactly those of the
/// lattice.
pub fn sample_places(
    lattice: &DetailLattice,
    place: CellPlace,
) -> impl Iterator<Item = GroundPoint> {
    let [x, z] = lattice.point(place.centre).to_fixed();
    let half = lattice
        .step
        .map(|step| step.wrapping_mul(u64::from(place.half)) as i64);
    let steps = MIDDLE as i64;
    let parts = move |k: usize, half: i64| (k as i64 - steps).wrapping_mul(half) / steps;
    (0..SAMPLES).flat_map(move |j| {
        (0..SAMPLES).map(move |i| {
            GroundPoint::from_fixed([
                x.wrapping_add(parts(i, half[0])),
                z.wrapping_add(parts(j, half[1])),
            ])
        })
    })
}

#[cfg(test)]
mod search;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod truth;
