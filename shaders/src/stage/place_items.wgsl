// Pass 4, a thread BLOCK_RUN items: what comes before each item. Where the pools do not hold all even
// at level 1, the last vertices and primitives are those that are missing.

#import dolomite::stage::api::stage
#import dolomite::stage::types::ISOLINES
#import dolomite::stage::counts::{patch_shape, work}
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::work::{BLOCK, BLOCK_RUN, COLUMNS, SHARE, block_word, inner_word, item_count, offset_word, thread_before, thread_word}

const THREADS: u32 = BLOCK / BLOCK_RUN;

var<workgroup> sums: array<vec2<u32>, 64>;

// Replaces the levels of a patch by those that count. Nobody else reads them in this pass.
fn settle(id: u32, share: u32) {
    let at = inner_word(stage, id);
    if work[at] == 0u {
        // Without segments nothing of it is emitted.
        work[at + 2u] = 0u;
        work[at + 3u] = 0u;
#ifdef STAGE_SPLIT
        work[at + 4u] = 0u;
#endif
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

// Tells the threads of emission which item or patch they work for.
fn mark_threads(column: u32, number: u32, first: u32, end: u32) {
    let last = thread_before(stage, column, number + 1u, end);
    for (var thread = thread_before(stage, column, number, first); thread < last; thread++) {
        work[thread_word(stage, column, thread)] = number;
    }
}

fn size_of(item: u32) -> vec2<u32> {
    let at = offset_word(stage, item);
    return vec2(work[at], work[at + 1u]);
}

@compute @workgroup_size(64)
fn place_items(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let block = group.x + group.y * COLUMNS;
    let first = block * BLOCK + thread * BLOCK_RUN;
    let last = min(first + BLOCK_RUN, item_count(stage));
    var own = vec2(0u);
    for (var item = first; item < last; item++) {
        own += size_of(item);
    }
    // Hillis and Steele, 1986.
    sums[thread] = own;
    for (var reach = 1u; reach < THREADS; reach <<= 1u) {
        workgroupBarrier();
        var before = vec2(0u);
        if thread >= reach {
            before = sums[thread - reach];
        }
        workgroupBarrier();
        sums[thread] += before;
    }
    if first >= last {
        return;
    }
    let base = block_word(stage, block);
    var before = vec2(work[base], work[base + 1u]) + sums[thread] - own;
    let patches = stage.corners + stage.edges;
    for (var item = first; item < last; item++) {
        let end = before + size_of(item);
        let at = offset_word(stage, item);
        work[at] = before.x;
        work[at + 1u] = before.y;
        mark_threads(0u, item, before.x, end.x);
        if item >= patches {
            mark_threads(1u, item - patches, before.y, end.y);
        }
        before = end;
    }
    let share = work[SHARE];
    for (var item = max(first, patches); item < last; item++) {
        settle(item - patches, share);
    }
}
