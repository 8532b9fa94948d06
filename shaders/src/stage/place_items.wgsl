// Pass 4, a thread an item: what comes before each item. Where the pools do not hold all even at
// level 1, the last vertices and primitives are those that are missing.

#import dolomite::stage::api::stage
#import dolomite::stage::counts::{item_size, work}
#import dolomite::stage::work::{BLOCK, COLUMNS, SHARE, block_word, item_count, offset_word}

var<workgroup> sums: array<vec2<u32>, 256>;

@compute @workgroup_size(256)
fn place_items(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let block = group.x + group.y * COLUMNS;
    let item = block * BLOCK + thread;
    let share = work[SHARE];
    var size = vec2(0u);
    if item < item_count(stage) {
        size = item_size(item, share);
    }
    sums[thread] = size;
    for (var reach = 1u; reach < BLOCK; reach <<= 1u) {
        workgroupBarrier();
        var before = vec2(0u);
        if thread >= reach {
            before = sums[thread - reach];
        }
        workgroupBarrier();
        sums[thread] += before;
    }
    if item < item_count(stage) {
        let base = block_word(stage, block);
        let at = offset_word(stage, item);
        let before = sums[thread] - size;
        work[at] = work[base] + before.x;
        work[at + 1u] = work[base + 1u] + before.y;
    }
}
