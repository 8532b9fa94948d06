// Whether drawn ground may be as high as the eye beside it: then the map of the horizon is blind, see
// plugins/ground/src/detail/horizon.rs. A workgroup a block beside the eye.

#import dolomite::blocks::bindings::{heads, lists, near_list, records}
#import dolomite::blocks::beside::is_beside
#import dolomite::blocks::leaves::{drawn_by_child, exists, is_there, share}
#import dolomite::blocks::record::{CELL_HIGHS, CORNER_COUNT, RINGED, VERTICES}
#import dolomite::blocks::way::{Block, block_at, coarsening_now, find_children, way_of}
#import dolomite::detail::bindings::{counts, detail}
#import dolomite::detail::horizon::BLIND

const GROUP: u32 = 64u;

// Whether the drawn surface may be as high as the eye in a cell of `size` cells.
fn is_high(block: Block, cell: vec2<u32>, size: u32) -> bool {
    var highest = -3e38;
    for (var z = 0u; z < size; z++) {
        for (var x = 0u; x < size; x++) {
            let number = (cell.y * size + z + 1u) * RINGED + cell.x * size + x + 1u;
            highest = max(highest, bitcast<f32>(records[block.record + CELL_HIGHS + number]));
        }
    }
    // A height that is no number is as high.
    return !(highest - detail.anchor_height < detail.horizon.eye.y - detail.horizon.near_reach);
}

// The same in one of 341 cells, where its own triangles are drawn.
fn look_in(block: Block, k: u32, children: u32) {
    // 256 of one cell's size, 64 of two, 16 of four, 4 of eight, and the whole block.
    var level = 0u;
    var number = k;
    for (var count = 256u; number >= count; count /= 4u) {
        number -= count;
        level++;
    }
    let size = 1u << level;
    let row = 4u - level;
    let cell = vec2(number & ((1u << row) - 1u), number >> row);
    let whole = level == 4u;
    if !whole && (drawn_by_child(children, cell, size) || !exists(cell, size)) {
        return;
    }
    if !is_beside(block.frame, 2u * size * cell, 2u * size * (cell + vec2(1u))) {
        return;
    }
    // Its quarters that are cells have triangles of their own.
    var own = true;
    if level > 0u && is_there((cell.y * 17u + cell.x) * size + 9u * size) {
        own = false;
        for (var q = 0u; q < 4u; q++) {
            let quarter = 2u * cell + vec2(q & 1u, q >> 1u);
            let is_own = !drawn_by_child(children, quarter, size / 2u) && !exists(quarter, size / 2u);
            own = own || (is_own && is_beside(block.frame, size * quarter, size * (quarter + vec2(1u))));
        }
    }
    if own && is_high(block, cell, size) {
        atomicStore(&counts[BLIND], 1u);
    }
}

@compute @workgroup_size(64)
fn stand(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let slot = lists[near_list() + group.x];
    let block = block_at(slot);
    let coarsening = coarsening_now();
    for (var k = thread; k < VERTICES; k += GROUP) {
        share[k] = way_of(block, k, coarsening);
    }
    workgroupBarrier();
    let children = find_children(heads[slot].children, coarsening);
    for (var k = thread; k < 341u; k += GROUP) {
        look_in(block, k, children);
    }
}
