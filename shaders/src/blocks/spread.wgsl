// Finds the blocks that an edit makes others, from the roots down, a round at a time: first those roots that it reaches; then, of
// the blocks that were made anew in the round before, the quarters that it reaches, and all quarters of those that have become
// others. What has been found waits in one list, and the next of it are made: parents come before their children, and no more
// is looked at than is made. One workgroup; a thread a block of the round before. CPU reference: KeptBlocks::change in
// plugins/ground/src/blocks/changed.rs.

#import dolomite::blocks::bindings::{DIFFERS, LOST, MOST_MADE, REMADE, ROUND, WAITING, heads, lists, lost_list, made_list, numbers, waiting_list}
#import dolomite::blocks::edited::is_edited
#import dolomite::blocks::gate::can_be_made
#import dolomite::blocks::record::NO_BLOCK
#import dolomite::detail::bindings::{counts, detail}

// As in fit.wgsl.
@group(1) @binding(1) var<storage, read_write> arguments: array<u32>;

var<workgroup> waiting: atomic<u32>;
var<workgroup> lost: atomic<u32>;

fn wait(slot: u32) {
    lists[waiting_list() + atomicAdd(&waiting, 1u)] = slot;
}

@compute @workgroup_size(64)
fn spread_edits(@builtin(local_invocation_index) thread: u32) {
    let before = atomicLoad(&counts[WAITING]);
    let done = atomicLoad(&counts[REMADE]);
    let round = atomicLoad(&counts[ROUND]);
    if thread == 0u {
        atomicStore(&waiting, before);
        atomicStore(&lost, atomicLoad(&counts[LOST]));
    }
    workgroupBarrier();
    if before == 0u {
        // Roots have the slots after the first, and are as many as are made in a round at most.
        let root = thread + 1u;
        if thread < detail.roots.x * detail.roots.y && is_edited(heads[root].centre, heads[root].half) {
            wait(root);
        }
    } else if thread < round {
        let slot = lists[made_list() + thread];
        let differs = atomicLoad(&counts[DIFFERS + thread]) != 0u;
        let children = heads[slot].children;
        for (var quarter = 0u; quarter < 4u; quarter++) {
            let child = children[quarter];
            if child == NO_BLOCK {
                continue;
            }
            let centre = heads[child].centre;
            let half = heads[child].half;
            if !(differs || is_edited(centre, half)) {
                continue;
            }
            if can_be_made(centre, half) {
                wait(child);
            } else {
                // What it stood on has gone: it comes back with that.
                heads[slot].children[quarter] = NO_BLOCK;
                lists[lost_list() + atomicAdd(&lost, 1u)] = child;
            }
        }
    }
    storageBarrier();
    workgroupBarrier();
    let found = atomicLoad(&waiting);
    let allowed = max(numbers.remade, detail.roots.x * detail.roots.y);
    let next = min(min(found, allowed) - done, MOST_MADE);
    if thread < next {
        lists[made_list() + thread] = lists[waiting_list() + done + thread];
    }
    atomicStore(&counts[DIFFERS + thread], 0u);
    if thread == 0u {
        atomicStore(&counts[WAITING], found);
        atomicStore(&counts[REMADE], done + next);
        atomicStore(&counts[ROUND], next);
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
    }
}
