//! Whether one can walk in a straight line, exactly.
//!
//! Places are whole numbers of 1/256 of a cell from the grid's origin on, so that which cells a line passes through is
//! decided in integers. A line may touch the corner of a closed cell and go along its side, but not through it, nor
//! between two that meet in a corner.

use super::ground::WalkGrid;
use bevy::math::IVec2;

/// Parts of a cell's side.
pub const UNITS: i64 = 256;

/// Whether nothing is in the way from one place to another.
#[must_use]
pub fn is_clear(grid: &WalkGrid, from: [i64; 2], to: [i64; 2]) -> bool {
    let turned = (to[1] - from[1]).abs() > (to[0] - from[0]).abs();
    // Along u it goes farther; from the lower end on.
    let axes = |place: [i64; 2]| if turned { [place[1], place[0]] } else { place };
    let (mut a, mut b) = (axes(from), axes(to));
    if a[0] > b[0] {
        std::mem::swap(&mut a, &mut b);
    }
    let open = |u: i64, v: i64| {
        let (x, z) = if turned { (v, u) } else { (u, v) };
        grid.is_walkable(IVec2::new(x as i32, z as i32))
    };
    let (length, rise) = (b[0] - a[0], b[1] - a[1]);
    if length == 0 {
        return true;
    }
    let columns = a[0].div_euclid(UNITS)..-(-b[0]).div_euclid(UNITS);
    if rise == 0 {
        return level(columns, a[1], open);
    }
    // v at a place u, as parts of `whole` of a cell.
    let whole = length * UNITS;
    let at = |u: i64| a[1] * length + (u - a[0]) * rise;
    let last = columns.end - 1;
    for column in columns {
        let (enter, leave) = (
            at(a[0].max(column * UNITS)),
            at(b[0].min((column + 1) * UNITS)),
        );
        let (low, high) = (enter.min(leave), enter.max(leave));
        for row in low.div_euclid(whole)..-(-high).div_euclid(whole) {
            if !open(column, row) {
                return false;
            }
        }
        if column != last && leave.rem_euclid(whole) == 0 {
            // Through a corner: one of the two cells beside the way has to be open.
            let corner = leave / whole;
            let (beside, beyond) = if rise > 0 {
                ((column, corner), (column + 1, corner - 1))
            } else {
                ((column, corner - 1), (column + 1, corner))
            };
            if !open(beside.0, beside.1) && !open(beyond.0, beyond.1) {
                return false;
            }
        }
    }
    true
}

/// A line along the axis.
fn level(columns: std::ops::Range<i64>, v: i64, open: impl Fn(i64, i64) -> bool) -> bool {
    let row = v.div_euclid(UNITS);
    if v.rem_euclid(UNITS) != 0 {
        return columns.into_iter().all(|column| open(column, row));
    }
    // On the border of two rows: one side has to be open, and the same one from column to column.
    let mut sides = (true, true);
    for column in columns {
        let next = (open(column, row - 1), open(column, row));
        if !(sides.0 && next.0 || sides.1 && next.1) {
            return false;
        }
        sides = next;
    }
    true
}
