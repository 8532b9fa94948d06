#define_import_path dolomite::detail::bindings

// What all passes of the terrain LOD share.

#import dolomite::detail::types::{Cell, DetailParams, Link, ViewCell}

struct DetailPass {
    // Depth that the pass works on; roots have 0.
    depth: u32,
    pad_a: u32,
    pad_b: u32,
    pad_c: u32,
}

@group(0) @binding(0) var<uniform> detail: DetailParams;
@group(0) @binding(1) var<uniform> detail_pass: DetailPass;
// Kept from frame to frame for all views of a ground: what does not depend on them.
@group(0) @binding(2) var<storage, read_write> cells: array<Cell>;
@group(0) @binding(3) var<storage, read_write> links: array<Link>;
// Of this view.
@group(0) @binding(4) var<storage, read_write> seen: array<ViewCell>;
@group(0) @binding(5) var<storage, read_write> counts: array<atomic<u32>>;
// First cells of blocks of four: those to look at from the front of the first capacity / 2 words, those to
// make from the back; behind them the cells that are kept.
@group(0) @binding(6) var<storage, read_write> lists: array<u32>;

// Words of `counts`, all of them 0 before the first pass.
// Blocks to look at, and to make, of each depth.
const LOOK: u32 = 32u;
const MAKE: u32 = 64u;
// Vertices and triangles.
const VERTICES: u32 = 1u;
const TRIANGLES: u32 = 2u;
// Bits of the greatest error ratio of a cell for whose quarters there was no room.
const WITHOUT_ROOM: u32 = 3u;
// Bits of what error ratios are divided by; 0 before it is known.
const COARSENING: u32 = 4u;
// Bits of the greatest error ratio that finest cells leave.
const LEFT: u32 = 5u;
// Cells that are kept: their centre has an error ratio.
const KEPT: u32 = 6u;
// Vertices in their geomorph, on the way to their own height.
const MORPHING: u32 = 7u;
// Triangles that the camera does not see.
const OTHERS: u32 = 8u;
// Middles and centres by error ratio, eight steps an octave from APPEARS on.
const HISTOGRAM: u32 = 96u;
const STEPS_AN_OCTAVE: f32 = 8.0;
const BINS: u32 = 256u;
// The map of the horizon, by layers and columns, and whether it is blind: see horizon.wgsl.
const HORIZON: u32 = 352u;
// Threads of a workgroup, and most workgroups of a dispatch; each works for every (workgroups)th item.
const GROUP: u32 = 64u;
const MOST_GROUPS: u32 = 65535u;
// Arguments of the dispatches of a depth: of those that make, of those that look and keep; 3 words each.
const ARGUMENTS: u32 = 6u;
const LOOK_ARGUMENTS: u32 = 3u;

// How many blocks come before those of a depth, in a list whose counts begin at `list`.
fn blocks_before(list: u32, depth: u32) -> u32 {
    var sum = 0u;
    for (var k = 0u; k < depth; k++) {
        sum += atomicLoad(&counts[list + k]);
    }
    return sum;
}

// A block to look at.
fn look_block(at: u32) -> u32 {
    return lists[at];
}

// A block to make.
fn make_block(at: u32) -> u32 {
    return lists[detail.capacity / 2u - 1u - at];
}

// A kept cell.
fn kept_cell(at: u32) -> u32 {
    return lists[detail.capacity / 2u + at];
}

fn root_count() -> u32 {
    return detail.roots.x * detail.roots.y;
}
