//! Error ratios of a block's vertices in a view.
//!
//! The ratio of a vertex is its error, times what a vertical metre in its box is in the picture at most, times
//! the share of the detail that its box gets, over the tolerance. Its box is the region of its descendants by
//! its interval.
//!
//! **Nested.** A vertex's box contains those of all that need it, and its error is larger than theirs by 1 /
//! NEST; so is its ratio, if what is worked out of a box never falls where the box grows, **rounded as it is**.
//! So each quantity here is a chain of operations that do not fall with any operand that grows with the box:
//! ends of the box relative to the eye by one subtraction each, products of them, larger or lesser of two,
//! sums. (f32 rounds a larger number to one no less.) [`DetailView::sight`] is the same bound by the box's
//! middle and half size, of which differences near the eye round by as much as heights are large.

use bevy::math::{IVec2, Vec3};
use dolomite_terrain::GroundPoint;

use super::place::{BlockPlace, CELLS, VERTICES, vertex_at};
use super::record::{ALWAYS, Block, BlockHead};
use crate::detail::{DetailLattice, DetailView};

/// How far the region of a vertex reaches along each axis, half cells of the block.
#[must_use]
pub const fn reach(half_cells: IVec2) -> i32 {
    let (tx, ty) = (half_cells.x.trailing_zeros(), half_cells.y.trailing_zeros());
    let least = if tx < ty { tx } else { ty };
    if least > CELLS.trailing_zeros() {
        // A corner of the block: larger than any other, and never asked.
        return 4 * CELLS;
    }
    if tx == ty { 3 << least } else { 2 << least }
}

/// A box in the picture: all relative to the eye.
#[derive(Clone, Copy, Debug)]
struct Seen {
    low: Vec3,
    high: Vec3,
    distance: f32,
}

impl Seen {
    /// Of a box relative to the view's anchor.
    fn new(view: &DetailView, low: Vec3, high: Vec3) -> Self {
        let eye = Vec3::from(view.eye);
        let (low, high) = (low - eye, high - eye);
        let away = low.max(-high).max(Vec3::ZERO);
        Self {
            low,
            high,
            distance: (away.x * away.x + away.y * away.y + away.z * away.z).sqrt(),
        }
    }

    /// As [`DetailView::sight`] has it.
    fn pixels_per_metre(&self, view: &DetailView) -> f32 {
        let (right, up) = (Vec3::from(view.right), Vec3::from(view.up));
        if view.orthographic == 1.0 {
            return view.scale * (right.y * right.y + up.y * up.y).sqrt();
        }
        let (low, high) = (self.low, self.high);
        // P_z a_x − P_x a_z, its largest absolute value.
        let across = |axis: Vec3| {
            let (a, b) = (low.z * axis.x, high.z * axis.x);
            let (c, d) = (low.x * axis.z, high.x * axis.z);
            (a.max(b) - c.min(d)).max(c.max(d) - a.min(b))
        };
        let (x, y) = (across(right), across(up));
        let forward = Vec3::from(view.forward);
        let least = |a: f32, b: f32, f: f32| (a * f).min(b * f);
        let depth = least(low.x, high.x, forward.x)
            + least(low.y, high.y, forward.y)
            + least(low.z, high.z, forward.z);
        let depth = depth.max(view.near);
        let seen = depth.max(self.distance * view.cos_corner);
        let moved = depth.max(seen - (high.y - low.y) * forward.y.abs());
        let far = (x * x + y * y).sqrt() / (seen * moved);
        view.scale * far.min(1.0 / (view.cos_corner * moved))
    }
}

/// What an error of a vertex is multiplied by in a view, of a box relative to the anchor. With metrics that do not
/// ask for errors, what an edge's length is multiplied by.
#[must_use]
pub fn factor(view: &DetailView, low: Vec3, high: Vec3) -> f32 {
    // No box: nothing is there.
    if low.y > high.y {
        return 0.0;
    }
    let share = view.share(low, high);
    if share == 0.0 {
        return 0.0;
    }
    let seen = Seen::new(view, low, high);
    share
        * view.inverse_tolerance
        * match view.metric {
            0 => {
                let [least, greatest, reach, height] = view.classic;
                let relief = ((high.y - low.y) * height).clamp(0.0, 1.0);
                let blend = (reach * seen.distance + 0.4 * (1.0 - relief)).min(1.0);
                if seen.distance * reach < 0.6 {
                    greatest + (least - greatest) * blend
                } else {
                    least
                }
            }
            1 if view.orthographic == 1.0 => view.scale,
            1 => view.scale / seen.distance.max(view.near),
            _ => seen.pixels_per_metre(view),
        }
}

/// Places of a block's vertices along one axis, relative to the view's anchor, metres: from −2 to 18 cells in
/// half cells.
#[derive(Clone, Debug)]
pub struct Ruler([[f32; Ruler::COUNT]; 2]);

impl Ruler {
    /// Half cells before the block.
    const BEFORE: i32 = 4 * CELLS;
    const COUNT: usize = (2 * CELLS + 2 * Self::BEFORE + 1) as usize;

    /// Of a block.
    #[must_use]
    pub fn new(view: &DetailView, lattice: &DetailLattice, place: BlockPlace) -> Self {
        let anchor = GroundPoint {
            cell: view.anchor(),
            frac: bevy::math::UVec2::ZERO,
        };
        let anchor = anchor.to_fixed();
        let first = place.cell().centre.as_i64vec2() - i64::from(place.cell().half);
        let first = first.to_array();
        let along = |axis: usize| {
            std::array::from_fn(|k| {
                let half_cells = i64::from(k as i32 - Self::BEFORE);
                let at = first.map(|at| at + half_cells * i64::from(place.cell_half()));
                let at = lattice.signed_point(at).to_fixed()[axis];
                (at.wrapping_sub(anchor[axis]) as f64 / 4_294_967_296.0) as f32
            })
        };
        Self([along(0), along(1)])
    }

    /// The place so many half cells from the block's corner, metres.
    #[must_use]
    pub const fn at(&self, axis: usize, half_cells: i32) -> f32 {
        self.0[axis][(half_cells + Self::BEFORE) as usize]
    }

    /// The box about a place.
    fn about(&self, at: IVec2, reach: i32, [low, high]: [f32; 2]) -> (Vec3, Vec3) {
        (
            Vec3::new(self.at(0, at.x - reach), low, self.at(1, at.y - reach)),
            Vec3::new(self.at(0, at.x + reach), high, self.at(1, at.y + reach)),
        )
    }
}

/// What a whole block may ask for at most, of its mixed corners; a bound, to leave it out by.
#[must_use]
pub fn most_of(
    view: &DetailView,
    lattice: &DetailLattice,
    block: &Block,
    place: BlockPlace,
) -> f32 {
    let ruler = Ruler::new(view, lattice, place);
    let reach = CELLS + 2 * BlockHead::REACH;
    let (low, high) = ruler.about(
        IVec2::splat(CELLS),
        reach,
        [block.head.low, block.head.high],
    );
    let size = match view.metric {
        2 => block.head.mixed_error,
        _ => size_of(lattice, place, IVec2::new(2, 0)),
    };
    size * factor(view, low, high)
}

/// Length of the edge that a vertex cuts, metres.
fn size_of(lattice: &DetailLattice, place: BlockPlace, at: IVec2) -> f32 {
    let (tx, ty) = (at.x.trailing_zeros(), at.y.trailing_zeros());
    let half = 1_u32 << tx.min(ty).min(CELLS.trailing_zeros() + 1);
    let sides = lattice.sides(place.cell_half() * half);
    if tx == ty {
        sides.length() as f32
    } else {
        sides.max_element() as f32
    }
}

/// Ratios of all vertices of a block.
#[must_use]
pub fn ratios(
    view: &DetailView,
    lattice: &DetailLattice,
    block: &Block,
    place: BlockPlace,
) -> Vec<f32> {
    let ruler = Ruler::new(view, lattice, place);
    (0..VERTICES)
        .map(|number| {
            let error = block.errors[number];
            let at = vertex_at(number);
            if error == ALWAYS || place.ends(number).is_none() {
                return ALWAYS;
            }
            let interval = [block.lows[number], block.highs[number]];
            let (low, high) = ruler.about(at, reach(at), interval);
            let size = match view.metric {
                2 => error,
                _ => size_of(lattice, place, at),
            };
            size * factor(view, low, high)
        })
        .collect()
}
