//! Which vertices a view gets.
//!
//! Down: from the roots, a cell whose own demand is above [`APPEARS`] is kept, and its quarters are looked
//! at. A cell's own demand is that of its error bound, which holds for all meshes inside of it, at the
//! place in it where the picture shows most: none of its quarters can ask for more.
//!
//! Up: from the finest cells, each vertex raises the demands of those that it needs: a centre those of
//! the two middles at its cell's inner corner's sides, a middle those of the centres on both sides of it.
//! Neighbours that were not kept on the way down are added here. What is above [`APPEARS`] afterwards is a
//! mesh without gaps, whatever the errors were.

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
    /// Demand of the centre.
    pub centre: f32,
    /// Demands of the sides' middles.
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
    /// The greatest demand that could not be met because cells have a least size: 1 and below means that
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

    /// Demands of all vertices that appear, the middles once for each cell beside them.
    fn demands(&self) -> impl Iterator<Item = f32> {
        self.cells()
            .flat_map(|cell| [cell.centre].into_iter().chain(cell.sides))
    }

    /// Number of vertices whose demand exceeds `threshold`, the middles by halves.
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

/// A cell's demands by itself: as two triangles, and of its sides.
#[must_use]
pub fn own_demand(view: &DetailView, lattice: &DetailLattice, place: CellPlace, cell: &Cell) -> Demand {
    let (low, high) = cell_box(view, lattice, place, cell);
    let sight = view.sight(low, high);
    let sides = lattice.sides(place.half);
    let (across, side) = (
        (sides.x * sides.x + sides.y * sides.y).sqrt() as f32,
        sides.max_element() as f32,
    );
    let factor = match view.metric {
        0 => {
            let [least, greatest, reach, height] = view.classic;
            let relief = ((cell.high - cell.low - 2.0 * cell.error) * height).clamp(0.0, 1.0);
            let blend = (reach * sight.distance + 0.4 * (1.0 - relief)).min(1.0);
            let near = sight.distance * reach < 0.6;
            let level = if near { greatest + (least - greatest) * blend } else { least };
            level * view.inverse_tolerance
        }
        1 => {
            let reach = if view.orthographic == 1.0 { 1.0 } else { sight.distance.max(view.near) };
            view.scale / reach * view.inverse_tolerance
        }
        _ => sight.pixels_per_metre * view.inverse_tolerance,
    } * sight.share;
    let [whole, quarters] = if view.metric == 2 {
        [[cell.error; 4], cell.quarters]
    } else {
        [[across; 4], [side; 4]]
    };
    Demand {
        whole: whole[0] * factor,
        sides: quarters.map(|size| size * factor),
        seen: sight.share > 0.0,
    }
}

/// What [`own_demand`] gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// Of the centre.
    pub whole: f32,
    /// Of the sides' middles.
    pub sides: [f32; 4],
    /// Whether the cell or its shadow is in the picture.
    pub seen: bool,
}

/// The box of a cell, relative to the view's anchor.
fn cell_box(view: &DetailView, lattice: &DetailLattice, place: CellPlace, cell: &Cell) -> (Vec3, Vec3) {
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
    descend(cells, view, max_vertices, &mut selection);
    for depth in (0..=lattice.depth as usize).rev() {
        raise(cells, view, &mut selection, depth);
    }
    let most = max_vertices as f32;
    if selection.vertices_above(APPEARS * selection.coarsening) > most {
        selection.coarsening = fitting(&selection, most);
    }
    lower(&mut selection);
    let whole: Vec<_> = lattice
        .root_cells()
        .filter(|&root| !selection.places.contains_key(&root.centre))
        .map(|root| {
            let number = cells.number(root).expect("roots are always looked at");
            let demand = own_demand(view, &lattice, root, cells.cell(number));
            (root, demand.seen)
        })
        .collect();
    selection.whole_roots = whole;
    selection
}

/// Down the quadtree, breadth first.
fn descend(cells: &mut DetailCells, view: &DetailView, most: u32, selection: &mut Selection) {
    let lattice = cells.lattice;
    let mut places: Vec<_> = lattice.root_cells().collect();
    let mut kept = 0;
    for depth in 0..=lattice.depth as usize {
        cells.make(places.iter().copied());
        let mut next = Vec::new();
        for place in places {
            let number = cells.number(place).expect("just made");
            let demand = own_demand(view, &lattice, place, cells.cell(number));
            // NaN fails the comparison: a cell without usable heights stays as it is.
            if !(demand.whole > APPEARS * selection.coarsening) {
                continue;
            }
            if place.half == 1 {
                let rest = demand.sides.into_iter().fold(0.0, f32::max);
                selection.held = selection.held.max(rest);
            }
            let at = selection.depths[depth].len() as u32;
            selection.places.insert(place.centre, at);
            selection.depths[depth].push(ViewCell {
                place,
                number,
                centre: demand.whole,
                sides: demand.sides,
                seen: demand.seen,
            });
            next.extend((0..4).filter_map(|corner| place.child(corner)));
        }
        kept += selection.depths[depth].len();
        // A cell has at least one vertex and is balanced by as many again.
        if kept > most as usize {
            selection.coarsening = fitting(selection, most as f32 * 0.5).max(selection.coarsening);
        }
        places = next;
    }
}

/// Up one depth: middles by their quarters and by their other side, centres by their middles, middles of
/// the parents by the centres.
fn raise(cells: &mut DetailCells, view: &DetailView, selection: &mut Selection, depth: usize) {
    let lattice = cells.lattice;
    let appears = APPEARS * selection.coarsening;
    for at in 0..selection.depths[depth].len() {
        let ViewCell { place, sides, .. } = selection.depths[depth][at];
        for (side, &demand) in sides.iter().enumerate() {
            let there = place.neighbour(side);
            if demand > appears && lattice.holds(there) {
                let beyond = ensure(cells, view, selection, there);
                let raised = &mut selection.depths[depth][beyond].sides[(side + 2) & 3];
                *raised = raised.max(demand);
            }
        }
    }
    for at in 0..selection.depths[depth].len() {
        let cell = &mut selection.depths[depth][at];
        cell.centre = cell.sides.iter().fold(cell.centre, |a, &b| a.max(b));
        let (place, demand) = (cell.place, cell.centre);
        if depth == 0 {
            continue;
        }
        let quarter = place.quarter();
        let above = ensure(cells, view, selection, place.parent());
        let parent = &mut selection.depths[depth - 1][above];
        for side in [quarter, (quarter + 1) & 3] {
            parent.sides[side] = parent.sides[side].max(demand);
        }
    }
}

/// The number of a cell at its depth; added where it was not kept.
fn ensure(
    cells: &mut DetailCells,
    view: &DetailView,
    selection: &mut Selection,
    place: CellPlace,
) -> usize {
    if let Some(&at) = selection.places.get(&place.centre) {
        return at as usize;
    }
    cells.make([place]);
    let lattice = cells.lattice;
    let number = cells.number(place).expect("just made");
    let demand = own_demand(view, &lattice, place, cells.cell(number));
    let list = &mut selection.depths[lattice.depth_of(place) as usize];
    let at = list.len();
    selection.places.insert(place.centre, at as u32);
    list.push(ViewCell {
        place,
        number,
        centre: 0.0,
        sides: [0.0; 4],
        seen: demand.seen,
    });
    at
}

/// Steps of the histogram of demands in an octave.
const STEPS: f32 = 8.0;

/// The least of the steps 2^(k/8) by which the tolerance grows so that at most `most` vertices appear.
fn fitting(selection: &Selection, most: f32) -> f32 {
    let mut counts = [0.0_f32; 512];
    let step = |demand: f32| (bevy::math::ops::log2(demand / APPEARS) * STEPS).clamp(0.0, 511.0) as usize;
    for demand in selection.demands().filter(|&demand| demand > APPEARS) {
        counts[step(demand)] += 0.75;
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

/// Takes the coarsening out of all demands, and drops the cells that no longer appear.
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
