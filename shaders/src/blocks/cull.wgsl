// Leaves out the blocks of which nothing is seen: behind nearer ground. A thread a block that is drawn.

#import dolomite::blocks::bindings::{drawn_list, heads, lists, shown_list}
#import dolomite::blocks::ratio::{frame_of, place_in}
#import dolomite::detail::bindings::detail
#import dolomite::detail::cull::KEEP_OTHERS
#import dolomite::detail::horizon::{OCCLUDED, is_below_behind, map_place}

// See fit.wgsl.
@group(1) @binding(1) var<storage, read_write> arguments: array<atomic<u32>>;

// Word of the arguments: how many are shown.
const SHOWN: u32 = 15u;

fn is_hidden_block(slot: u32) -> bool {
    if (detail.flags & OCCLUDED) == 0u || (detail.flags & KEEP_OTHERS) != 0u {
        return false;
    }
    let frame = frame_of(heads[slot].centre, heads[slot].half);
    let low = place_in(frame, vec2(0u));
    let high = place_in(frame, vec2(32u));
    let top = heads[slot].high - detail.anchor_height;
    return is_below_behind(
        map_place(vec3(low.x, top, low.y)),
        map_place(vec3(high.x, top, low.y)),
        map_place(vec3(high.x, top, high.y)),
        map_place(vec3(low.x, top, high.y)),
    );
}

@compute @workgroup_size(64)
fn cull_blocks(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= atomicLoad(&arguments[0]) {
        return;
    }
    let slot = lists[drawn_list() + id.x];
    if !is_hidden_block(slot) {
        lists[shown_list() + atomicAdd(&arguments[SHOWN], 1u)] = slot;
    }
}
