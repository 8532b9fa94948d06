//! Which way cells are cut into triangles.

use bevy::math::IVec2;

/// Which way the cells between samples are cut into triangles. North is −Z, east is +X.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Diagonals {
    /// As the drawn ground has them at full detail: through the corner of which both coordinates are even, so that
    /// neighbouring cells are cut in turns.
    #[default]
    Alternating,
    /// From north-east to south-west, all alike: parry's own.
    Alike,
}

impl Diagonals {
    /// Whether a cell is cut from north-west to south-east.
    #[must_use]
    pub const fn falls(self, cell: IVec2) -> bool {
        match self {
            Self::Alternating => (cell.x ^ cell.y) & 1 == 0,
            Self::Alike => false,
        }
    }
}
