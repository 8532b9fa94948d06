//! What a choice of the ground is told, byte for byte as `shaders/src/detail/types.wgsl` (a test compares them); and which
//! parts of its shaders a ground has no use for.

use bytemuck::{Pod, Zeroable};
use dolomite_terrain::{Filter, Source, Terrain};

use super::cull::CullView;
use super::ground::DetailGround;
use super::horizon::HorizonView;
use super::view::DetailView;
use crate::range::{DEPTH_RANGE, OPAQUE_DEPTH};

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

/// Most rectangles that are told to have been edited since the last choice.
pub const MOST_EDITED: usize = 16;

/// A part of the ground that was edited: blocks that it reaches are made anew before the next choice.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct EditedRect {
    /// First lattice line along x and z.
    pub low: [u32; 2],
    /// Last ones.
    pub high: [u32; 2],
    /// Half the side of the smallest block for which it counts from farther away, lattice steps.
    pub wide_from: u32,
    /// From how far away, cells of the block.
    pub wide_cells: u32,
    /// 0.
    pub pad: [u32; 2],
}

/// Bit of [`DetailParams::flags`]: triangles that the camera does not see are left out.
pub const CULL: u32 = 1;
/// Bit of [`DetailParams::flags`]: among them those that face away.
pub const FACING: u32 = 2;
/// Bit of [`DetailParams::flags`]: they are kept at the end of the list, for shadows.
pub const KEEP_OTHERS: u32 = 4;
/// Bit of [`DetailParams::flags`]: triangles behind nearer ground are left out as well.
pub const OCCLUDED: u32 = 8;

impl DetailParams {
    /// For a view of a ground, with so many slots of blocks, and room for so many vertices and triangles. Nothing is left
    /// out of view; see [`Self::cull`].
    #[must_use]
    pub fn new(ground: &DetailGround, view: DetailView, capacity: u32, pools: [u32; 2]) -> Self {
        let lattice = &ground.lattice;
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

    /// The same with blocks made anew where these rectangles were edited; beyond [`MOST_EDITED`] of them are left out.
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
}

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

/// Definitions for the shaders that look heights up: the kinds of layers that a terrain has not. Software Vulkan runs
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
