//! What the shaders of the level of detail are told and keep, byte for byte as
//! `shaders/src/detail/types.wgsl` and `bindings.wgsl` (a test compares them).

use bytemuck::{Pod, Zeroable};
use dolomite_terrain::{Filter, GpuTerrainUniform, Source, Terrain};

use super::cell::DetailCells;
use super::cull::CullView;
use super::ground::DetailGround;
use super::horizon::{COLUMNS, HorizonView, LAYERS};
use super::lattice::DetailLattice;
use super::view::DetailView;
use crate::range::{DEPTH_RANGE, OPAQUE_DEPTH};

/// A ground on a lattice: of cells or of blocks.
pub trait OnLattice {
    /// Where vertices stand.
    fn lattice(&self) -> &DetailLattice;
    /// Height of the water, or far below everything.
    fn sea(&self) -> f32;
}

impl OnLattice for DetailCells {
    fn lattice(&self) -> &DetailLattice {
        &self.lattice
    }

    fn sea(&self) -> f32 {
        self.terrain()
            .sea_level()
            .unwrap_or(GpuTerrainUniform::NO_SEA)
    }
}

impl OnLattice for DetailGround {
    fn lattice(&self) -> &DetailLattice {
        &self.lattice
    }

    fn sea(&self) -> f32 {
        self.sea()
    }
}

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
    pub flags: u32,
    pub clip: [[f32; 4]; 4],
    pub half_size: [f32; 2],
    pub oldest: u32,
    pub pad: f32,
    pub horizon: HorizonView,
    pub border: u32,
    pub edited_count: u32,
    pub border_pad: [u32; 2],
    pub first_x: [u32; 2],
    pub last_x: [u32; 2],
    pub first_z: [u32; 2],
    pub last_z: [u32; 2],
    pub edited: [EditedRect; MOST_EDITED],
}

/// Most rectangles that are told to have been edited since cells were made.
pub const MOST_EDITED: usize = 16;

/// A part of the ground that was edited: cells on it are made anew where no choice after the one of `stamp` has looked at
/// them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct EditedRect {
    /// First lattice line along x and z.
    pub low: [u32; 2],
    /// Last ones.
    pub high: [u32; 2],
    /// The newest choice before the edit; of cells alone.
    pub stamp: u32,
    /// Half the side of the smallest block for which it counts from farther away, lattice steps; of blocks alone.
    pub wide_from: u32,
    /// From how far away, cells of the block.
    pub wide_cells: u32,
    /// 0.
    pub pad: u32,
}

/// Bit of [`DetailParams::flags`]: triangles that the camera does not see are left out.
pub const CULL: u32 = 1;
/// Bit of [`DetailParams::flags`]: among them those that face away.
pub const FACING: u32 = 2;
/// Bit of [`DetailParams::flags`]: they are kept at the end of the list, for shadows.
pub const KEEP_OTHERS: u32 = 4;
/// Bit of [`DetailParams::flags`]: triangles behind nearer ground are left out as well.
pub const OCCLUDED: u32 = 8;

/// Bit of [`DetailParams::flags`]: vertices are counted by their error ratio, for a budget.
pub const COUNTED: u32 = 16;

impl DetailParams {
    /// For a view of the cells' ground, with room for so many cells, vertices and triangles. Nothing is left
    /// out of view; see [`Self::cull`].
    #[must_use]
    pub fn new(ground: &impl OnLattice, view: DetailView, capacity: u32, pools: [u32; 2]) -> Self {
        let lattice = ground.lattice();
        let words = |step: u64| [(step >> 32) as u32, step as u32];
        let border = lattice.border;
        let longer = |of: [u64; 2], axis: usize| match border.width {
            0 => [0; 2],
            _ => words(of[axis].wrapping_sub(lattice.step[axis])),
        };
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
            sea: ground.sea(),
            opaque_depth: OPAQUE_DEPTH,
            anchor_height: 0.0,
            flags: 0,
            clip: [[0.0; 4]; 4],
            half_size: [0.0; 2],
            oldest: 0,
            pad: 0.0,
            horizon: HorizonView::default(),
            border: border.width,
            edited_count: 0,
            border_pad: [0; 2],
            first_x: longer(border.first, 0),
            last_x: longer(border.last, 0),
            first_z: longer(border.first, 1),
            last_z: longer(border.last, 1),
            edited: [EditedRect::default(); MOST_EDITED],
        }
    }

    /// The same with cells made anew where these rectangles were edited; beyond [`MOST_EDITED`] of them are left out.
    #[must_use]
    pub fn edited(mut self, rects: &[EditedRect]) -> Self {
        let count = rects.len().min(MOST_EDITED);
        self.edited[..count].copy_from_slice(&rects[..count]);
        self.edited_count = count as u32;
        self
    }

    /// The same with the triangles left out of the list that `picture` shows nothing of; `keep_others` puts
    /// them at its end, where draws into shadow maps find them.
    #[must_use]
    pub fn cull(self, picture: &CullView, keep_others: bool) -> Self {
        let facing = if picture.one_sided { FACING } else { 0 };
        let others = if keep_others { KEEP_OTHERS } else { 0 };
        Self {
            flags: CULL | facing | others,
            clip: picture.clip.to_cols_array_2d(),
            half_size: picture.half_size.to_array(),
            ..self
        }
    }

    /// The same with those left out as well that nearer ground hides from this view.
    #[must_use]
    pub fn occlude(self, horizon: HorizonView) -> Self {
        Self {
            flags: self.flags | OCCLUDED,
            horizon,
            ..self
        }
    }

    /// Whether a pass has something to do.
    #[must_use]
    pub const fn needs(&self, groups: Groups) -> bool {
        match groups {
            Groups::Horizon => self.flags & OCCLUDED != 0,
            Groups::Blocks => self.oldest > 0,
            _ => true,
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

/// Bytes of a cell that all views of a ground share: what was made of it, and its link.
pub const SHARED_CELL_BYTES: u64 = (size_of::<super::cell::Cell>() + size_of::<Link>()) as u64;
/// Bytes of the stock's head; behind it there is a byte for each cell that there is room for.
pub const STOCK_HEAD_BYTES: u64 = 16;
/// Bytes of a cell in a view.
pub const VIEW_CELL_BYTES: u64 = 96;
/// Bytes of the lists, for each cell that there is room for: of blocks two words for four, of kept cells one.
pub const LIST_BYTES: u64 = 6;
/// Bytes of what the height of a vertex depends on, and of the number of one that is geomorphing.
pub const RECORD_BYTES: u64 = 20;
/// Words of the counts that a choice begins with.
pub const COUNT_WORDS: usize = 352;
/// Words of the counts in all: behind those the map of the horizon, and whether it is blind.
pub const ALL_COUNT_WORDS: usize = COUNT_WORDS + COLUMNS * LAYERS + 1;
/// Word of the counts at which the histogram of error ratios begins, in halves of a vertex.
pub const HISTOGRAM: usize = 96;
/// Its steps.
pub const BINS: usize = 256;
/// Its steps in an octave.
pub const STEPS_AN_OCTAVE: f32 = 8.0;
/// Word of the counts: blocks to look at, of each depth.
pub const LOOK: usize = 32;
/// Word of the counts: blocks to make, of each depth.
pub const MAKE: usize = 64;
/// Threads of a workgroup that works on a cell or a vertex a thread.
pub const GROUP: u32 = 64;
/// Most workgroups of a dispatch.
pub const MOST_GROUPS: u32 = 65_535;
/// Word of the head that holds the coarsening, as f32.
pub const HEAD_COARSENING: usize = 24;
/// Word of the head that holds the greatest error ratio that finest cells leave, as f32.
pub const HEAD_LEFT: usize = 25;
/// Word of the head that holds how many cells are kept.
pub const HEAD_USED: usize = 26;

/// How many workgroups a pass has. All but one are counted on the GPU, from what the passes before found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Groups {
    /// One for each block that its depth makes.
    Make,
    /// One for every 64 cells that its depth looks at.
    Look,
    /// One for every 64 cells that are kept, and one at least.
    Kept,
    /// The same, where what nearer ground hides is left out; no dispatch elsewhere.
    Horizon,
    /// One for every 64 blocks of four cells that there is room for.
    Blocks,
    /// One.
    One,
}

/// What a pass binds beside what all share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Second {
    /// Nothing.
    Nothing,
    /// The ground's data.
    Ground,
    /// Arguments of the dispatches to come, written: of the next depth, and of the closing passes; and the
    /// stock of cells.
    Arguments,
    /// Corners of the roots, read; vertices and what their heights depend on, written.
    Vertices,
    /// Vertices, read; indices, written.
    Triangles,
    /// Head of the producer's work, written; arguments of the closing passes, and the stock of cells.
    Head,
}

/// A pass: file, entry, what it binds, how many workgroups it has.
pub type Pass = (&'static str, &'static str, Second, Groups);

/// The pass that drops cells which no choice has looked at for long: before the first depth, where room is
/// short.
pub const SWEEP_PASS: Pass = (
    "detail/sweep.wgsl",
    "sweep",
    Second::Arguments,
    Groups::Blocks,
);

/// Workgroups of [`SWEEP_PASS`].
#[must_use]
pub const fn sweep_groups(capacity: u32) -> u32 {
    let groups = (capacity / 4).div_ceil(GROUP);
    if groups < MOST_GROUPS {
        groups
    } else {
        MOST_GROUPS
    }
}

/// The passes of one depth, in order.
pub const DEPTH_PASSES: [Pass; 3] = [
    (
        "detail/make.wgsl",
        "make_cells",
        Second::Ground,
        Groups::Make,
    ),
    (
        "detail/look.wgsl",
        "look_at_cells",
        Second::Nothing,
        Groups::Look,
    ),
    (
        "detail/keep.wgsl",
        "keep_cells",
        Second::Arguments,
        Groups::Look,
    ),
];

/// The passes that close a choice after its last depth, in order.
pub const LAST_PASSES: [Pass; 9] = [
    (
        "detail/middles.wgsl",
        "find_middles",
        Second::Nothing,
        Groups::Kept,
    ),
    ("detail/fit.wgsl", "fit", Second::Nothing, Groups::One),
    (
        "detail/number.wgsl",
        "number_vertices",
        Second::Nothing,
        Groups::Kept,
    ),
    (
        "detail/place_vertices.wgsl",
        "place_vertices",
        Second::Vertices,
        Groups::Kept,
    ),
    (
        "detail/raise.wgsl",
        "raise_vertices",
        Second::Vertices,
        Groups::Kept,
    ),
    (
        "detail/draw_horizon.wgsl",
        "draw_horizon",
        Second::Nothing,
        Groups::Horizon,
    ),
    (
        "detail/close_horizon.wgsl",
        "close_horizon",
        Second::Nothing,
        Groups::Horizon,
    ),
    (
        "detail/emit_triangles.wgsl",
        "emit_triangles",
        Second::Triangles,
        Groups::Kept,
    ),
    ("detail/finish.wgsl", "finish", Second::Head, Groups::One),
];

/// Definitions that leave a kind of layers out, and which layers those are.
const LEFT_OUT: [(&str, fn(&Source) -> bool); 6] = [
    ("TERRAIN_WITHOUT_FRACTALS", |source| {
        matches!(source, Source::Fractal(_))
    }),
    ("TERRAIN_WITHOUT_CLASSIC", |source| {
        matches!(source, Source::Permutation(_))
    }),
    ("TERRAIN_WITHOUT_HILLS", |source| {
        matches!(source, Source::Hill(_))
    }),
    ("TERRAIN_WITHOUT_MAPS", |source| {
        matches!(source, Source::Map(_))
    }),
    (
        "TERRAIN_WITHOUT_BILINEAR",
        |source| matches!(source, Source::Map(map) if map.filter() == Filter::Bilinear),
    ),
    (
        "TERRAIN_WITHOUT_BICUBIC",
        |source| matches!(source, Source::Map(map) if map.filter() == Filter::Bicubic),
    ),
];

/// Leaves edits out.
const WITHOUT_EDITS: &str = "TERRAIN_WITHOUT_EDITS";

/// Definitions for the shader that makes cells: the kinds of layers that a terrain has not. Software Vulkan runs
/// all sides of a branch.
#[must_use]
pub fn without(terrain: &Terrain) -> Vec<&'static str> {
    let layers = &terrain.data().layers;
    let is_absent =
        |(_, is): &&(&str, fn(&Source) -> bool)| !layers.iter().any(|layer| is(&layer.source));
    if terrain.streamed().is_some() {
        // There is such a map, of either filter.
        let kinds = LEFT_OUT[..KINDS].iter().filter(is_absent);
        return kinds
            .map(|(name, _)| *name)
            .chain([TILED])
            .chain(terrain.edits().is_none().then_some(WITHOUT_EDITS))
            .collect();
    }
    LEFT_OUT
        .iter()
        .filter(is_absent)
        .map(|(name, _)| *name)
        .chain(terrain.edits().is_none().then_some(WITHOUT_EDITS))
        .collect()
}

/// Kinds of layers that are left out by themselves, the first of [`LEFT_OUT`].
const KINDS: usize = 3;
/// A map is read by tiles.
const TILED: &str = "TERRAIN_TILED";

/// Everything that [`without`] may give: each kind of layers is there or not, and maps are there where one of
/// their filters is; and the same with edits and without.
#[must_use]
pub fn all_without() -> Vec<Vec<&'static str>> {
    let [kinds @ .., maps, bilinear, bicubic] = LEFT_OUT.map(|(name, _)| name);
    let sets = 0..1_u32 << (kinds.len() + 2);
    let whole = sets.map(|set| {
        let is = |bit: usize| set >> bit & 1 == 1;
        let [no_bilinear, no_bicubic] = [is(kinds.len()), is(kinds.len() + 1)];
        let others = (0..kinds.len())
            .filter(|bit| is(*bit))
            .map(|bit| kinds[bit]);
        let of_maps = [
            (no_bilinear && no_bicubic, maps),
            (no_bilinear, bilinear),
            (no_bicubic, bicubic),
        ];
        let of_maps = of_maps.into_iter().filter(|(left_out, _)| *left_out);
        others.chain(of_maps.map(|(_, name)| name)).collect()
    });
    let tiled = (0..1_u32 << kinds.len()).map(|set| {
        let names = (0..kinds.len()).filter(|bit| set >> bit & 1 == 1);
        names.map(|bit| kinds[bit]).chain([TILED]).collect()
    });
    whole
        .chain(tiled)
        .flat_map(|names: Vec<_>| {
            let unedited = names.iter().copied().chain([WITHOUT_EDITS]).collect();
            [names, unedited]
        })
        .collect()
}

/// Depths that arguments are kept for: all, and the one after the last.
const ARGUMENT_DEPTHS: u32 = super::lattice::MAX_DEPTH + 2;
/// Bytes of the arguments of the dispatches of all depths.
pub const ARGUMENT_BYTES: u64 = ARGUMENT_DEPTHS as u64 * 24;
/// Bytes of the arguments of the closing passes.
pub const CLOSING_BYTES: u64 = 12;

/// Where the arguments of a depth's dispatches lie, bytes: of those that make, of those that look and keep.
#[must_use]
pub const fn arguments_at(depth: u32, groups: Groups) -> u64 {
    let first = depth as u64 * 24;
    match groups {
        Groups::Make => first,
        _ => first + 12,
    }
}

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

    /// Lists of blocks as a ground with room for `capacity` cells begins with them: those to look at from the front on,
    /// those to make from the back on.
    #[must_use]
    pub fn lists(&self, capacity: u32) -> Vec<u32> {
        let mut lists = vec![0; capacity as usize / 2];
        let last = lists.len() - 1;
        for (k, &block) in self.blocks.iter().enumerate() {
            lists[k] = block;
            lists[last - k] = block;
        }
        lists
    }

    /// The stock before anything is made: the roots are in use, no block is free.
    #[must_use]
    pub fn stock(&self) -> [u32; 4] {
        [self.links.len() as u32, 0, 0, 0]
    }

    /// The counts before a choice; `fresh` where nothing has been made.
    #[must_use]
    pub fn counts(&self, fresh: bool) -> [u32; COUNT_WORDS] {
        let mut counts = [0; COUNT_WORDS];
        counts[LOOK] = self.blocks.len() as u32;
        counts[MAKE] = if fresh { self.blocks.len() as u32 } else { 0 };
        counts
    }

    /// Arguments of the dispatches before a choice: those of the first depth, no workgroup of all others,
    /// which the first depth and those after it count. Both buffers between which depths take turns begin so.
    #[must_use]
    pub fn arguments(&self, fresh: bool) -> [[[u32; 3]; 2]; ARGUMENT_DEPTHS as usize] {
        let mut arguments = [[[0, 1, 1]; 2]; ARGUMENT_DEPTHS as usize];
        let blocks = self.blocks.len() as u32;
        arguments[0][0][0] = if fresh { blocks } else { 0 };
        arguments[0][1][0] = (4 * blocks).div_ceil(GROUP);
        arguments
    }

    /// Arguments of the closing passes before a choice: roots are drawn even where no cell is kept.
    pub const CLOSING: [u32; 3] = [1; 3];
}
