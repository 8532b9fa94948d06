// Drops blocks that no choice has looked at for long and that have no finer ones. A thread a slot. Blocks are looked at with
// those that they lie in: what is finer is never looked at later.

#import dolomite::blocks::bindings::heads
#import dolomite::blocks::record::NO_BLOCK
#import dolomite::blocks::stock::stock
#import dolomite::detail::bindings::detail

@compute @workgroup_size(64)
fn sweep_blocks(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot == NO_BLOCK || slot >= detail.capacity || heads[slot].half == 0u {
        return;
    }
    let parent = heads[slot].parent;
    // Roots stay.
    if parent == NO_BLOCK || any(heads[slot].children != vec4(NO_BLOCK)) || heads[slot].looked >= detail.oldest {
        return;
    }
    for (var k = 0u; k < 4u; k++) {
        if heads[parent].children[k] == slot {
            heads[parent].children[k] = NO_BLOCK;
        }
    }
    heads[slot].half = 0u;
    stock.slots[atomicAdd(&stock.free, 1u)] = slot;
}
