// Pass 2, a thread an item: vertices and primitives of each block of 256 items.

#import dolomite::stage::api::stage
#import dolomite::stage::counts::{item_size, work}
#import dolomite::stage::work::{BLOCK, COLUMNS, WHOLE, block_word, item_count}

var<workgroup> sums: array<vec2<u32>, 256>;

@compute @workgroup_size(256)
fn measure(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let block = group.x + group.y * COLUMNS;
    let item = block * BLOCK + thread;
    var size = vec2(0u);
    if item < item_count(stage) {
        size = item_size(item, WHOLE);
    }
    sums[thread] = size;
    workgroupBarrier();
    for (var half = 128u; half > 0u; half >>= 1u) {
        if thread < half {
            sums[thread] += sums[thread + half];
        }
        workgroupBarrier();
    }
    if thread == 0u && block * BLOCK < item_count(stage) {
        let at = block_word(stage, block);
        work[at] = sums[0].x;
        work[at + 1u] = sums[0].y;
    }
}
