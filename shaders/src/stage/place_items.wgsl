// Pass 4, a thread an item: what comes before each item. Where the pools do not hold all even at
// level 1, the last vertices and primitives are those that are missing.

#import dolomite::stage::api::stage
#import dolomite::stage::types::ISOLINES
#import dolomite::stage::counts::{item_size, patch_shape, work}
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::work::{BLOCK, CHUNK, COLUMNS, SHARE, block_word, chunk_word, inner_word, item_count, offset_word}

var<workgroup> sums: array<vec2<u32>, 256>;

// Replaces the levels of a patch by those that count. Nobody else reads them in this pass.
fn settle(id: u32, share: u32) {
    let at = inner_word(stage, id);
    if work[at] == 0u {
        return;
    }
    let rules = stage_rules();
    let shape = patch_shape(rules, id, share);
    let levels = select(shape.inner, shape.outer.xy, rules.domain == ISOLINES);
    work[at] = levels.x;
    work[at + 1u] = levels.y;
    work[at + 2u] = shape.sides.x | (shape.sides.y << 8u) | (shape.sides.z << 16u) | (shape.sides.w << 24u);
    work[at + 3u] = shape.rows.x | (shape.rows.y << 8u);
#ifdef STAGE_SPLIT
    work[at + 4u] = shape.first.x | (shape.first.y << 8u) | (shape.first.z << 16u) | (shape.first.w << 24u);
#endif
}

// Tells the chunks whose first vertex or primitive is among those of the item.
fn mark_chunks(column: u32, item: u32, first: u32, end: u32) {
    for (var chunk = (first + CHUNK - 1u) / CHUNK; chunk * CHUNK < end; chunk++) {
        work[chunk_word(stage, column, chunk)] = item;
    }
}

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
    if item >= stage.corners + stage.edges && item < item_count(stage) {
        settle(item - stage.corners - stage.edges, share);
    }
    if item < item_count(stage) {
        let base = block_word(stage, block);
        let at = offset_word(stage, item);
        let before = sums[thread] - size;
        let vertex = work[base] + before.x;
        let primitive = work[base + 1u] + before.y;
        work[at] = vertex;
        work[at + 1u] = primitive;
        mark_chunks(0u, item, vertex, min(vertex + size.x, stage.max_vertices));
        mark_chunks(1u, item, primitive, min(primitive + size.y, stage.max_primitives));
    }
}
