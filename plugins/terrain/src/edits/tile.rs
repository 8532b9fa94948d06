//! A tile: 32 × 32 cells, with the samples that interpolation in them reaches.

use super::extremes::Extremes;

/// Metres of one step of height: 2⁻¹².
pub const STEP: f64 = 1.0 / 4096.0;
/// Most that a place can be raised or lowered, metres: with it every number of steps is exact in f32.
pub const LIMIT: f64 = 4096.0;

/// Cells along a side.
pub(crate) const CELLS: i32 = 32;
/// Samples along a side: from one before the tile to one behind its last line.
pub(crate) const SIDE: usize = CELLS as usize + 3;
/// Samples of a tile.
pub(crate) const SAMPLES: usize = SIDE * SIDE;

/// Steps of a tile, row by row, the first row and column one sample before its own. What neighbours share is in both.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Tile {
    steps: Box<[i32]>,
    extremes: Extremes,
}

impl Tile {
    /// Of as many steps as a tile has; `None` where none is edited.
    pub(crate) fn new(steps: Box<[i32]>) -> Option<Self> {
        debug_assert_eq!(steps.len(), SAMPLES, "a tile's samples");
        steps.iter().any(|step| *step != 0).then(|| Self {
            extremes: Extremes::of(&steps, SIDE),
            steps,
        })
    }

    pub(crate) fn steps(&self) -> &[i32] {
        &self.steps
    }

    pub(crate) const fn extremes(&self) -> Extremes {
        self.extremes
    }

    /// The sample of a tile's own line and column, from −1 to 33.
    pub(crate) fn at(&self, x: i32, z: i32) -> i32 {
        self.steps[(z + 1) as usize * SIDE + (x + 1) as usize]
    }
}

/// Metres of steps, exactly.
pub(crate) fn metres(steps: i32) -> f32 {
    steps as f32 * STEP as f32
}
