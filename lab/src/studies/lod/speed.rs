//! What a view costs on the CPU: cells, selection, mesh.

use crate::scenes::camera::Camera;
use crate::scenes::selection::{bound, cells_of, choose, detail_view};
use dolomite_ground::detail::mesh;
use dolomite_terrain::Terrain;
use dolomite_testkit::metrics::median;
use std::time::Instant;

/// Times of one camera, milliseconds, medians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speed {
    /// Making all cells that the view looks at, on all cores: a first selection less one that finds them.
    pub make: f64,
    /// Selecting where all cells are known, on one core.
    pub select: f64,
    /// Heights and triangles, on one core.
    pub mesh: f64,
    /// Cells that the view looks at.
    pub cells: u64,
    /// Cells whose centre is drawn.
    pub drawn_cells: u64,
    /// Vertices.
    pub vertices: u64,
    /// Triangles.
    pub triangles: u64,
    /// Greatest error ratio that was not met; see `Selection::held`.
    pub held: f64,
}

/// A camera at `tau` pixels with cells no smaller than `finest` metres. `None` without `repeats`.
#[must_use]
pub fn speed(
    terrain: &Terrain,
    camera: &Camera,
    tau: f64,
    finest: f32,
    repeats: usize,
) -> Option<Speed> {
    let view = detail_view(camera, bound(tau));
    let milliseconds = |start: Instant| start.elapsed().as_secs_f64() * 1e3;
    let [mut first, mut again, mut meshing] = [(); 3].map(|()| Vec::new());
    let mut last = None;
    for _ in 0..repeats {
        let mut cells = cells_of(terrain, finest);
        // Else the second selection might have to make cells again.
        cells.keep = usize::MAX;
        let start = Instant::now();
        drop(choose(&mut cells, &view));
        first.push(milliseconds(start));
        let start = Instant::now();
        let selection = choose(&mut cells, &view);
        again.push(milliseconds(start));
        let start = Instant::now();
        let drawn = mesh::mesh(&cells, &selection);
        meshing.push(milliseconds(start));
        last = Some((
            cells.len() as u64,
            selection.cells().count() as u64,
            drawn.vertices.len() as u64,
            drawn.triangles.len() as u64,
            f64::from(selection.held),
        ));
    }
    let (cells, drawn_cells, vertices, triangles, held) = last?;
    let select = median(again)?;
    Some(Speed {
        make: median(first)? - select,
        select,
        mesh: median(meshing)?,
        cells,
        drawn_cells,
        vertices,
        triangles,
        held,
    })
}
