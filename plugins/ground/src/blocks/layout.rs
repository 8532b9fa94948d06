//! What the passes of the blocks are told and keep, byte for byte as `shaders/src/blocks/bindings.wgsl` and `record.wgsl`
//! (a test compares them). Views, lattices and what is left out they are told by [`DetailParams`](crate::detail::layout::DetailParams).
//!
//! | buffer | of | holds |
//! |---|---|---|
//! | records | a ground | [`RECORD_WORDS`] words a slot: [`super::record::Block`] without its head |
//! | heads | a ground | [`GpuHead`] a slot |
//! | stock | a ground | which slots are in use |
//! | seen | a view | [`SEEN_BYTES`] a slot: largest error ratios, which vertices appear and how many |
//! | counts | a view | counters; the map of the horizon |
//! | lists | a view | blocks that are looked at, drawn, made |
//! | looked, arguments | a view | workgroups of the dispatches to come |
//! | samples | a view | heights about the blocks that are made |
//!
//! The first slot is no block. Roots have the slots after it.

use bytemuck::{Pod, Zeroable};
use dolomite_terrain::MOST_LEVELS;

use super::gate::Gate;
use super::place::{BlockPlace, VERTICES};
use super::record::{BlockHead, NO_BLOCK, RING, RINGED_COUNT};
use crate::detail::DetailLattice;
use crate::detail::layout::{ALL_COUNT_WORDS, GROUP, MOST_GROUPS};

/// What the passes depend on beside [`DetailParams`](crate::detail::layout::DetailParams) and buffers.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[expect(missing_docs, reason = "see bindings.wgsl")]
pub struct BlockNumbers {
    pub budget: u32,
    pub levels: u32,
    pub shift: u32,
    pub remade: u32,
    pub readable: [[i32; 4]; MOST_LEVELS],
}

impl BlockNumbers {
    /// With so many blocks made in a frame, [`MOST_MADE`] at most.
    #[must_use]
    pub const fn new(budget: u32) -> Self {
        let budget = if budget < MOST_MADE {
            budget
        } else {
            MOST_MADE
        };
        Self {
            budget,
            levels: 0,
            shift: 0,
            remade: u32::MAX,
            readable: [[0; 4]; MOST_LEVELS],
        }
    }

    /// The same where an edit makes at most so many anew; roots are in any case.
    #[must_use]
    pub const fn remaking(mut self, most: u32) -> Self {
        self.remade = most;
        self
    }

    /// The same of a map that is read by tiles.
    #[must_use]
    pub fn gated(mut self, gate: &Gate) -> Self {
        self.levels = gate.readable.len().min(MOST_LEVELS) as u32;
        self.shift = gate.shift;
        for (to, from) in self.readable.iter_mut().zip(&gate.readable) {
            *to = *from;
        }
        self
    }
}

/// A head as the passes have it; see [`BlockHead`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "see BlockHead")]
pub struct GpuHead {
    pub centre: [u32; 2],
    /// 0 where the slot is free.
    pub half: u32,
    pub parent: u32,
    pub children: [u32; 4],
    pub looked: u32,
    pub mixed_error: f32,
    pub low: f32,
    pub high: f32,
    /// See [`Others`](super::others::Others): when it was last made or refreshed.
    pub others: u32,
    pub pad: [u32; 3],
}

impl GpuHead {
    /// A root that has not been made.
    #[must_use]
    pub const fn root(place: BlockPlace) -> Self {
        let cell = place.cell();
        Self {
            centre: cell.centre.to_array(),
            half: cell.half,
            parent: NO_BLOCK,
            children: [NO_BLOCK; 4],
            looked: 0,
            mixed_error: 0.0,
            low: 0.0,
            high: 0.0,
            others: 0,
            pad: [0; 3],
        }
    }

    /// The same on the CPU.
    #[must_use]
    pub fn head(&self) -> BlockHead {
        BlockHead {
            centre: self.centre.into(),
            half: self.half,
            parent: self.parent,
            children: self.children,
            looked: self.looked,
            mixed_error: self.mixed_error,
            low: self.low,
            high: self.high,
        }
    }
}

/// Words of a record without its head.
pub const RECORD_WORDS: usize = 5 * VERTICES + RING + 2 * RINGED_COUNT;
/// Bytes of a slot of a ground, for all views: record, head, and a word of the stock.
pub const SLOT_BYTES: u64 = 4 * RECORD_WORDS as u64 + HEAD_BYTES + 4;
/// Bytes of a head.
pub const HEAD_BYTES: u64 = size_of::<GpuHead>() as u64;
/// Bytes of the stock before its list.
pub const STOCK_HEAD_BYTES: u64 = 16;
/// Bytes of a slot in a view.
pub const SEEN_BYTES: u64 = 192;
/// Words of the counts in all.
pub const COUNT_WORDS: usize = ALL_COUNT_WORDS;
/// Most blocks that a frame makes, and roots that a ground has.
pub const MOST_MADE: u32 = 64;
/// Most blocks that a round of an edit refreshes. There is a round for every level at least, and hardly a view keeps more of
/// one level; what waits in the end all the same is dropped.
pub const MOST_REFRESHED: u32 = 1024;
/// Samples of a block.
pub const SAMPLE_COUNT: u32 = 89 * 89;
/// Fours of samples of a block, the last of a row not whole: what a thread of the pass that samples works on.
pub const FOUR_COUNT: u32 = 89 * 89_u32.div_ceil(4);
/// Bytes of the samples, and of as many errors.
pub const SAMPLE_BYTES: u64 = 8 * SAMPLE_COUNT as u64 * MOST_MADE as u64;
/// Bytes of the arguments of the pass that looks.
pub const LOOKED_BYTES: u64 = 12;
/// Bytes of the arguments of the other passes.
pub const ARGUMENT_BYTES: u64 = 96;
/// Least slots: the first, the roots, some blocks.
pub const LEAST_SLOTS: u32 = 128;

/// Words of the lists.
#[must_use]
pub const fn list_words(slots: u32) -> u64 {
    remade_at(slots) + 3
}

/// Word of the lists that says how many blocks the newest edit made anew; the next ones say how many it dropped and how many it
/// refreshed.
#[must_use]
pub const fn remade_at(slots: u32) -> u64 {
    done_at(slots) + 1
}

/// Word of the lists that says whether there was nothing left to make in the last round of looking and making: then the
/// rounds that follow in the same frame look at nothing. 0 before the first.
#[must_use]
pub const fn done_at(slots: u32) -> u64 {
    made_at(slots) + MOST_MADE as u64
}

/// Word of the lists from which on the blocks stand that are made.
#[must_use]
pub const fn made_at(slots: u32) -> u64 {
    4 * slots as u64
}

/// Word of the head of the producer's work that holds the coarsening, as f32.
pub const HEAD_COARSENING: usize = 24;
/// The greatest error ratio that the finest blocks leave, as f32.
pub const HEAD_LEFT: usize = 25;
/// Blocks that there are.
pub const HEAD_USED: usize = 26;
/// Blocks that would be made if there were time.
pub const HEAD_WISHES: usize = 27;
/// Blocks that are made.
pub const HEAD_MADE: usize = 28;
/// Blocks that were looked at.
pub const HEAD_CANDIDATES: usize = 29;
/// Blocks that are drawn.
pub const HEAD_DRAWN: usize = 30;
/// [`DetailParams::stamp`](crate::detail::layout::DetailParams::stamp) of the choice.
pub const HEAD_STAMP: usize = 31;
/// From here on how many vertices appear at the coarsenings 2^(k/2), k from 0 to 7.
pub const HEAD_CURVE: usize = 32;

/// How many workgroups a pass has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Groups {
    /// One for every 64 slots.
    Slots,
    /// One.
    One,
    /// As the arguments at these bytes say, of the pass that looks.
    Looked,
    /// As the arguments at these bytes say.
    At(u64),
    /// The same, where what nearer ground hides is left out; no dispatch elsewhere.
    Horizon(u64),
    /// One for every 64 slots, where blocks are dropped; no dispatch elsewhere.
    Sweep,
    /// One, before a choice whose ground was edited; no dispatch elsewhere.
    Edit,
    /// As the arguments at these bytes say, before a choice whose ground was edited; no dispatch elsewhere.
    EditAt(u64),
}

/// What a pass binds beside what all share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Second {
    /// Nothing.
    Nothing,
    /// The arguments of the pass that looks.
    Looked,
    /// All arguments and the stock.
    Arguments,
    /// Vertices and indices, written.
    Triangles,
    /// The ground's data, and the samples.
    Ground,
    /// Head of the producer's work, and the stock.
    Head,
}

/// A pass: file, entry, what it binds, how many workgroups it has.
pub type Pass = (&'static str, &'static str, Second, Groups);

/// The passes of a choice, in order; behind them those of an edit, which come before a choice.
pub const PASSES: [Pass; 16] = [
    (
        "blocks/sweep.wgsl",
        "sweep_blocks",
        Second::Arguments,
        Groups::Sweep,
    ),
    (
        "blocks/scan.wgsl",
        "scan_blocks",
        Second::Looked,
        Groups::Slots,
    ),
    (
        "blocks/look.wgsl",
        "look_at_blocks",
        Second::Nothing,
        Groups::Looked,
    ),
    ("blocks/fit.wgsl", "fit", Second::Arguments, Groups::One),
    (
        "blocks/draw_horizon.wgsl",
        "draw_horizon",
        Second::Nothing,
        Groups::Horizon(DRAWN),
    ),
    (
        "detail/close_horizon.wgsl",
        "close_horizon",
        Second::Nothing,
        Groups::Horizon(48),
    ),
    (
        "blocks/stand.wgsl",
        "stand",
        Second::Nothing,
        Groups::Horizon(72),
    ),
    (
        "blocks/cull.wgsl",
        "cull_blocks",
        Second::Arguments,
        Groups::Slots,
    ),
    (
        "blocks/emit.wgsl",
        "emit_blocks",
        Second::Triangles,
        Groups::At(60),
    ),
    (
        "blocks/sample.wgsl",
        "sample_blocks",
        Second::Ground,
        Groups::At(12),
    ),
    (
        "blocks/slope.wgsl",
        "slope_blocks",
        Second::Ground,
        Groups::At(24),
    ),
    (
        "blocks/make.wgsl",
        "make_blocks",
        Second::Ground,
        Groups::At(36),
    ),
    ("blocks/finish.wgsl", "finish", Second::Head, Groups::One),
    (
        "blocks/spread.wgsl",
        "spread_edits",
        Second::Arguments,
        Groups::Edit,
    ),
    (
        "blocks/refresh.wgsl",
        "refresh_blocks",
        Second::Nothing,
        Groups::EditAt(84),
    ),
    (
        "blocks/drop.wgsl",
        "drop_edited",
        Second::Arguments,
        Groups::Edit,
    ),
];

/// The pass that finds the blocks which a round makes anew or refreshes, among [`PASSES`].
pub const SPREAD: usize = 13;
/// The pass that refreshes blocks.
pub const REFRESH: usize = 14;
/// The pass that drops those which no round has made anew or refreshed.
pub const DROP: usize = 15;

/// File and entry of the pass that answers height queries, after a choice. Group 0 is what all passes share, group 1 holds
/// [`Asked`](crate::detail::probe::Asked) at 2, places at 3, answers at 4, as recorded by
/// `record_answers` of `render/blocks/record.rs`.
pub const ANSWER_PASS: (&str, &str) = ("blocks/answer.wgsl", "answer");

/// Where the arguments lie of the passes over blocks that are drawn.
const DRAWN: u64 = 0;

/// The passes that make, among [`PASSES`], and their workgroups for so many blocks.
#[must_use]
pub const fn making(blocks: u32) -> [(usize, [u32; 3]); 3] {
    let samples = FOUR_COUNT.div_ceil(GROUP);
    let vertices = (VERTICES as u32).div_ceil(GROUP);
    [
        (9, [samples, blocks, 1]),
        (10, [vertices, blocks, 1]),
        (11, [blocks, 1, 1]),
    ]
}

/// Workgroups of the passes that work on a slot a thread.
#[must_use]
pub const fn slot_groups(slots: u32) -> u32 {
    let groups = slots.div_ceil(GROUP);
    if groups < MOST_GROUPS {
        groups
    } else {
        MOST_GROUPS
    }
}

/// What buffers hold before the first choice.
#[derive(Clone, Debug)]
pub struct Beginning {
    /// From the first slot on: none, then the roots.
    pub heads: Vec<GpuHead>,
    /// Slots of the roots: what is made first.
    pub made: Vec<u32>,
}

impl Beginning {
    /// The roots of a lattice.
    #[must_use]
    pub fn new(lattice: &DetailLattice) -> Self {
        let roots = BlockPlace::roots(lattice).map(GpuHead::root);
        let heads: Vec<_> = [GpuHead::default()].into_iter().chain(roots).collect();
        Self {
            made: (1..heads.len() as u32).collect(),
            heads,
        }
    }

    /// The stock: nothing is free below what is used.
    #[must_use]
    pub const fn stock(&self) -> [u32; 4] {
        [self.heads.len() as u32, 0, 0, 0]
    }
}

/// Least vertices and triangles of a view: all corners of the roots are always there.
#[must_use]
pub const fn least_pools(lattice: &DetailLattice) -> [u32; 2] {
    let roots = lattice.roots.x * lattice.roots.y;
    [545 * roots, 1024 * roots]
}
