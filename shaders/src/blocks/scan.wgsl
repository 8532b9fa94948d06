// Finds the blocks of which a vertex may be there: by the largest error in them and the box of all. A thread a slot.

#import dolomite::blocks::bindings::{candidate_list, done_word, heads, lists, seen}
#import dolomite::blocks::ratio::{BEFORE, GREATEST, box_factor, edge_of, frame_of, place_before}
#import dolomite::blocks::record::{NO_BLOCK, WINDOW}
#import dolomite::detail::bindings::detail

// Arguments of the dispatch that looks at them.
@group(1) @binding(0) var<storage, read_write> arguments: array<atomic<u32>>;

@compute @workgroup_size(64)
fn scan_blocks(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot == 0u {
        atomicStore(&arguments[1], 1u);
        atomicStore(&arguments[2], 1u);
    }
    // Rounds behind one that made nothing would find what it found.
    if lists[done_word()] != 0u {
        return;
    }
    // The first slot is no block; a free one has no half.
    if slot == NO_BLOCK || slot >= detail.capacity || heads[slot].half == 0u {
        return;
    }
    let head = heads[slot];
    let frame = frame_of(head.centre, head.half);
    // Boxes of vertices on its border reach two cells beyond.
    let least = place_before(frame, vec2(BEFORE - 4u));
    let most = place_before(frame, vec2(BEFORE + 36u));
    let size = select(edge_of(frame, vec2(2u, 0u)), head.mixed_error, detail.view.metric == 2u);
    // A hundredth more: this is the bound of another box than each vertex has.
    var ratio = 1.01 * size * box_factor(frame, vec3(least.x, head.low, least.y), vec3(most.x, head.high, most.y));
    // Roots are always drawn.
    ratio = select(ratio, GREATEST, head.parent == NO_BLOCK);
    if ratio <= WINDOW {
        return;
    }
    heads[slot].looked = detail.stamp;
    seen[slot].stamp = detail.stamp;
    atomicStore(&seen[slot].mixed, select(0u, bitcast<u32>(GREATEST), head.parent == NO_BLOCK));
    for (var k = 0u; k < 4u; k++) {
        atomicStore(&seen[slot].centres[k], 0u);
    }
    for (var k = 0u; k < 8u; k++) {
        atomicStore(&seen[slot].appear[k], 0u);
    }
    lists[candidate_list() + atomicAdd(&arguments[0], 1u)] = slot;
}
