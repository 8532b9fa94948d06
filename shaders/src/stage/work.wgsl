#define_import_path dolomite::stage::work

// What the passes of the stage leave to each other in one buffer, in words:
//
//   head      40  draw and dispatch arguments, counters: geometry/head.wgsl, then the stage's own
//   corners    1  each: 1 where a patch uses it
//   edges      1  each: the greatest level that a patch beside it asks for, 0 without
//   inner      4  each patch: inner levels (isolines: lines, segments), 0 where it is discarded; as
//                 control left them until `place`, then lifted and lowered, and behind them the
//                 segments of sides and rows, 8 bits each; 5 where sides may be split, the last
//                 for the segments of their first halves
//   blocks     2  for each 256 items: vertices and primitives, then those before them
//   offsets    2  each item, and once behind the last: vertices and primitives of it as `measure` left
//                 them until `place`, then those before it
//   threads    1  each thread of emit_vertices: its item; then each of emit_grid: its patch
//
// Items are the corners, then the edges, then the patches. Pure functions: the files with entry
// points bind the buffer, as atomics or not.

#import dolomite::stage::types::{Rules, ONE, EQUAL, FRACTIONAL_EVEN, FRACTIONAL_ODD, D3D}
#import dolomite::stage::api::StageParams

// Words of the head that are the stage's own, behind those of geometry/head.wgsl.
// dispatch_workgroups_indirect of emit_vertices, and of emit_grid.
const VERTEX_DISPATCH: u32 = 24u;
const GRID_DISPATCH: u32 = 27u;
// What is left of every level, in 1/1024.
const SHARE: u32 = 30u;
const HEAD: u32 = 40u;
#ifdef STAGE_SPLIT
const INNER_WORDS: u32 = 5u;
#else
const INNER_WORDS: u32 = 4u;
#endif

// An edge in a patch's table: its number, and whether it runs against the patch's side.
const EDGE_NUMBER: u32 = 0x7fffffffu;
const REVERSED: u32 = 0x80000000u;

// Items of a block, and of one of its threads: software Vulkan pays for barriers by the thread.
const BLOCK: u32 = 256u;
const BLOCK_RUN: u32 = 4u;
// Columns of a dispatch's grid: one axis allows 65535 groups.
const COLUMNS: u32 = 32768u;
// After so many steps of 4/5 every level is below 1.
const LOWERINGS: u32 = 19u;
const WHOLE: u32 = 1024u;

fn item_count(stage: StageParams) -> u32 {
    return stage.corners + stage.edges + stage.patches;
}

fn corner_word(corner: u32) -> u32 {
    return HEAD + corner;
}

fn edge_word(stage: StageParams, edge: u32) -> u32 {
    return HEAD + stage.corners + edge;
}

fn inner_word(stage: StageParams, id: u32) -> u32 {
    return HEAD + stage.corners + stage.edges + INNER_WORDS * id;
}

fn block_word(stage: StageParams, block: u32) -> u32 {
    return HEAD + stage.corners + stage.edges + INNER_WORDS * stage.patches + 2u * block;
}

fn offset_word(stage: StageParams, item: u32) -> u32 {
    return block_word(stage, (item_count(stage) + BLOCK - 1u) / BLOCK) + 2u * item;
}

// What is left of a level after so many steps of 4/5, in 1/1024.
fn share_after(steps: u32) -> u32 {
    var share = WHOLE;
    for (var k = 0u; k < steps; k++) {
        share = share * 4u / 5u;
    }
    return share;
}

// Vertices of one item that a thread of emit_vertices makes at most: what they have in common is
// loaded once.
const VERTEX_RUN: u32 = 4u;
// The same of primitives and patches, on average.
const GRID_RUN: u32 = 32u;

// Threads of emit_vertices (column 0) before item `number`, or of emit_grid (column 1) before patch
// `number`, which so many vertices or primitives come before. The difference from one to the next is
// at least what the pool holds of its own, divided by the run and rounded up.
fn thread_before(stage: StageParams, column: u32, number: u32, before: u32) -> u32 {
    if column == 1u {
        return min(before, stage.max_primitives) / GRID_RUN + number;
    }
    return min(before, stage.max_vertices) / VERTEX_RUN + number;
}

// Where it stands which item (column 0) or patch (column 1) a thread works for.
fn thread_word(stage: StageParams, column: u32, thread: u32) -> u32 {
    let items = item_count(stage);
    let before = select(0u, thread_before(stage, 0u, items, stage.max_vertices), column == 1u);
    return offset_word(stage, items + 1u) + before + thread;
}

// A level that was lowered to share / 1024 of it, clamped and rounded again.
fn lower(rules: Rules, level: u32, share: u32) -> u32 {
    if share == WHOLE || level == 0u {
        return level;
    }
    // At most 2^29: no carry is lost.
    var lowered = ((level >> 9u) * share) >> 1u;
    if rules.spacing == EQUAL {
        lowered = (lowered + ONE - 1u) & ~(ONE - 1u);
    } else if rules.mode == D3D {
        lowered = (lowered + 255u) & ~255u;
    }
    let least = select(ONE, 2u * ONE, rules.spacing == FRACTIONAL_EVEN);
    let greatest = select(64u * ONE, 63u * ONE, rules.spacing == FRACTIONAL_ODD);
    return clamp(lowered, least, greatest);
}
