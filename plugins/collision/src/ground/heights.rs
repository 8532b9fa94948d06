//! Tiles of the ground: where their samples lie, and which way their cells are cut.
//!
//! Samples stand on one lattice for the whole world, so that neighbours share those of their border to the bit: the
//! distance of samples is a power of two, and places of samples are exact in f32 up to 2²⁴ of them from the origin.

use super::diagonals::Diagonals;
use bevy::ecs::prelude::*;
use bevy::math::{DVec2, IVec2};
use bevy::transform::components::Transform;
use dolomite_terrain::Ground;
use std::fmt;
use std::sync::Arc;
use thiserror::Error;

/// Ground that is met as triangles between samples of it: by movers, where this entity has
/// [`MeetsMovers`](crate::MeetsMovers), and with the feature `rapier` by Rapier's bodies. Tiles of it come where movers are and
/// bodies are awake, and go.
///
/// Contacts and collision events name this entity. Its `Friction`, `Restitution`, `CollisionGroups` and `SolverGroups`
/// are those of the ground.
///
/// Another ground, written into this component, is met from the next step on: bodies on what has changed wake, and
/// those that would be inside are lifted by as much as the ground rose; movers below it are put onto it.
#[derive(Component, Clone)]
#[require(Transform)]
pub struct GroundTiles {
    ground: Arc<dyn Ground>,
    step: f32,
    cells: u32,
    diagonals: Diagonals,
    /// How far around a body there is ground, metres, beside what it covers in a step.
    pub margin: f32,
}

impl fmt::Debug for GroundTiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GroundTiles")
            .field("step", &self.step)
            .field("cells", &self.cells)
            .field("diagonals", &self.diagonals)
            .field("margin", &self.margin)
            .finish_non_exhaustive()
    }
}

/// Tiles that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum TileError {
    /// Samples would not be exact.
    #[error("samples {0} m apart: a power of two from 1/64 to 64 is needed")]
    Step(f32),
    /// Too few or too many.
    #[error("{0} cells a side of a tile: 1 to 256 are needed")]
    Cells(u32),
}

/// Samples farther from the origin than this many steps are not exact in f32.
const FARTHEST: f64 = 16_777_216.0;

impl GroundTiles {
    /// Samples `step` metres apart, a power of two, and tiles of `cells` by `cells` of them.
    ///
    /// # Errors
    /// [`TileError`].
    pub fn new(ground: Arc<dyn Ground>, step: f32, cells: u32) -> Result<Self, TileError> {
        const FRACTION: u32 = (1 << 23) - 1;
        let power = (1.0 / 64.0..=64.0).contains(&step) && step.to_bits() & FRACTION == 0;
        if !power {
            return Err(TileError::Step(step));
        }
        if !(1..=256).contains(&cells) {
            return Err(TileError::Cells(cells));
        }
        Ok(Self {
            ground,
            step,
            cells,
            diagonals: Diagonals::default(),
            margin: 1.0,
        })
    }

    /// With cells cut another way.
    #[must_use]
    pub const fn with_diagonals(mut self, diagonals: Diagonals) -> Self {
        self.diagonals = diagonals;
        self
    }

    /// The ground that is sampled.
    #[must_use]
    pub fn ground(&self) -> &Arc<dyn Ground> {
        &self.ground
    }

    /// Puts another ground in its place.
    pub fn set_ground(&mut self, ground: Arc<dyn Ground>) {
        self.ground = ground;
    }

    /// The distance of samples, metres.
    #[must_use]
    pub const fn step(&self) -> f32 {
        self.step
    }

    /// How many cells a side of a tile has.
    #[must_use]
    pub const fn cells(&self) -> u32 {
        self.cells
    }

    /// Which way cells are cut.
    #[must_use]
    pub const fn diagonals(&self) -> Diagonals {
        self.diagonals
    }

    /// The side of a tile, metres.
    #[must_use]
    pub fn side(&self) -> f32 {
        self.step * self.cells as f32
    }

    /// Which cell of the lattice a place lies in; `None` where samples are not exact.
    #[must_use]
    pub fn cell(&self, xz: DVec2) -> Option<IVec2> {
        let cell = (xz / f64::from(self.step)).floor();
        // Each by itself: the greatest of a number and of none is the number.
        let near = cell.abs().cmplt(DVec2::splat(FARTHEST)).all();
        near.then(|| cell.as_ivec2())
    }

    /// The tile of a cell.
    #[must_use]
    pub fn tile_of(&self, cell: IVec2) -> IVec2 {
        let cells = self.cells as i32;
        IVec2::new(cell.x.div_euclid(cells), cell.y.div_euclid(cells))
    }

    /// The height of a sample, metres, as Rapier has it; movers have it in parts of 2⁻¹⁶ m. What is not finite is 0: a hole would let bodies fall.
    #[must_use]
    pub fn sample(&self, at: IVec2) -> f32 {
        let height = self.ground.height(at.as_dvec2() * f64::from(self.step)) as f32;
        if height.is_finite() { height } else { 0.0 }
    }

    /// The height of the surface that is met, metres: that of the triangle over a place; `None` where
    /// samples are not exact.
    #[must_use]
    pub fn surface(&self, xz: DVec2) -> Option<f64> {
        let cell = self.cell(xz)?;
        let at = xz / f64::from(self.step) - cell.as_dvec2();
        let corner = |x: i32, z: i32| f64::from(self.sample(cell + IVec2::new(x, z)));
        let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
        Some(over_cell(self.diagonals.falls(cell), at, corners))
    }
}

/// The height of a cell's triangles at a place in it, (x, z) of 0 to 1, between the heights of its corners: north-west,
/// north-east, south-west, south-east.
pub(super) fn over_cell(falls: bool, at: DVec2, [nw, ne, sw, se]: [f64; 4]) -> f64 {
    let (x, z) = (at.x, at.y);
    // The plane of the corner on this side of the diagonal and of the diagonal's ends.
    if falls {
        if x >= z {
            ne + (nw - ne) * (1.0 - x) + (se - ne) * z
        } else {
            sw + (se - sw) * x + (nw - sw) * (1.0 - z)
        }
    } else if x + z <= 1.0 {
        nw + (ne - nw) * x + (sw - nw) * z
    } else {
        se + (sw - se) * (1.0 - x) + (ne - se) * (1.0 - z)
    }
}
