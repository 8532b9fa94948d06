// Error ratios of the centres of one depth; cells that are drawn have their quarters looked at next, which
// are made where they are new. A thread a cell. Also counts the workgroups of the passes to come.

#import dolomite::detail::types::{Link, APPEARS, NO_CELL}
#import dolomite::detail::bindings::{cells, counts, detail, detail_pass, links, lists, seen, ARGUMENTS, GROUP, KEPT, LEFT, LOOK, LOOK_ARGUMENTS, MAKE, MOST_GROUPS, WITHOUT_ROOM, blocks_before, look_block}
#import dolomite::detail::lattice::{cell_corner, cell_half}
#import dolomite::detail::stock::take_block

// Arguments of the dispatches of the next depth, and of those that close the choice: what a dispatch reads
// its own from cannot be written in it, so that the depths take turns between two buffers.
@group(1) @binding(0) var<storage, read_write> next: array<atomic<u32>>;
@group(1) @binding(1) var<storage, read_write> closing: array<atomic<u32>>;

// Its own error ratio, and what the cells around it need.
fn error_ratio_of(at: u32) -> f32 {
    var error_ratio = seen[at].whole;
    for (var side = 0u; side < 4u; side++) {
        let there = seen[at].beside[side];
        if there != NO_CELL {
            error_ratio = max(error_ratio, max(seen[there].sides[(side + 2u) & 3u], seen[there].finer));
        }
        let across = seen[at].across[side];
        if across != NO_CELL {
            error_ratio = max(error_ratio, seen[across].finer);
        }
    }
    return error_ratio;
}

// Whether the ground of a cell was edited since a choice looked at its quarters.
fn is_edited(centre: vec2<u32>, half: u32, looked: u32) -> bool {
    var edited = false;
    for (var k = 0u; k < detail.edited_count; k++) {
        let rect = detail.edited[k];
        let meets = all(centre + vec2(half) >= rect.low) && all(centre <= rect.high + vec2(half));
        edited = edited || (meets && looked <= rect.stamp);
    }
    return edited;
}

// Has a block of the next depth made.
fn want_made(first: u32) {
    let before = blocks_before(MAKE, detail_pass.depth + 1u);
    let place = atomicAdd(&counts[MAKE + detail_pass.depth + 1u], 1u);
    lists[detail.capacity / 2u - 1u - before - place] = first;
    // A workgroup a block.
    atomicMax(&next[ARGUMENTS * (detail_pass.depth + 1u)], min(place + 1u, MOST_GROUPS));
}

// The first of the cell's quarters; 0 where there is no room.
fn quarters_of(at: u32, centre: vec2<u32>, half: u32) -> u32 {
    let known = links[at].children;
    if known != 0u {
        if detail.edited_count > 0u && is_edited(centre, half, cells[known].looked) {
            want_made(known);
        }
        return known;
    }
    let first = take_block();
    if first == NO_CELL {
        return 0u;
    }
    for (var k = 0u; k < 4u; k++) {
        links[first + k] = Link(cell_corner(centre, half / 2u, k), at, 0u);
    }
    links[at].children = first;
    want_made(first);
    return first;
}

@compute @workgroup_size(64)
fn keep_cells(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let depth = detail_pass.depth;
    let first = blocks_before(LOOK, depth);
    let blocks = atomicLoad(&counts[LOOK + depth]);
    for (var k = id.x; k < 4u * blocks; k += groups.x * GROUP) {
        let at = look_block(first + k / 4u) + (k & 3u);
        let centre = links[at].centre;
        if centre.x == 0u {
            continue;
        }
        let error_ratio = error_ratio_of(at);
        if error_ratio <= APPEARS {
            continue;
        }
        seen[at].centre = error_ratio;
        let number = atomicAdd(&counts[KEPT], 1u);
        lists[detail.capacity / 2u + number] = at;
        atomicMax(&closing[0], min(number / GROUP + 1u, MOST_GROUPS));
        let half = cell_half(centre);
        if half == 1u {
            atomicMax(&counts[LEFT], bitcast<u32>(seen[at].finer));
            continue;
        }
        let children = quarters_of(at, centre, half);
        if children == 0u {
            atomicMax(&counts[WITHOUT_ROOM], bitcast<u32>(error_ratio));
            continue;
        }
        let place = atomicAdd(&counts[LOOK + depth + 1u], 1u);
        lists[first + blocks + place] = children;
        atomicMax(&next[ARGUMENTS * (depth + 1u) + LOOK_ARGUMENTS], min(4u * place / GROUP + 1u, MOST_GROUPS));
    }
}
