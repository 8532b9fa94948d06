//! The static mesh: one grid of equal cells over all of the terrain.

use super::baseline::{Baseline, Knob};
use crate::scenes::camera::Camera;
use crate::scenes::mesh::{Drawn, barycentric};
use crate::scenes::truth::Truth;
use bevy::math::{DVec2, DVec3};

/// A grid of cells of one size, two triangles each. All of its vertices count, seen or not, as those
/// of a static mesh do.
#[derive(Debug, Clone, Copy)]
pub struct Uniform;

impl Baseline for Uniform {
    fn name(&self) -> &'static str {
        "uniform grid"
    }

    fn knob(&self) -> Knob {
        Knob {
            name: "spacing, metres",
            coarsest: 512.0,
            finest: 1.0 / 4096.0,
        }
    }

    fn draw(&self, truth: &Truth, _: &Camera, knob: f64) -> Option<Box<dyn Drawn>> {
        Some(Box::new(UniformGrid::new(truth, knob)))
    }
}

/// The grid, never in memory: it may have 10¹⁵ vertices. Heights are evaluated when asked for.
#[derive(Debug)]
pub struct UniformGrid {
    truth: Truth,
    min: DVec2,
    cells: DVec2,
    spacing: DVec2,
}

impl UniformGrid {
    /// Cells of at most `spacing` metres that fill the terrain's extent.
    #[must_use]
    pub fn new(truth: &Truth, spacing: f64) -> Self {
        let extent = truth.terrain.extent();
        let cells = (extent.size() / spacing).ceil().max(DVec2::ONE);
        Self {
            truth: truth.clone(),
            min: extent.min,
            cells,
            spacing: extent.size() / cells,
        }
    }
}

impl Drawn for UniformGrid {
    fn triangle(&self, xz: DVec2) -> Option<([DVec3; 3], [f64; 3])> {
        let at = (xz - self.min) / self.spacing;
        if !(at.cmpge(DVec2::ZERO).all() && at.cmple(self.cells).all()) {
            return None;
        }
        let cell = at.floor().min(self.cells - 1.0);
        let place = |x: f64, z: f64| self.min + (cell + DVec2::new(x, z)) * self.spacing;
        let inside = at - cell;
        let third = if inside.x >= inside.y {
            place(1.0, 0.0)
        } else {
            place(0.0, 1.0)
        };
        let flat = [place(0.0, 0.0), third, place(1.0, 1.0)];
        let at = barycentric(flat, xz)?;
        Some((flat.map(|xz| self.truth.point(xz)), at))
    }

    fn vertices(&self) -> u64 {
        ((self.cells.x + 1.0) * (self.cells.y + 1.0)) as u64
    }

    fn triangles(&self) -> u64 {
        (2.0 * self.cells.x * self.cells.y) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::terrains;

    #[test]
    fn vertices_lie_on_the_ground_and_cells_are_flat() {
        let truth = Truth::new(&terrains::fbm(1));
        let grid = UniformGrid::new(&truth, 100.0);
        assert_eq!((grid.vertices(), grid.triangles()), (83 * 83, 2 * 82 * 82));
        let min = truth.terrain.extent().min;
        let at = |x: f64, z: f64| min + DVec2::new(x, z) * (8192.0 / 82.0);
        let height = |xz| grid.height(xz).unwrap();
        assert!((height(at(3.0, 5.0)) - truth.bed(at(3.0, 5.0))).abs() < 1e-9);
        // The middle of the diagonal, and of a side.
        let middle = (truth.bed(at(3.0, 5.0)) + truth.bed(at(4.0, 6.0))) / 2.0;
        assert!((height(at(3.5, 5.5)) - middle).abs() < 1e-6);
        let middle = (truth.bed(at(3.0, 5.0)) + truth.bed(at(4.0, 5.0))) / 2.0;
        assert!((height(at(3.5, 5.0)) - middle).abs() < 1e-6);
        assert_eq!(grid.height(min - 1.0), None);
        assert!(grid.height(-min).is_some(), "the far corner belongs to it");
    }
}
