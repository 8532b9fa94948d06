//! The street grid: which part of the ground is street, crossing or lawn, and where parts meet others.
//!
//! Line `k` of the grid lies at `k · pitch`, along both axes. Cell (x, z) is the square between lines x and x + 1
//! and between z and z + 1; it consists of 3 × 3 sections: half a street, the block, half a street, each way.
//! Sides are numbered west (−x), south (+z), east (+x), north (−z): those of the stage's quads with u to the east
//! and v to the north.

use crate::rules::{CityRules, Streets};
use crate::surface::Surface;

/// Number of a side.
pub const WEST: usize = 0;
/// Number of a side.
pub const SOUTH: usize = 1;
/// Number of a side.
pub const EAST: usize = 2;
/// Number of a side.
pub const NORTH: usize = 3;

/// A cell of the grid, by column (east) and row (south).
pub type Cell = [i32; 2];

/// Whether line `k` is a street.
#[must_use]
pub const fn is_street(rules: &CityRules, k: i32) -> bool {
    match rules.streets {
        Streets::Grid => true,
        Streets::Cross => k == 0,
    }
}

/// Whether there is a street along a side of a cell's block.
#[must_use]
pub const fn street_at(rules: &CityRules, cell: Cell, side: usize) -> bool {
    let line = match side {
        WEST => cell[0],
        EAST => cell[0].wrapping_add(1),
        NORTH => cell[1],
        _ => cell[1].wrapping_add(1),
    };
    is_street(rules, line)
}

/// What covers a section of a cell; 1 is the middle along an axis.
#[must_use]
pub fn section(rules: &CityRules, cell: Cell, [a, b]: [u32; 2]) -> Surface {
    let along = |k: u32, low: usize, high: usize| match k {
        0 => Some(street_at(rules, cell, low)),
        1 => None,
        _ => Some(street_at(rules, cell, high)),
    };
    match (along(a, WEST, EAST), along(b, NORTH, SOUTH)) {
        (Some(true), Some(true)) => Surface::Cobbles,
        (Some(true), _) | (_, Some(true)) => Surface::Asphalt,
        _ => Surface::Grass,
    }
}

/// For each side of a section, whether what lies beyond is of another kind.
#[must_use]
pub fn borders(rules: &CityRules, cell: Cell, [a, b]: [u32; 2]) -> [bool; 4] {
    let own = section(rules, cell, [a, b]);
    let beyond = |da: i32, db: i32| {
        let step = |cell: i32, k: u32, d: i32| match k.cast_signed() + d {
            -1 => (cell.wrapping_sub(1), 2),
            3 => (cell.wrapping_add(1), 0),
            k => (cell, k.cast_unsigned()),
        };
        let (x, a) = step(cell[0], a, da);
        let (z, b) = step(cell[1], b, db);
        section(rules, [x, z], [a, b]) != own
    };
    [beyond(-1, 0), beyond(0, 1), beyond(1, 0), beyond(0, -1)]
}

/// Cells of a city that ends, around the origin: least ones, and how many.
#[must_use]
pub fn extent(rules: &CityRules) -> Option<(Cell, [u32; 2])> {
    let (east, south) = rules.blocks?;
    let least = |n: u32| -((n / 2).cast_signed());
    Some(([least(east), least(south)], [east, south]))
}

/// Whether the city has a cell.
#[must_use]
pub fn has_cell(rules: &CityRules, cell: Cell) -> bool {
    extent(rules).is_none_or(|(least, count)| {
        (0..2).all(|k| {
            let at = i64::from(cell[k]) - i64::from(least[k]);
            (0..i64::from(count[k])).contains(&at)
        })
    })
}

/// The cell that a place lies in; `None` where it is not finite or too far for a number of a cell.
#[must_use]
pub fn cell_at(rules: &CityRules, [x, z]: [f64; 2]) -> Option<Cell> {
    let number = |place: f64| {
        let k = (place / f64::from(rules.pitch)).floor();
        (k.abs() < 2e9).then_some(k as i32)
    };
    Some([number(x)?, number(z)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules(streets: Streets) -> CityRules {
        CityRules {
            streets,
            ..CityRules::default()
        }
    }

    #[test]
    fn a_border_is_one_from_both_sides() {
        let mut seen = [0; 2];
        for streets in [Streets::Grid, Streets::Cross] {
            let rules = rules(streets);
            // Sections in one row over cells −3..3, east neighbours; the other axis by symmetry of the rules.
            let all = |n: i32| ([n.div_euclid(3), n.rem_euclid(3)], n);
            for i in -9..9 {
                for j in -9..9 {
                    let ([cx, a], _) = all(i);
                    let ([cz, b], _) = all(j);
                    let here = borders(&rules, [cx, cz], [a as u32, b as u32]);
                    let ([nx, na], _) = all(i + 1);
                    let east = borders(&rules, [nx, cz], [na as u32, b as u32]);
                    assert_eq!(here[EAST], east[WEST], "{streets:?} {i} {j}");
                    let ([nz, nb], _) = all(j + 1);
                    let south = borders(&rules, [cx, nz], [a as u32, nb as u32]);
                    assert_eq!(here[SOUTH], south[NORTH], "{streets:?} {i} {j}");
                    seen[usize::from(here[EAST])] += 1;
                }
            }
        }
        assert!(seen[0] > 50 && seen[1] > 50, "{seen:?}");
    }

    #[test]
    fn a_grid_has_streets_everywhere_and_a_cross_two() {
        let grid = rules(Streets::Grid);
        assert_eq!(section(&grid, [7, -9], [0, 0]), Surface::Cobbles);
        assert_eq!(section(&grid, [7, -9], [1, 2]), Surface::Asphalt);
        assert_eq!(section(&grid, [7, -9], [1, 1]), Surface::Grass);
        let cross = rules(Streets::Cross);
        assert_eq!(section(&cross, [7, -9], [0, 1]), Surface::Grass);
        // Cell (0, 3) lies east of line 0, cell (−1, 3) west of it.
        assert_eq!(section(&cross, [0, 3], [0, 1]), Surface::Asphalt);
        assert_eq!(section(&cross, [-1, 3], [2, 0]), Surface::Asphalt);
        assert_eq!(section(&cross, [-1, -1], [2, 2]), Surface::Cobbles);
    }

    #[test]
    fn places_have_cells_and_hostile_ones_none() {
        let rules = CityRules::default();
        assert_eq!(cell_at(&rules, [-0.1, 32.0]), Some([-1, 1]));
        for place in [f64::NAN, f64::INFINITY, 1e12] {
            assert_eq!(cell_at(&rules, [place, 0.0]), None);
        }
        let small = CityRules {
            blocks: Some((125, 2)),
            ..rules
        };
        assert!(has_cell(&small, [-62, -1]) && has_cell(&small, [62, 0]));
        assert!(!has_cell(&small, [63, 0]) && !has_cell(&small, [0, 1]));
    }
}
