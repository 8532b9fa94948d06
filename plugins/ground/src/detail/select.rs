//! Which vertices a view gets.
//!
//! From the roots down, one depth after the other. A cell is looked at when its parent's centre is drawn.
//! It has three **own** error ratios, of its error bounds at the place in it where the view shows most: as
//! two triangles, of the triangles at each side, and of everything finer. What is finer counts at most
//! as much as what is coarser, and a cell at most as much as what is finer in its parent; so own error ratios
//! fall from depth to depth.
//!
//! The **error ratio** of a cell's centre is the greatest of its own, of those of the triangles beyond each
//! side, and of what is finer in any of the eight cells around it. So a centre is drawn wherever others
//! need it, and nothing has to be passed up: let N be a cell, P its parent, and M the cell beside P that
//! N's corners at P's border need. If N's error ratio is its own, it is at most what is finer in P, which is
//! beside M. If it comes from a cell N′ beside N, then N′ lies in M, in P, or in a cell beside both; and
//! N′ counts at most as much as what is finer there. Either way M's error ratio is no less than N's; and M was
//! looked at, by the same argument about its parent.
//!
//! The error ratio of a side's **middle** is the greatest of the triangles on both sides and of the centres of
//! the quarters that touch it: at most that of the centres on both sides, by the above. So the vertices
//! whose error ratio exceeds any number make a mesh without gaps (P. Lindstrom, V. Pascucci 2002).

use bevy::math::{UVec2, Vec3};
use bevy::platform::collections::HashMap;

use super::APPEARS;
use super::cell::{Cell, DetailCells};
use super::lattice::{CellPlace, DetailLattice};
use super::view::DetailView;

/// A cell whose centre is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewCell {
    /// Where it is.
    pub place: CellPlace,
    /// Its number among the cells that were made.
    pub number: u32,
    /// Error ratio of the centre.
    pub centre: f32,
    /// Own error ratio of everything finer than the triangles at the sides.
    pub finer: f32,
    /// Error ratios of the sides' middles.
    pub sides: [f32; 4],
    /// Whether its triangles are drawn: it may be seen, itself or its shadow.
    pub seen: bool,
}

/// The cells that a view draws.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Cells by depth, the roots' first.
    pub depths: Vec<Vec<ViewCell>>,
    /// Where a cell stands in `depths[its depth]`.
    places: HashMap<UVec2, u32>,
    /// Roots that stay two triangles: place, and whether they are drawn.
    pub whole_roots: Vec<(CellPlace, bool)>,
    /// By how much the tolerance was raised so that the vertices fit; 1 where it was not.
    pub coarsening: f32,
    /// The greatest error ratio that could not be met because cells have a least size: 1 and below means that
    /// the bound is held everywhere. In units of the tolerance, as it was asked for.
    pub held: f32,
}

impl Selection {
    /// The cell of a place, if its centre is drawn.
    #[must_use]
    pub fn find(&self, lattice: &DetailLattice, place: CellPlace) -> Option<&ViewCell> {
        let at = *self.places.get(&place.centre)?;
        let depth = lattice.depth_of(place) as usize;
        self.depths.get(depth)?.get(at as usize)
    }

    /// All cells.
    pub fn cells(&self) -> impl Iterator<Item = &ViewCell> {
        self.depths.iter().flatten()
    }

    /// Error ratios of all vertices that appear, the middles once for each cell beside them.
    fn error_ratios(&self) -> impl Iterator<Item = f32> {
        self.cells()
            .flat_map(|cell| [cell.centre].into_iter().chain(cell.sides))
    }

    /// Number of vertices whose error ratio exceeds `threshold`, the middles by halves.
    #[must_use]
    pub fn vertices_above(&self, threshold: f32) -> f32 {
        self.cells()
            .map(|cell| {
                let middles = cell.sides.iter().filter(|&&side| side > threshold).count();
                f32::from(u8::from(cell.centre > threshold)) + 0.5 * middles as f32
            })
            .sum()
    }
}

/// A cell's own error ratios, at most `most` (what is finer in its parent). They are asked for when the cell or
/// one beside it is in the picture: a vertex that is seen owes some of its error ratio to cells that are not, and
/// would jump when they come in.
#[must_use]
pub fn own_errors(
    view: &DetailView,
    lattice: &DetailLattice,
    place: CellPlace,
    cell: &Cell,
    most: f32,
) -> OwnErrors {
    let (low, high) = cell_box(view, lattice, place, cell);
    let sight = view.sight(low, high);
    // What a vertex in the picture owes to the cells around it comes and goes while it is out of it.
    let around = high - low;
    let factor = view.share(low - around, high + around)
        * view.inverse_tolerance
        * match view.metric {
            0 => {
                let [least, greatest, reach, height] = view.classic;
                let relief = ((cell.high - cell.low - 2.0 * cell.error) * height).clamp(0.0, 1.0);
                let blend = (reach * sight.distance + 0.4 * (1.0 - relief)).min(1.0);
                if sight.distance * reach < 0.6 {
                    greatest + (least - greatest) * blend
                } else {
                    least
                }
            }
            1 if view.orthographic == 1.0 => view.scale,
            1 => view.scale / sight.distance.max(view.near),
            _ => sight.pixels_per_metre,
        };
    let (whole, sides, finer) = if view.metric == 2 {
        (cell.error, cell.quarters, cell.finer)
    } else {
        // Lengths of the edges that the vertices cut: the diagonal, a side, a quarter's diagonal.
        let sides = lattice.sides(place.half);
        let diagonal = (sides.x * sides.x + sides.y * sides.y).sqrt() as f32;
        (diagonal, [sides.max_element() as f32; 4], diagonal * 0.5)
    };
    // NaN, where the ground has none, asks for nothing.
    let whole = (whole * factor).max(0.0).min(most);
    OwnErrors {
        whole,
        sides: sides.map(|size| (size * factor).max(0.0).min(whole)),
        finer: (finer * factor).max(0.0).min(whole),
        seen: sight.share > 0.0,
    }
}

/// What [`own_errors`] gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnErrors {
    /// Of the centre.
    pub whole: f32,
    /// Of the triangles at the sides.
    pub sides: [f32; 4],
    /// Of everything finer.
    pub finer: f32,
    /// Whether the cell or its shadow is in the picture.
    pub seen: bool,
}

/// The box of a cell, relative to the view's anchor.
pub(super) fn cell_box(
    view: &DetailView,
    lattice: &DetailLattice,
    place: CellPlace,
    cell: &Cell,
) -> (Vec3, Vec3) {
    let anchor = dolomite_terrain::GroundPoint {
        cell: view.anchor(),
        frac: UVec2::ZERO,
    };
    let low = lattice.point(place.corner(0)).relative_to(anchor);
    let high = lattice.point(place.corner(2)).relative_to(anchor);
    (
        Vec3::new(low.x, cell.low, low.y),
        Vec3::new(high.x, cell.high, high.y),
    )
}

/// Chooses the vertices of a view, and makes the cells that it takes. `max_vertices` bounds them.
pub fn select(cells: &mut DetailCells, view: &DetailView, max_vertices: u32) -> Selection {
    cells.forget_if_full();
    let lattice = cells.lattice;
    let mut selection = Selection {
        depths: vec![Vec::new(); lattice.depth as usize + 1],
        coarsening: 1.0,
        ..Selection::default()
    };
    let mut looked_at: Vec<(CellPlace, f32)> =
        lattice.root_cells().map(|root| (root, f32::MAX)).collect();
    let mut kept = 0;
    for depth in 0..=lattice.depth as usize {
        cells.make(looked_at.iter().map(|&(place, _)| place));
        let level = look(cells, view, &looked_at);
        let appears = APPEARS * selection.coarsening;
        looked_at.clear();
        for at in 0..level.cells.len() {
            let cell = ViewCell {
                centre: level.error_ratio(at),
                ..level.cells[at]
            };
            if cell.centre <= appears {
                if depth == 0 {
                    selection.whole_roots.push((cell.place, cell.seen));
                }
                continue;
            }
            selection
                .places
                .insert(cell.place.centre, selection.depths[depth].len() as u32);
            selection.depths[depth].push(cell);
            let children = (0..4).filter_map(|corner| cell.place.child(corner));
            looked_at.extend(children.map(|child| (child, cell.finer)));
        }
        kept += selection.depths[depth].len();
        // A cell has two vertices or three.
        if kept * 2 > max_vertices as usize {
            let fits = fitting(&selection, max_vertices as f32 * 0.75);
            selection.coarsening = fits.max(selection.coarsening);
        }
        if depth == lattice.depth as usize {
            let rest = level.cells.iter().map(|cell| cell.finer);
            selection.held = rest.fold(0.0, f32::max);
        }
    }
    for depth in (0..=lattice.depth as usize).rev() {
        for at in 0..selection.depths[depth].len() {
            selection.depths[depth][at].sides = middles(&selection, &lattice, depth, at);
        }
    }
    let most = max_vertices as f32;
    if selection.vertices_above(APPEARS * selection.coarsening) > most {
        selection.coarsening = fitting(&selection, most);
    }
    lower(&mut selection);
    selection
}

/// The cells of one depth that are looked at, with their own error ratios.
struct Level {
    cells: Vec<ViewCell>,
    places: HashMap<UVec2, u32>,
}

fn look(cells: &DetailCells, view: &DetailView, places: &[(CellPlace, f32)]) -> Level {
    let mut level = Level {
        cells: Vec::with_capacity(places.len()),
        places: HashMap::with_capacity(places.len()),
    };
    for &(place, most) in places {
        let number = cells.number(place).expect("just made");
        let own = own_errors(view, &cells.lattice, place, cells.cell(number), most);
        level.places.insert(place.centre, level.cells.len() as u32);
        level.cells.push(ViewCell {
            place,
            number,
            centre: own.whole,
            finer: own.finer,
            sides: own.sides,
            seen: own.seen,
        });
    }
    level
}

impl Level {
    fn find(&self, place: CellPlace) -> Option<&ViewCell> {
        self.places
            .get(&place.centre)
            .map(|&at| &self.cells[at as usize])
    }

    /// Error ratio of a cell's centre: its own, and what the cells around it need.
    fn error_ratio(&self, at: usize) -> f32 {
        let cell = &self.cells[at];
        let mut error_ratio = cell.centre;
        for side in 0..4 {
            let beside = cell.place.neighbour(side);
            if let Some(there) = self.find(beside) {
                error_ratio = error_ratio
                    .max(there.sides[(side + 2) & 3])
                    .max(there.finer);
            }
            if let Some(across) = self.find(beside.neighbour(side + 1)) {
                error_ratio = error_ratio.max(across.finer);
            }
        }
        error_ratio
    }
}

/// Error ratios of the middles of a cell's sides, where centre and the centre beyond are drawn.
fn middles(selection: &Selection, lattice: &DetailLattice, depth: usize, at: usize) -> [f32; 4] {
    let cell = &selection.depths[depth][at];
    let touching = |place: CellPlace, side: usize| {
        [side, (side + 3) & 3]
            .into_iter()
            .filter_map(|corner| selection.find(lattice, place.child(corner)?))
            .map(|child| child.centre)
            .fold(0.0, f32::max)
    };
    std::array::from_fn(|side| {
        let own = cell.sides[side].max(touching(cell.place, side));
        let there = cell.place.neighbour(side);
        if !lattice.holds(there) {
            return own;
        }
        let facing = (side + 2) & 3;
        selection.find(lattice, there).map_or(0.0, |beyond| {
            // Where it was visited before, this is the same maximum once more.
            own.max(beyond.sides[facing]).max(touching(there, facing))
        })
    })
}

/// Steps of the histogram of error ratios in an octave.
const STEPS: f32 = 8.0;

/// The least of the steps 2^(k/8) by which the tolerance grows so that at most `most` vertices appear.
fn fitting(selection: &Selection, most: f32) -> f32 {
    let mut counts = [0.0_f32; 512];
    let step = |error_ratio: f32| {
        (bevy::math::ops::log2(error_ratio / APPEARS) * STEPS).clamp(0.0, 511.0) as usize
    };
    for error_ratio in selection
        .error_ratios()
        .filter(|&error_ratio| error_ratio > APPEARS)
    {
        counts[step(error_ratio)] += 0.75;
    }
    let mut above = 0.0;
    for k in (0..counts.len()).rev() {
        above += counts[k];
        if above > most {
            return bevy::math::ops::exp2((k + 1) as f32 / STEPS);
        }
    }
    1.0
}

/// Takes the coarsening out of all error ratios, and drops the cells that no longer appear.
fn lower(selection: &mut Selection) {
    let factor = 1.0 / selection.coarsening;
    selection.places.clear();
    for list in &mut selection.depths {
        list.retain_mut(|cell| {
            cell.centre *= factor;
            cell.sides = cell.sides.map(|side| side * factor);
            cell.centre > APPEARS
        });
        for (at, cell) in list.iter().enumerate() {
            selection.places.insert(cell.place.centre, at as u32);
        }
    }
    selection.held = selection.held.max(selection.coarsening);
}
