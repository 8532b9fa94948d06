//! What the shaders of the level of detail are told and keep, byte for byte as
//! `shaders/src/detail/types.wgsl` and `bindings.wgsl` (a test compares them).

use bytemuck::{Pod, Zeroable};
use dolomite_terrain::GpuTerrainUniform;

use super::cell::DetailCells;
use super::lattice::DetailLattice;
use super::view::DetailView;
use crate::ground::functions::{DEPTH_RANGE, OPAQUE_DEPTH};

/// All that the passes depend on, beside buffers.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "each field is documented once, in types.wgsl")]
pub struct DetailParams {
    pub view: DetailView,
    pub origin_cell: [i32; 2],
    pub origin_frac: [u32; 2],
    pub step_x: [u32; 2],
    pub step_z: [u32; 2],
    pub roots: [u32; 2],
    pub depth: u32,
    pub capacity: u32,
    pub stamp: u32,
    pub max_vertices: u32,
    pub max_triangles: u32,
    pub depth_range: f32,
    pub sea: f32,
    pub opaque_depth: f32,
    pub anchor_height: f32,
    pub pad: f32,
}

impl DetailParams {
    /// For a view of the cells' ground, with room for so many cells, vertices and triangles.
    #[must_use]
    pub fn new(cells: &DetailCells, view: DetailView, capacity: u32, pools: [u32; 2]) -> Self {
        let lattice = &cells.lattice;
        let words = |step: u64| [(step >> 32) as u32, step as u32];
        Self {
            view,
            origin_cell: lattice.origin.cell.to_array(),
            origin_frac: lattice.origin.frac.to_array(),
            step_x: words(lattice.step[0]),
            step_z: words(lattice.step[1]),
            roots: lattice.roots.to_array(),
            depth: lattice.depth,
            capacity,
            stamp: 0,
            max_vertices: pools[0],
            max_triangles: pools[1],
            depth_range: DEPTH_RANGE,
            sea: cells
                .terrain()
                .sea_level()
                .unwrap_or(GpuTerrainUniform::NO_SEA),
            opaque_depth: OPAQUE_DEPTH,
            anchor_height: 0.0,
            pad: 0.0,
        }
    }
}

/// Which depth a pass works on.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "see bindings.wgsl")]
pub struct DetailPass {
    pub depth: u32,
    pub pad: [u32; 3],
}

/// Where a cell stands among the others.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[expect(missing_docs, reason = "each field is documented once, in types.wgsl")]
pub struct Link {
    pub centre: [u32; 2],
    pub parent: u32,
    pub children: u32,
}

/// Bytes of a cell in a view.
pub const VIEW_CELL_BYTES: u64 = 64;
/// Words of the counts.
pub const COUNT_WORDS: usize = 352;
/// Word of the counts: blocks to look at, of each depth.
pub const LOOK: usize = 32;
/// Word of the counts: blocks to make, of each depth.
pub const MAKE: usize = 64;
/// Workgroups of a pass.
pub const GROUPS: u32 = 256;
/// Word of the stage's head that holds the coarsening, as f32.
pub const HEAD_COARSENING: usize = 26;
/// Word of the stage's head that holds the greatest demand that finest cells leave, as f32.
pub const HEAD_LEFT: usize = 27;
/// Word of the stage's head that holds how many cells are kept.
pub const HEAD_USED: usize = 28;

/// The passes of one depth, in order: file and entry.
pub const DEPTH_PASSES: [(&str, &str); 3] = [
    ("detail/make.wgsl", "make_cells"),
    ("detail/look.wgsl", "look_at_cells"),
    ("detail/keep.wgsl", "keep_cells"),
];

/// The passes after the last depth, in order: file, entry, and whether one thread is all.
pub const LAST_PASSES: [(&str, &str, bool); 6] = [
    ("detail/middles.wgsl", "find_middles", false),
    ("detail/fit.wgsl", "fit", true),
    ("detail/emit_vertices.wgsl", "number_vertices", false),
    ("detail/emit_vertices.wgsl", "emit_vertices", false),
    ("detail/emit_triangles.wgsl", "emit_triangles", false),
    ("detail/finish.wgsl", "finish", true),
];

/// Cells that there is room for at least: beside the roots, some.
pub const LEAST_CAPACITY: u32 = 1 << 12;

/// What the lists and links hold before anything is made: the roots, in blocks of four.
#[derive(Clone, Debug)]
pub struct Beginning {
    /// Of the roots' blocks.
    pub links: Vec<Link>,
    /// First cells of the blocks.
    pub blocks: Vec<u32>,
    /// Heights and gradients of the roots' corners.
    pub corners: Vec<[f32; 4]>,
}

impl Beginning {
    /// The roots of a ground.
    #[must_use]
    pub fn new(cells: &DetailCells) -> Self {
        let lattice: &DetailLattice = &cells.lattice;
        let mut links: Vec<Link> = lattice
            .root_cells()
            .map(|root| Link {
                centre: root.centre.to_array(),
                ..Link::default()
            })
            .collect();
        links.resize(links.len().next_multiple_of(4), Link::default());
        let step = 2 * lattice.root_half();
        let rows = (0..=lattice.roots.y).flat_map(|z| (0..=lattice.roots.x).map(move |x| [x, z]));
        let corners = rows
            .map(|at| {
                let height = cells.root_corner(bevy::math::UVec2::from(at) * step);
                [height.value, height.gradient.x, height.gradient.y, 0.0]
            })
            .collect();
        Self {
            blocks: (0..links.len() as u32).step_by(4).collect(),
            links,
            corners,
        }
    }

    /// The counts before a choice; `fresh` where nothing has been made. The first word is how many cells
    /// are in use, and kept between choices.
    #[must_use]
    pub fn counts(&self, fresh: bool) -> [u32; COUNT_WORDS] {
        let mut counts = [0; COUNT_WORDS];
        counts[0] = self.links.len() as u32;
        counts[LOOK] = self.blocks.len() as u32;
        counts[MAKE] = if fresh { self.blocks.len() as u32 } else { 0 };
        counts
    }
}
