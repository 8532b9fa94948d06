// Pass 3, one workgroup: if the pools do not hold all, lowers every level by the same share until
// they do; then sums what comes before each block, and writes the arguments of what follows.

#import dolomite::stage::types::ISOLINES
#import dolomite::stage::api::stage
#import dolomite::stage::counts::{item_size, work}
#import dolomite::stage::rules::stage_rules
#import dolomite::geometry::head::{AMPLIFIED, INDEXED, LOWERED, PLAIN, PRIMITIVES, VERTICES, WANTED_PRIMITIVES, WANTED_VERTICES}
#import dolomite::stage::work::{BLOCK, COLUMNS, GRID_DISPATCH, LOWERINGS, SHARE, VERTEX_DISPATCH, block_word, item_count, offset_word, share_after, thread_before}

const THREADS: u32 = 256u;
// Sums stop here instead of wrapping round.
const ENOUGH: u32 = 0x7fffffffu;

var<workgroup> sums: array<vec2<u32>, 256>;

// Sum over all threads, at most ENOUGH; the same for every thread.
fn total(thread: u32, own: vec2<u32>) -> vec2<u32> {
    sums[thread] = own;
    for (var half = 128u; half > 0u; half >>= 1u) {
        workgroupBarrier();
        if thread < half {
            sums[thread] = min(sums[thread] + sums[thread + half], vec2(ENOUGH));
        }
    }
    return workgroupUniformLoad(&sums[0]);
}

// Sizes of a run of blocks with levels lowered to `share`, written for each block and item; their sum.
fn lowered_sizes(first: u32, last: u32, share: u32) -> vec2<u32> {
    let items = item_count(stage);
    var own = vec2(0u);
    for (var block = first; block < last; block++) {
        var size = vec2(0u);
        for (var item = block * BLOCK; item < min((block + 1u) * BLOCK, items); item++) {
            let own = item_size(item, share);
            let at = offset_word(stage, item);
            work[at] = own.x;
            work[at + 1u] = own.y;
            size += own;
        }
        let at = block_word(stage, block);
        work[at] = size.x;
        work[at + 1u] = size.y;
        own = min(own + size, vec2(ENOUGH));
    }
    return own;
}

fn fits(sum: vec2<u32>) -> bool {
    return sum.x <= stage.max_vertices && sum.y <= stage.max_primitives;
}

// Arguments of a dispatch with 256 threads a group.
fn write_groups(at: u32, threads: u32) {
    let groups = (threads + 255u) / 256u;
    work[at] = min(groups, COLUMNS);
    work[at + 1u] = (groups + COLUMNS - 1u) / COLUMNS;
    work[at + 2u] = 1u;
}

@compute @workgroup_size(256)
fn plan(@builtin(local_invocation_index) thread: u32) {
    let blocks = (item_count(stage) + BLOCK - 1u) / BLOCK;
    // A run of blocks for each thread.
    let run = (blocks + THREADS - 1u) / THREADS;
    let first = min(thread * run, blocks);
    let last = min(first + run, blocks);

    var own = vec2(0u);
    for (var block = first; block < last; block++) {
        let at = block_word(stage, block);
        own = min(own + vec2(work[at], work[at + 1u]), vec2(ENOUGH));
    }
    let wanted = total(thread, own);
    var sum = wanted;
    var lowered = 0u;
    if !fits(wanted) {
        // The fewest steps that fit, by halving: sizes fall with the levels. One workgroup would
        // be busy too long with more than two million items (and software Vulkan ends all loops of
        // a shader after 65536 rounds): their levels all go to the least at once.
        var low = select(1u, LOWERINGS, run > 32u);
        lowered = LOWERINGS;
        while low < lowered {
            let middle = (low + lowered) / 2u;
            sum = total(thread, lowered_sizes(first, last, share_after(middle)));
            if fits(sum) {
                lowered = middle;
            } else {
                low = middle + 1u;
            }
        }
        own = lowered_sizes(first, last, share_after(lowered));
        sum = total(thread, own);
    }

    // What comes before the thread's run: Hillis and Steele, 1986.
    sums[thread] = own;
    for (var reach = 1u; reach < THREADS; reach <<= 1u) {
        workgroupBarrier();
        var before = vec2(0u);
        if thread >= reach {
            before = sums[thread - reach];
        }
        workgroupBarrier();
        sums[thread] = min(sums[thread] + before, vec2(ENOUGH));
    }
    var before = sums[thread] - own;
    for (var block = first; block < last; block++) {
        let at = block_word(stage, block);
        let size = vec2(work[at], work[at + 1u]);
        work[at] = before.x;
        work[at + 1u] = before.y;
        before = min(before + size, vec2(ENOUGH));
    }

    if thread == 0u {
        let held = min(sum, vec2(stage.max_vertices, stage.max_primitives));
        let corners = select(3u, 2u, stage_rules().domain == ISOLINES);
        work[INDEXED] = held.y * corners;
        work[INDEXED + 1u] = 1u;
        work[PLAIN] = held.y * corners;
        work[PLAIN + 1u] = 1u;
        work[AMPLIFIED] = stage.amplified;
        work[AMPLIFIED + 1u] = held.y;
        let items = item_count(stage);
        write_groups(VERTEX_DISPATCH, thread_before(stage, 0u, items, held.x));
        write_groups(GRID_DISPATCH, thread_before(stage, 1u, stage.patches, held.y));
        let end = offset_word(stage, items);
        work[end] = held.x;
        work[end + 1u] = held.y;
        work[VERTICES] = held.x;
        work[PRIMITIVES] = held.y;
        work[LOWERED] = lowered;
        work[SHARE] = share_after(lowered);
        work[WANTED_VERTICES] = wanted.x;
        work[WANTED_PRIMITIVES] = wanted.y;
    }
}

