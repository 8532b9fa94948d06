#define_import_path dolomite::blocks::bindings

// What the passes of the blocks share: layout in plugins/ground/src/blocks/layout.rs. Bindings 0 and 5 of the group are
// `detail` and `counts` of detail/bindings.wgsl.

#import dolomite::blocks::record::{BlockHead, RECORD_WORDS}
#import dolomite::detail::bindings::detail

struct BlockNumbers {
    // Most blocks that a frame makes.
    budget: u32,
    // Levels of a map that is read by tiles; 0: there is none.
    levels: u32,
    // Steps of the lattice between its samples, as a power of two.
    shift: u32,
    // Most blocks that an edit makes anew; roots are.
    remade: u32,
    // Of each level: places on the lattice about which its samples are there, first x and z, last x and z.
    readable: array<vec4<i32>, 26>,
}

// A block in a view.
struct SeenBlock {
    // DetailParams.stamp of the choice that looked at it.
    stamp: u32,
    // Bits of the largest error ratio of its mixed corners, and of the centres in each quarter.
    mixed: atomic<u32>,
    centres: array<atomic<u32>, 4>,
    pad_a: u32,
    pad_b: u32,
    // How many of its own vertices appear, by the coarsenings of counting.wgsl, two a word.
    appear: array<atomic<u32>, 8>,
    // Which of its own vertices appear where nothing is coarsened; a word each half row, see looked.wgsl.
    there: array<u32, 32>,
}

@group(0) @binding(1) var<uniform> numbers: BlockNumbers;
// Of a ground, for all views.
@group(0) @binding(2) var<storage, read_write> records: array<u32>;
@group(0) @binding(3) var<storage, read_write> heads: array<BlockHead>;
// Of this view.
@group(0) @binding(4) var<storage, read_write> seen: array<SeenBlock>;
// By DetailParams.capacity = n: n blocks to look at, n that are drawn, n that are shown, n beside the eye, then blocks to make,
// then whether there was nothing left to make in the last round, then how many blocks the last edit made anew, dropped and
// refreshed. While an edit is taken over the first three lists hold blocks that wait to be made anew, that are dropped, and that
// wait to be refreshed.
@group(0) @binding(6) var<storage, read_write> lists: array<u32>;

// Words of `counts`, all of them 0 before the first pass; from HORIZON on the map of the horizon.
const VERTICES: u32 = 1u;
const TRIANGLES: u32 = 2u;
// Bits of what error ratios are divided by.
const COARSENING: u32 = 4u;
// Bits of the largest error ratio that the finest blocks leave.
const LEFT: u32 = 5u;
// Triangles that the camera does not see.
const OTHERS: u32 = 8u;
// Blocks that were looked at, that are drawn, that are made, and that would be made if there were time.
const CANDIDATES: u32 = 9u;
const DRAWN: u32 = 10u;
const MADE: u32 = 11u;
const WISHES: u32 = 12u;
// Bits of the largest error ratio of a centre whose quarter has not been made.
const MISSING: u32 = 13u;
// How many vertices appear by coarsening.
const CURVE: u32 = 16u;
// Of an edit, which comes before the words above are written: blocks that are to be made anew and those of them that have been,
// in order; those of the last round; and those that are dropped.
const WAITING: u32 = 40u;
const REMADE: u32 = 41u;
const ROUND: u32 = 42u;
const LOST: u32 = 43u;
// The same of blocks that are refreshed: those that are to be, those of them that have been, and those of the last round.
const STALE: u32 = 44u;
const REFRESHED: u32 = 45u;
const REFRESHES: u32 = 46u;
// By the blocks that a round makes: for which quarters gradients have become others, see others.wgsl.
const SLOPES: u32 = 64u;

// Most blocks that a round makes, and that it refreshes.
const MOST_MADE: u32 = 64u;
const MOST_REFRESHED: u32 = 1024u;

fn record_at(slot: u32) -> u32 {
    return slot * RECORD_WORDS;
}

fn candidate_list() -> u32 {
    return 0u;
}

fn drawn_list() -> u32 {
    return detail.capacity;
}

fn shown_list() -> u32 {
    return 2u * detail.capacity;
}

fn near_list() -> u32 {
    return 3u * detail.capacity;
}

fn made_list() -> u32 {
    return 4u * detail.capacity;
}

fn done_word() -> u32 {
    return made_list() + MOST_MADE;
}

fn waiting_list() -> u32 {
    return candidate_list();
}

fn lost_list() -> u32 {
    return drawn_list();
}

fn refresh_list() -> u32 {
    return shown_list();
}

fn remade_word() -> u32 {
    return done_word() + 1u;
}
