// Finds the blocks that an edit makes others, from the roots down, a round at a time: first those roots that it reaches; then,
// below the blocks of the round before, the quarters that it reaches or that cut by what has become another are to be made anew,
// and those that only copy it to be refreshed. What has been found waits in two lists, and a round takes the next of both:
// parents come before their children, and nothing is looked at but quarters of what became another. One workgroup. CPU reference:
// KeptBlocks::change in plugins/ground/src/blocks/remade.rs.

#import dolomite::blocks::bindings::{LOST, MOST_MADE, MOST_REFRESHED, REFRESHED, REFRESHES, REMADE, ROUND, SLOPES, STALE, WAITING, heads, lists, lost_list, made_list, numbers, refresh_list, waiting_list}
#import dolomite::blocks::edited::is_edited
#import dolomite::blocks::gate::can_be_made
#import dolomite::blocks::record::NO_BLOCK
#import dolomite::detail::bindings::{counts, detail}

// As in fit.wgsl.
@group(1) @binding(1) var<storage, read_write> arguments: array<u32>;

const GROUP: u32 = 64u;

var<workgroup> waiting: atomic<u32>;
var<workgroup> stale: atomic<u32>;
var<workgroup> lost: atomic<u32>;

fn wait(slot: u32) {
    lists[waiting_list() + atomicAdd(&waiting, 1u)] = slot;
}

// What follows for the quarters of a block that was made anew or refreshed.
fn spread_from(slot: u32) {
    let others = heads[slot].others;
    let children = heads[slot].children;
    for (var quarter = 0u; quarter < 4u; quarter++) {
        let child = children[quarter];
        if child == NO_BLOCK {
            continue;
        }
        let centre = heads[child].centre;
        let half = heads[child].half;
        let is_cut = ((others >> (4u + quarter)) & 1u) == 1u;
        if !(is_cut || is_edited(centre, half)) {
            if ((others >> quarter) & 1u) == 1u {
                lists[refresh_list() + atomicAdd(&stale, 1u)] = child;
            }
        } else if can_be_made(centre, half) {
            wait(child);
        } else {
            // What it stood on has gone: it comes back with that.
            heads[slot].children[quarter] = NO_BLOCK;
            lists[lost_list() + atomicAdd(&lost, 1u)] = child;
        }
    }
}

@compute @workgroup_size(64)
fn spread_edits(@builtin(local_invocation_index) thread: u32) {
    let before = atomicLoad(&counts[WAITING]);
    let remade = atomicLoad(&counts[REMADE]);
    let round = atomicLoad(&counts[ROUND]);
    let refreshed = atomicLoad(&counts[REFRESHED]);
    let refreshes = atomicLoad(&counts[REFRESHES]);
    if thread == 0u {
        atomicStore(&waiting, before);
        atomicStore(&stale, atomicLoad(&counts[STALE]));
        atomicStore(&lost, atomicLoad(&counts[LOST]));
    }
    workgroupBarrier();
    // Roots have the slots after the first, and are as many as are made in a round at most.
    let root = thread + 1u;
    if before == 0u && thread < detail.roots.x * detail.roots.y && is_edited(heads[root].centre, heads[root].half) {
        wait(root);
    }
    if thread < round {
        spread_from(lists[made_list() + thread]);
    }
    for (var k = thread; k < refreshes; k += GROUP) {
        spread_from(lists[refresh_list() + refreshed - refreshes + k]);
    }
    storageBarrier();
    workgroupBarrier();
    let found = atomicLoad(&waiting);
    let allowed = max(numbers.remade, detail.roots.x * detail.roots.y);
    let next = min(min(found, allowed) - remade, MOST_MADE);
    if thread < next {
        lists[made_list() + thread] = lists[waiting_list() + remade + thread];
    }
    let all_stale = atomicLoad(&stale);
    let next_stale = min(all_stale - refreshed, MOST_REFRESHED);
    atomicStore(&counts[SLOPES + thread], 0u);
    if thread == 0u {
        atomicStore(&counts[WAITING], found);
        atomicStore(&counts[REMADE], remade + next);
        atomicStore(&counts[ROUND], next);
        atomicStore(&counts[STALE], all_stale);
        atomicStore(&counts[REFRESHED], refreshed + next_stale);
        atomicStore(&counts[REFRESHES], next_stale);
        atomicStore(&counts[LOST], atomicLoad(&lost));
        // 32 x 64 fours of samples; 9 x 64 vertices, all of them new in a root.
        arguments[3] = 32u;
        arguments[4] = next;
        arguments[5] = 1u;
        arguments[6] = 9u;
        arguments[7] = next;
        arguments[8] = 1u;
        arguments[9] = next;
        arguments[10] = 1u;
        arguments[11] = 1u;
        arguments[21] = next_stale;
        arguments[22] = 1u;
        arguments[23] = 1u;
    }
}
