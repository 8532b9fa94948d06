//! What a view costs on the CPU: blocks, choice, mesh.

use crate::scenes::camera::Camera;
use crate::scenes::selection::{blocks_of, bound, choose, detail_view};
use dolomite_ground::blocks::mesh::mesh;
use dolomite_terrain::Terrain;
use dolomite_testkit::metrics::median;
use std::time::Instant;

/// Times of one camera, milliseconds, medians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speed {
    /// Making all blocks that the view asks for, on all cores: choices until it is settled, less one that finds them.
    pub make: f64,
    /// Choosing where all blocks are known, on one core.
    pub select: f64,
    /// Heights and triangles, on one core.
    pub mesh: f64,
    /// Blocks that there are then.
    pub blocks: u64,
    /// Blocks that are drawn.
    pub drawn_blocks: u64,
    /// Vertices, those of each block by themselves.
    pub vertices: u64,
    /// Triangles.
    pub triangles: u64,
    /// The bound that is held, in tolerances; see `Choice::held`.
    pub held: f64,
}

/// A camera at `tau` pixels with cells down to `finest` metres. `None` without `repeats`.
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
        let mut blocks = blocks_of(terrain, finest);
        let start = Instant::now();
        drop(choose(&mut blocks, &view));
        first.push(milliseconds(start));
        let start = Instant::now();
        let choice = choose(&mut blocks, &view);
        again.push(milliseconds(start));
        let start = Instant::now();
        let drawn = mesh(&blocks, &choice);
        meshing.push(milliseconds(start));
        let exist = choice.blocks.iter();
        let exist = exist.filter(|block| choice.exists(block, &blocks));
        last = Some((
            blocks.len() as u64,
            exist.count() as u64,
            drawn.vertices.len() as u64,
            drawn.triangles.len() as u64,
            f64::from(choice.held),
        ));
    }
    let (blocks, drawn_blocks, vertices, triangles, held) = last?;
    let select = median(again)?;
    Some(Speed {
        make: median(first)? - select,
        select,
        mesh: median(meshing)?,
        blocks,
        drawn_blocks,
        vertices,
        triangles,
        held,
    })
}
