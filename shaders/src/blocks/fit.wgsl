// Decides by what error ratios are divided, so that what appears has room and nothing depends on a block that has not been
// made; which blocks are drawn; and which are made, the largest error ratios first. One workgroup.

#import dolomite::blocks::bindings::{CANDIDATES, COARSENING, CURVE, DRAWN, LEFT, MADE, MISSING, WISHES, candidate_list, done_word, drawn_list, heads, lists, made_list, near_list, numbers, seen}
#import dolomite::blocks::counting::{COARSENINGS, coarsening_of}
#import dolomite::blocks::record::{BlockHead, LEAST_HALF, NEST, NO_BLOCK, WINDOW}
#import dolomite::blocks::beside::is_beside
#import dolomite::blocks::gate::can_be_made
#import dolomite::blocks::ratio::frame_of
#import dolomite::blocks::stock::stock
#import dolomite::detail::bindings::{counts, detail}
#import dolomite::detail::horizon::OCCLUDED
#import dolomite::detail::lattice::cell_corner

const GROUP: u32 = 256u;
const WISH_BINS: u32 = 64u;
// From this share of the tolerance on a centre wishes for its quarter's block: before it can be drawn.
const AHEAD: f32 = 0.9;
// Vertices of a block that an older one may have drawn as well: on its border, and one.
const SHARED: u32 = 33u;
// Older corners of a root, and its triangles where nothing is finer.
const ROOT_CORNERS: u32 = 145u;
const ROOT_TRIANGLES: u32 = 512u;

@group(1) @binding(0) var<storage, read_write> looked: array<u32>;
// Three words each: of blocks that are drawn; of the three passes that make; of groups of 64 that are drawn; of blocks that
// are shown, which a later pass counts; of blocks beside the eye.
@group(1) @binding(1) var<storage, read_write> arguments: array<u32>;

struct Plan {
    coarsening: f32,
    // The least error ratio that is worth a block, and its bin; how many of that bin are made.
    least: f32,
    bin: u32,
    of_bin: u32,
    free: u32,
    used: u32,
}

var<workgroup> appear: array<atomic<u32>, 16>;
// Blocks by the last coarsening at which they are drawn.
var<workgroup> blocks: array<atomic<u32>, 16>;
var<workgroup> wishes: array<atomic<u32>, 64>;
var<workgroup> missing: atomic<u32>;
var<workgroup> left: atomic<u32>;
var<workgroup> plan: Plan;
var<workgroup> of_bin: atomic<u32>;
var<workgroup> taken: atomic<u32>;
var<workgroup> drawn: atomic<u32>;
var<workgroup> near: atomic<u32>;

fn wish_bin(ratio: f32) -> u32 {
    return u32(clamp(2.0 * log2(ratio / WINDOW), 0.0, f32(WISH_BINS - 1u)));
}

// The error ratio of the centres of a quarter that has not been made and can be; else 0.
fn wish_of(head: BlockHead, slot: u32, quarter: u32) -> f32 {
    let ratio = bitcast<f32>(atomicLoad(&seen[slot].centres[quarter]));
    return select(0.0, ratio, head.half > LEAST_HALF && head.children[quarter] == NO_BLOCK);
}

// Whether what a block stands on is there.
fn has_samples(head: BlockHead, quarter: u32) -> bool {
    let half = head.half / 2u;
    return can_be_made(cell_corner(head.centre, half, quarter), half);
}

fn count(slot: u32) {
    let head = heads[slot];
    for (var k = 0u; k < COARSENINGS / 2u; k++) {
        let word = atomicLoad(&seen[slot].appear[k]);
        if word != 0u {
            atomicAdd(&appear[2u * k], word & 0xffffu);
            atomicAdd(&appear[2u * k + 1u], word >> 16u);
        }
    }
    let mixed = bitcast<f32>(atomicLoad(&seen[slot].mixed));
    var last = COARSENINGS;
    for (var k = 0u; k < COARSENINGS; k++) {
        last = select(last, k, mixed > WINDOW * coarsening_of(k));
    }
    if last < COARSENINGS {
        atomicAdd(&blocks[last], 1u);
    }
    for (var quarter = 0u; quarter < 4u; quarter++) {
        if head.half <= LEAST_HALF {
            // What is finer errs by so much of it at most.
            atomicMax(&left, bitcast<u32>(NEST * bitcast<f32>(atomicLoad(&seen[slot].centres[quarter]))));
        }
        let wish = wish_of(head, slot, quarter);
        if wish >= AHEAD {
            atomicMax(&missing, bitcast<u32>(wish));
            if has_samples(head, quarter) {
                atomicAdd(&wishes[wish_bin(wish)], 1u);
            }
        }
    }
}

fn plan_all() -> Plan {
    let roots = detail.roots.x * detail.roots.y;
    var coarsening = exp2(40.0);
    // From the coarsest on, as long as all has room.
    var drawn_blocks = 0u;
    for (var k = COARSENINGS; k > 0u; k--) {
        drawn_blocks += atomicLoad(&blocks[k - 1u]);
        let own = atomicLoad(&appear[k - 1u]);
        let vertices = own + SHARED * drawn_blocks + ROOT_CORNERS * roots;
        let triangles = 2u * own + ROOT_TRIANGLES * roots;
        if vertices > detail.max_vertices || triangles > detail.max_triangles {
            break;
        }
        coarsening = coarsening_of(k - 1u);
    }
    let least = AHEAD * coarsening;
    let room = atomicLoad(&stock.free) + detail.capacity - min(stock.used, detail.capacity);
    let allowed = min(numbers.budget, room);
    // The first bin of which not all have room.
    var bin = WISH_BINS;
    var before = 0u;
    while bin > 0u {
        let more = atomicLoad(&wishes[bin - 1u]);
        if before + more > allowed {
            break;
        }
        before += more;
        bin--;
    }
    let unmade = bitcast<f32>(atomicLoad(&missing)) * 1.000001;
    // Bins below the one are left out; of `bin - 1` some are made.
    return Plan(max(coarsening, unmade), least, bin, allowed - before, atomicLoad(&stock.free), stock.used);
}

fn take(slot: u32, quarter: u32) {
    let number = atomicAdd(&taken, 1u);
    var child = plan.used + number - plan.free;
    if number < plan.free {
        child = stock.slots[plan.free - 1u - number];
    }
    let half = heads[slot].half / 2u;
    heads[child] = BlockHead(
        cell_corner(heads[slot].centre, half, quarter),
        half,
        slot,
        vec4(NO_BLOCK),
        detail.stamp,
        0.0,
        0.0,
        0.0,
        0u,
        0u,
        0u,
        0u,
    );
    heads[slot].children[quarter] = child;
    lists[made_list() + number] = child;
}

fn decide(slot: u32) {
    let mixed = bitcast<f32>(atomicLoad(&seen[slot].mixed));
    if mixed > WINDOW * plan.coarsening {
        lists[drawn_list() + atomicAdd(&drawn, 1u)] = slot;
        if (detail.flags & OCCLUDED) != 0u && is_beside(frame_of(heads[slot].centre, heads[slot].half), vec2(0u), vec2(32u)) {
            lists[near_list() + atomicAdd(&near, 1u)] = slot;
        }
    }
    let head = heads[slot];
    for (var quarter = 0u; quarter < 4u; quarter++) {
        let child = head.children[quarter];
        if child != NO_BLOCK && bitcast<f32>(atomicLoad(&seen[slot].centres[quarter])) >= plan.least {
            // It would be wished for if it were not there: it is not to be dropped.
            heads[child].looked = detail.stamp;
        }
        let wish = wish_of(head, slot, quarter);
        if wish < plan.least || !has_samples(head, quarter) {
            continue;
        }
        let bin = wish_bin(wish);
        if bin >= plan.bin || (bin + 1u == plan.bin && atomicAdd(&of_bin, 1u) < plan.of_bin) {
            take(slot, quarter);
        }
    }
}

fn close(candidates: u32) {
    let made = atomicLoad(&taken);
    let reused = min(made, plan.free);
    atomicStore(&stock.free, plan.free - reused);
    stock.used = plan.used + made - reused;
    arguments[0] = atomicLoad(&drawn);
    arguments[1] = 1u;
    arguments[2] = 1u;
    // 32 x 64 fours of samples, 7 x 64 vertices.
    arguments[3] = 32u;
    arguments[4] = made;
    arguments[5] = 1u;
    arguments[6] = 7u;
    arguments[7] = made;
    arguments[8] = 1u;
    arguments[9] = made;
    arguments[10] = 1u;
    arguments[11] = 1u;
    arguments[12] = (atomicLoad(&drawn) + 63u) / 64u;
    arguments[13] = 1u;
    arguments[14] = 1u;
    arguments[15] = 0u;
    arguments[16] = 1u;
    arguments[17] = 1u;
    arguments[18] = atomicLoad(&near);
    arguments[19] = 1u;
    arguments[20] = 1u;
    var wished = 0u;
    for (var k = 0u; k < WISH_BINS; k++) {
        wished += atomicLoad(&wishes[k]);
    }
    lists[done_word()] = select(0u, 1u, made == 0u);
    atomicStore(&counts[COARSENING], bitcast<u32>(plan.coarsening));
    atomicStore(&counts[LEFT], atomicLoad(&left));
    atomicStore(&counts[CANDIDATES], candidates);
    atomicStore(&counts[DRAWN], atomicLoad(&drawn));
    atomicStore(&counts[MADE], made);
    atomicStore(&counts[WISHES], wished - made);
    atomicStore(&counts[MISSING], atomicLoad(&missing));
    for (var k = 0u; k < COARSENINGS; k++) {
        atomicStore(&counts[CURVE + k], atomicLoad(&appear[k]));
    }
}

@compute @workgroup_size(256)
fn fit(@builtin(local_invocation_index) thread: u32) {
    if thread < COARSENINGS {
        atomicStore(&appear[thread], 0u);
        atomicStore(&blocks[thread], 0u);
    }
    if thread < WISH_BINS {
        atomicStore(&wishes[thread], 0u);
    }
    if thread == 0u {
        atomicStore(&missing, 0u);
        atomicStore(&left, 0u);
        atomicStore(&of_bin, 0u);
        atomicStore(&taken, 0u);
        atomicStore(&drawn, 0u);
        atomicStore(&near, 0u);
    }
    workgroupBarrier();
    let candidates = looked[0];
    for (var at = thread; at < candidates; at += GROUP) {
        count(lists[candidate_list() + at]);
    }
    workgroupBarrier();
    if thread == 0u {
        plan = plan_all();
    }
    workgroupBarrier();
    for (var at = thread; at < candidates; at += GROUP) {
        decide(lists[candidate_list() + at]);
    }
    workgroupBarrier();
    if thread == 0u {
        close(candidates);
    }
}
