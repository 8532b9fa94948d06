// Drops what an edit makes another and no round has made anew or refreshed, with all that is finer: it is made when a view wishes
// for it. One workgroup, a level of the tree after the other.

#import dolomite::blocks::bindings::{LOST, REFRESHED, REFRESHES, REMADE, ROUND, STALE, WAITING, heads, lists, lost_list, refresh_list, remade_word, waiting_list}
#import dolomite::blocks::record::NO_BLOCK
#import dolomite::blocks::stock::stock
#import dolomite::detail::bindings::counts

const GROUP: u32 = 64u;
// More than there are of the finest blocks in a root and upwards: a lattice is halved 24 times at most.
const LEVELS: u32 = 25u;

var<workgroup> lost: atomic<u32>;

fn lose(slot: u32) {
    lists[lost_list() + atomicAdd(&lost, 1u)] = slot;
}

fn take_from_parent(slot: u32) {
    let parent = heads[slot].parent;
    for (var k = 0u; k < 4u; k++) {
        if heads[parent].children[k] == slot {
            heads[parent].children[k] = NO_BLOCK;
        }
    }
}

fn free_slot(slot: u32) {
    let children = heads[slot].children;
    for (var k = 0u; k < 4u; k++) {
        if children[k] != NO_BLOCK {
            lose(children[k]);
        }
    }
    heads[slot].half = 0u;
    stock.slots[atomicAdd(&stock.free, 1u)] = slot;
}

@compute @workgroup_size(64)
fn drop_edited(@builtin(local_invocation_index) thread: u32) {
    // The last that were found have not been made: there was no round after them.
    let remade = atomicLoad(&counts[REMADE]) - atomicLoad(&counts[ROUND]);
    let waiting = atomicLoad(&counts[WAITING]);
    let refreshed = atomicLoad(&counts[REFRESHED]) - atomicLoad(&counts[REFRESHES]);
    let stale = atomicLoad(&counts[STALE]);
    if thread == 0u {
        atomicStore(&lost, atomicLoad(&counts[LOST]));
    }
    workgroupBarrier();
    // Roots do not wait: they were first.
    for (var k = remade + thread; k < waiting; k += GROUP) {
        let slot = lists[waiting_list() + k];
        take_from_parent(slot);
        lose(slot);
    }
    for (var k = refreshed + thread; k < stale; k += GROUP) {
        let slot = lists[refresh_list() + k];
        take_from_parent(slot);
        lose(slot);
    }
    var begin = 0u;
    for (var level = 0u; level < LEVELS; level++) {
        storageBarrier();
        workgroupBarrier();
        let end = atomicLoad(&lost);
        workgroupBarrier();
        for (var k = begin + thread; k < end; k += GROUP) {
            free_slot(lists[lost_list() + k]);
        }
        begin = end;
    }
    if thread == 0u {
        lists[remade_word()] = remade;
        lists[remade_word() + 1u] = begin;
        lists[remade_word() + 2u] = refreshed;
    }
}
