#define_import_path dolomite::detail::stock

// Which cells are in use: what the views of a ground have in common beside cells and links. Blocks are four
// cells; those that were dropped are taken again first.

#import dolomite::detail::types::NO_CELL
#import dolomite::detail::bindings::detail

struct Stock {
    // Cells below this number are in use, or free.
    used: atomic<u32>,
    // Blocks that are free.
    free: atomic<i32>,
    pad_a: u32,
    pad_b: u32,
    // First cells of the free ones.
    blocks: array<u32>,
}

@group(1) @binding(2) var<storage, read_write> stock: Stock;

// First cell of a block that nothing uses; NO_CELL where there is none. Nothing is put back in the pass that
// takes: once none is left, none comes until its end.
fn take_block() -> u32 {
    let free = atomicSub(&stock.free, 1);
    if free > 0 {
        return stock.blocks[free - 1];
    }
    atomicAdd(&stock.free, 1);
    let first = atomicAdd(&stock.used, 4u);
    if first + 4u > detail.capacity {
        return NO_CELL;
    }
    return first;
}

fn put_back(first: u32) {
    stock.blocks[atomicAdd(&stock.free, 1)] = first;
}

// Cells in use. One thread, after all have taken what they need.
fn cells_in_use() -> u32 {
    let used = min(atomicLoad(&stock.used), detail.capacity);
    // What did not fit was not taken.
    atomicStore(&stock.used, used);
    return used - 4u * u32(max(atomicLoad(&stock.free), 0));
}
