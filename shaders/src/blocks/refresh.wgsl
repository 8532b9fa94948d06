// Takes over anew what blocks copy from their parents, where that alone has become another: no height is looked up, and nothing
// else of a record depends on it. A workgroup a block. CPU reference: refreshed in plugins/ground/src/blocks/others.rs.

#import dolomite::blocks::bindings::{REFRESHED, REFRESHES, heads, lists, record_at, refresh_list}
#import dolomite::blocks::others::{copy_corner, taken_by}
#import dolomite::blocks::record::{CORNERS, CORNER_COUNT, block_quarter, quarter_corner}
#import dolomite::detail::bindings::counts

const GROUP: u32 = 64u;

var<workgroup> all_taken_by: atomic<u32>;

@compute @workgroup_size(64)
fn refresh_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    // The last of those that were taken from the list.
    let first = atomicLoad(&counts[REFRESHED]) - atomicLoad(&counts[REFRESHES]);
    let slot = lists[refresh_list() + first + group.x];
    let record = record_at(slot);
    let parent = record_at(heads[slot].parent);
    let inside = quarter_corner(block_quarter(heads[slot].centre, heads[slot].half));
    if thread == 0u {
        atomicStore(&all_taken_by, 0u);
    }
    workgroupBarrier();
    for (var k = thread; k < CORNER_COUNT; k += GROUP) {
        let corner = vec2(k % CORNERS, k / CORNERS);
        // Those of mixed parity are its own.
        if ((corner.x ^ corner.y) & 1u) == 0u {
            copy_corner(record, parent, inside, corner);
        }
    }
    atomicOr(&all_taken_by, taken_by);
    workgroupBarrier();
    if thread == 0u {
        heads[slot].others = atomicLoad(&all_taken_by);
    }
}
