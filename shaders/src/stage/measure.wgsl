// Pass 2, a thread BLOCK_RUN items: vertices and primitives of each item and of each block.

#import dolomite::stage::api::stage
#import dolomite::stage::counts::{item_size, work}
#import dolomite::stage::work::{BLOCK, BLOCK_RUN, COLUMNS, WHOLE, block_word, item_count, offset_word}

var<workgroup> sums: array<vec2<u32>, 64>;

@compute @workgroup_size(64)
fn measure(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let block = group.x + group.y * COLUMNS;
    let first = block * BLOCK + thread * BLOCK_RUN;
    var sum = vec2(0u);
    for (var item = first; item < min(first + BLOCK_RUN, item_count(stage)); item++) {
        let size = item_size(item, WHOLE);
        let at = offset_word(stage, item);
        work[at] = size.x;
        work[at + 1u] = size.y;
        sum += size;
    }
    sums[thread] = sum;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half >>= 1u) {
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
