//! Ground that changes within rectangles: which blocks these reach, on the CPU and as the passes are told.
//!
//! A block is a function of the heights at its samples, of what may lie between them, and of its parent's record. So one
//! whose samples a change does not reach is as it was, unless something has become another that it takes from its parent
//! ([`super::others`]); and what is below it likewise: the samples of a block lie within its parent's.

use bevy::math::{DVec2, UVec2};
use dolomite_terrain::{GroundPoint, GroundRect, Terrain};

use super::layout::MOST_MADE;
use super::place::{BlockPlace, CELLS, LEAST_HALF};
use super::triangle::AROUND;
use crate::detail::DetailLattice;
use crate::detail::lattice::STEPS;
use crate::detail::layout::{EditedRect, MOST_EDITED};

/// How far outside of a block heights count for it, its cells: the ring of three that it samples, and the windows of a map that
/// say what may lie between samples, which are less than a cell wide.
const RING: u32 = 4;

/// From how far away edits count for blocks. What may lie between samples is known of whole nodes of the tree of edits, which
/// are longer than the cells that ask; where samples are as close as those of edits nothing lies between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EditReach {
    /// Half the side of the smallest block for which nodes are asked, lattice steps.
    pub wide_from: u32,
    /// How far outside of such blocks edits count, their cells.
    pub wide_cells: u32,
}

impl EditReach {
    /// Of what is not edited.
    pub const NEAR: Self = Self {
        wide_from: u32::MAX,
        wide_cells: RING,
    };

    /// Of the edits of a terrain.
    #[must_use]
    pub fn new(terrain: &Terrain, lattice: &DetailLattice) -> Self {
        let mut reach = Self::NEAR;
        let Some(edits) = terrain.edits() else {
            return reach;
        };
        let metres = |step: u64| step as f64 / STEPS;
        let border = lattice.border;
        let step = lattice.step.map(metres);
        let all = [step, border.first.map(metres), border.last.map(metres)].concat();
        let least = |steps: &[f64]| steps.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |steps: &[f64]| steps.iter().copied().fold(0.0, f64::max);
        for half in halves(lattice) {
            let cell = f64::from(half / (CELLS as u32 / 2));
            let width = f64::from(border.width);
            // Windows of three cells, of which the border may move one line by its own width at most; or lie in the border.
            let (longest, side, more) = if cell < width {
                (3.0 * cell * most(&all), cell * least(&all), 0.0)
            } else {
                let longest = (3.0 * cell + width) * most(&step);
                (longest, cell * least(&step), width / cell)
            };
            let beyond = edits.told_beyond(longest, longest / 12.0);
            if beyond > 0.0 {
                let cells = f64::from(AROUND) + more + beyond / side;
                reach.wide_from = reach.wide_from.min(half);
                reach.wide_cells = reach.wide_cells.max(cells.ceil() as u32);
            }
        }
        reach
    }

    /// Of a terrain and of what it has become: one of them may have no layer of edits.
    #[must_use]
    pub fn between(before: &Terrain, after: &Terrain, lattice: &DetailLattice) -> Self {
        let edited = [after, before]
            .into_iter()
            .find(|terrain| terrain.edits().is_some());
        edited.map_or(Self::NEAR, |terrain| Self::new(terrain, lattice))
    }

    /// How far outside of a block heights count, its cells.
    const fn cells(self, half: u32) -> u32 {
        if half >= self.wide_from {
            self.wide_cells
        } else {
            RING
        }
    }

    /// Half the side of a block with what counts for it, lattice steps.
    const fn lines(self, half: u32) -> u32 {
        half + self.cells(half) * (half / (CELLS as u32 / 2))
    }
}

/// Half sides of blocks, from the roots' on.
fn halves(lattice: &DetailLattice) -> impl Iterator<Item = u32> {
    std::iter::successors(Some(lattice.root_half()), |half| Some(half / 2))
        .take_while(|&half| half >= LEAST_HALF)
}

/// Where heights count for a block, metres.
#[must_use]
pub fn reach(lattice: &DetailLattice, place: BlockPlace, edits: EditReach) -> GroundRect {
    let cell = place.cell();
    let out = i64::from(edits.lines(cell.half));
    let centre = cell.centre.as_i64vec2();
    let corner = |by: i64| lattice.signed_point((centre + by).to_array()).to_dvec2();
    GroundRect::new(corner(-out), corner(out))
}

/// Whether heights of a block may be others, where the ground changed within these rectangles and nowhere else. A rectangle
/// with a side that is no number holds everything.
#[must_use]
pub fn is_reached(
    lattice: &DetailLattice,
    place: BlockPlace,
    edits: EditReach,
    changed: &[GroundRect],
) -> bool {
    let own = reach(lattice, place, edits);
    let apart = |from: DVec2, to: DVec2| to.cmplt(from).any();
    changed
        .iter()
        .any(|rect| !apart(own.min, rect.max) && !apart(rect.min, own.max))
}

/// The same of any root: whether blocks of the ground are others at all.
#[must_use]
pub fn reaches_any(lattice: &DetailLattice, edits: EditReach, changed: &[GroundRect]) -> bool {
    BlockPlace::roots(lattice).any(|root| is_reached(lattice, root, edits, changed))
}

/// More rectangles than these are joined with the next in the list before those that fit best are looked for.
const MANY: usize = 4 * MOST_EDITED;

/// Rectangles as the passes are told them: the lattice lines about them. A rectangle with a side that is no number is the whole
/// lattice; those that reach no block are left out. More than [`MOST_EDITED`] are joined.
#[must_use]
pub fn edited_lines(
    lattice: &DetailLattice,
    edits: EditReach,
    changed: &[GroundRect],
) -> Vec<EditedRect> {
    let most = lattice.roots << (lattice.depth + 1);
    let ends = [UVec2::ZERO, most].map(|at| lattice.point(at).to_dvec2());
    let size = ends[1] - ends[0];
    let reaching = changed
        .iter()
        .filter(|rect| reaches_any(lattice, edits, &[**rect]));
    let told = |low: UVec2, high: UVec2| EditedRect {
        low: low.to_array(),
        high: high.to_array(),
        wide_from: edits.wide_from,
        wide_cells: edits.wide_cells,
        ..EditedRect::default()
    };
    let lines = reaching.map(|rect| {
        if !(rect.min.is_finite() && rect.max.is_finite()) {
            return told(UVec2::ZERO, most);
        }
        // Fixed-point numbers would end far away; what is moved nearer reaches no less.
        let [low, high] = [rect.min, rect.max].map(|xz| {
            let near = xz.clamp(ends[0] - size, ends[1] + size);
            lattice.coordinates(GroundPoint::new(near))
        });
        // A line more, against rounding.
        let within = |line: DVec2| line.max(DVec2::ZERO).as_uvec2().min(most);
        told(within(low.floor() - 1.0), within(high.ceil() + 1.0))
    });
    let mut lines = lines.collect();
    join_edited(&mut lines);
    lines
}

fn joined(a: &EditedRect, b: &EditedRect) -> EditedRect {
    EditedRect {
        low: [0, 1].map(|k| a.low[k].min(b.low[k])),
        high: [0, 1].map(|k| a.high[k].max(b.high[k])),
        wide_from: a.wide_from.min(b.wide_from),
        wide_cells: a.wide_cells.max(b.wide_cells),
        ..EditedRect::default()
    }
}

/// Joins rectangles until there are no more than [`MOST_EDITED`]: those first that waste the least ground. What is joined
/// reaches more than it has to.
pub fn join_edited(edited: &mut Vec<EditedRect>) {
    while edited.len() > MANY {
        let pairs = edited.chunks(2);
        *edited = pairs
            .map(|pair| joined(&pair[0], &pair[pair.len() - 1]))
            .collect();
    }
    let area = |rect: &EditedRect| {
        let side = |k: usize| f64::from(rect.high[k] - rect.low[k]);
        side(0) * side(1)
    };
    while edited.len() > MOST_EDITED {
        let count = edited.len();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        let waste = |(a, b): &(usize, usize)| {
            let (a, b) = (&edited[*a], &edited[*b]);
            area(&joined(a, b)) - area(a) - area(b)
        };
        let Some((a, b)) = pairs.min_by(|x, y| waste(x).total_cmp(&waste(y))) else {
            return;
        };
        let last = edited.swap_remove(b);
        edited[a] = joined(&edited[a], &last);
    }
}

const fn reach_of(rect: &EditedRect) -> EditReach {
    EditReach {
        wide_from: rect.wide_from,
        wide_cells: rect.wide_cells,
    }
}

/// Whether the heights of a block may be others, by the lattice lines: the reference of `edited.wgsl`. Wherever
/// [`is_reached`] says so this does.
#[must_use]
pub fn meets(place: BlockPlace, edited: &[EditedRect]) -> bool {
    let cell = place.cell();
    edited.iter().any(|rect| {
        let out = UVec2::splat(reach_of(rect).lines(cell.half));
        let (low, high) = (cell.centre - cell.centre.min(out), cell.centre + out);
        low.cmple(rect.high.into()).all() && high.cmpge(rect.low.into()).all()
    })
}

/// Rounds of making that an edit may take beside one for each level of the tree: two thousand blocks. What more is to be made
/// anew is dropped.
const MOST_ROUNDS: u32 = 32;

/// In how many rounds an edit is taken over that makes at most so many blocks anew: a round makes [`MOST_MADE`] of any level
/// that are ready, and refreshes many more. A block is ready when its parent has been made or refreshed.
#[must_use]
pub fn edit_rounds(lattice: &DetailLattice, most: u32) -> u32 {
    halves(lattice).count() as u32 + most.div_ceil(MOST_MADE).min(MOST_ROUNDS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blocks::kept::lattice_of;
    use crate::blocks::tests::remade::ground;

    #[test]
    fn changes_beyond_the_ground_reach_nothing_and_others_whoever_samples_them() {
        let terrain = ground(&[]);
        let lattice = lattice_of(&terrain, 0.125);
        let beyond = GroundRect::square(DVec2::new(5000.0, 0.0), 100.0);
        let near = EditReach::NEAR;
        assert!(!reaches_any(&lattice, near, &[beyond]) && !reaches_any(&lattice, near, &[]));
        // Within the ring of the western root, outside of its square.
        let beside = GroundRect::square(DVec2::new(60.0, 0.0), 1.0);
        let reached = |rect| {
            let roots = BlockPlace::roots(&lattice);
            roots
                .map(|root| is_reached(&lattice, root, near, &[rect]))
                .collect::<Vec<_>>()
        };
        assert_eq!(reached(beside), [true, true]);
        let far = GroundRect::square(DVec2::new(400.0, 0.0), 1.0);
        assert_eq!(reached(far), [false, true]);
        let nothing = GroundRect::new(DVec2::splat(f64::NAN), DVec2::splat(f64::NAN));
        assert!(reaches_any(&lattice, near, &[nothing]));
    }

    /// All blocks of some halvings of the roots.
    fn places(lattice: &DetailLattice, levels: u32) -> Vec<BlockPlace> {
        let mut all: Vec<_> = BlockPlace::roots(lattice).collect();
        let mut first = 0;
        for _ in 0..levels {
            let last = all.len();
            for at in first..last {
                let of = all[at];
                all.extend((0..4).filter_map(|quarter| of.child(quarter)));
            }
            first = last;
        }
        all
    }

    #[test]
    fn lines_reach_what_rectangles_reach_and_little_more() {
        let (lattice, near) = (lattice_of(&ground(&[]), 0.125), EditReach::NEAR);
        let places = places(&lattice, 5);
        let extent = ground(&[]).extent();
        for k in 0..60_u32 {
            let at = |salt: f64, most: f64| (f64::from(k) * salt).fract() * most - 0.5 * most;
            let centre = DVec2::new(at(0.618, 1200.0), at(0.414, 700.0));
            let rects = [
                GroundRect::square(centre, f64::from(k % 7) * 9.0),
                GroundRect::square(-centre, 3.0),
            ];
            let lines = edited_lines(&lattice, near, &rects);
            let wider = rects.map(|rect| {
                let step = DVec2::splat(0.3);
                GroundRect::new(rect.min - step, rect.max + step)
            });
            for &place in &places {
                let met = meets(place, &lines);
                assert!(
                    met || !is_reached(&lattice, place, near, &rects),
                    "{rects:?}"
                );
                // Beside the ground they count as if they were on its border.
                let within = extent.contains(centre) && extent.contains(-centre);
                let little = is_reached(&lattice, place, near, &wider);
                assert!(!(met && within) || little, "{rects:?}");
            }
        }
        let nothing = GroundRect::new(DVec2::splat(f64::NAN), DVec2::splat(f64::NAN));
        let endless = GroundRect::square(DVec2::ZERO, 1e300);
        for rect in [nothing, endless] {
            let lines = edited_lines(&lattice, near, &[rect]);
            assert!(places.iter().all(|&place| meets(place, &lines)), "{rect:?}");
        }
        let beyond = GroundRect::square(DVec2::new(5000.0, 0.0), 100.0);
        assert_eq!(edited_lines(&lattice, near, &[beyond]), []);
    }

    #[test]
    fn many_rectangles_are_joined_and_nothing_is_missed() {
        let (lattice, near) = (lattice_of(&ground(&[]), 0.125), EditReach::NEAR);
        let places = places(&lattice, 5);
        for count in [
            MOST_EDITED,
            MOST_EDITED + 1,
            3 * MOST_EDITED,
            50 * MOST_EDITED,
        ] {
            let at = |k: usize, salt: f64| (k as f64 * salt).fract() - 0.5;
            let rects: Vec<_> = (0..count)
                .map(|k| DVec2::new(1000.0 * at(k, 0.618), 500.0 * at(k, 0.414)))
                .map(|centre| GroundRect::square(centre, 4.0))
                .collect();
            let lines = edited_lines(&lattice, near, &rects);
            assert!(lines.len() <= MOST_EDITED && lines.len() >= count.min(MOST_EDITED / 2));
            for &place in &places {
                assert!(meets(place, &lines) || !is_reached(&lattice, place, near, &rects));
            }
        }
    }

    #[test]
    fn rounds_go_down_all_levels_and_make_what_there_is_room_for() {
        let lattice = lattice_of(&ground(&[]), 0.125);
        let levels = lattice.depth - LEAST_HALF.trailing_zeros() + 1;
        assert_eq!(edit_rounds(&lattice, MOST_MADE), levels + 1);
        assert_eq!(edit_rounds(&lattice, 1000), levels + 16);
        assert_eq!(edit_rounds(&lattice, 1 << 20), levels + MOST_ROUNDS);
    }
}
