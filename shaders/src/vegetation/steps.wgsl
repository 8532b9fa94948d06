// What is counted between the passes, one thread each: how many workgroups, whether all fits, what is drawn.

#import dolomite::geometry::head::{INDEXED, OTHERS}
#import dolomite::vegetation::bindings::{counts, params, head}
#import dolomite::vegetation::types::{CUT, DIVIDES, DRAWS, GROWS, GROWS_AGAIN, LISTS, LOOKED, PIECES, RECORDS, SHADOWS, SHADOW_LISTS, STANDING, WANTED, WANTED_PIECES}

@group(1) @binding(0) var<storage, read_write> arguments: array<u32>;

// Workgroups in a row of a dispatch.
const ROW: u32 = 32768u;

fn room_of(list: u32) -> u32 {
    return params.rooms[list >> 2u][list & 3u];
}

fn set_groups(at: u32, groups: u32) {
    arguments[at] = min(groups, ROW);
    arguments[at + 1u] = (groups + ROW - 1u) / ROW;
    arguments[at + 2u] = 1u;
}

// Before all: everything counts from 0.
@compute @workgroup_size(1)
fn plan() {
    set_groups(DIVIDES, (head[INDEXED] / 3u + head[OTHERS] / 3u + 63u) / 64u);
    for (var k = 0u; k <= WANTED_PIECES; k++) {
        atomicStore(&counts[k], 0u);
    }
    atomicStore(&counts[CUT], bitcast<u32>(1.0));
}

// Before what grows.
@compute @workgroup_size(1)
fn ready() {
    let wanted = atomicLoad(&counts[PIECES]);
    atomicStore(&counts[WANTED_PIECES], wanted);
    set_groups(GROWS, (min(wanted, params.piece_room) + 3u) / 4u);
}

// Behind it: where the pool is too small, the share that fits, by rank, and all grows once more. Ranks are spread
// evenly; three standard deviations are left for those that are not.
@compute @workgroup_size(1)
fn thin() {
    var cut = 1.0;
    var wanted = 0u;
    for (var list = 0u; list < LISTS; list++) {
        let count = atomicLoad(&counts[RECORDS + list]);
        let room = f32(room_of(list));
        wanted += count;
        if count > room_of(list) {
            cut = min(cut, max(room - 3.0 * sqrt(room), 0.0) / f32(count));
        }
    }
    atomicStore(&counts[WANTED], wanted);
    atomicStore(&counts[CUT], bitcast<u32>(cut));
    var groups = 0u;
    if cut < 1.0 {
        groups = (min(atomicLoad(&counts[PIECES]), params.piece_room) + 3u) / 4u;
        for (var list = 0u; list < LISTS; list++) {
            atomicStore(&counts[RECORDS + list], 0u);
        }
        atomicStore(&counts[LOOKED], 0u);
        atomicStore(&counts[STANDING], 0u);
    }
    set_groups(GROWS_AGAIN, groups);
}

fn set_draw(at: u32, vertices: u32, instances: u32) {
    arguments[at] = vertices;
    arguments[at + 1u] = instances;
    arguments[at + 2u] = 0u;
    arguments[at + 3u] = 0u;
}

// Arguments of the draws: vertices of a plant, records. Shadow maps take three vertices of each blade.
@compute @workgroup_size(1)
fn finish() {
    for (var list = 0u; list < LISTS; list++) {
        let count = min(atomicLoad(&counts[RECORDS + list]), room_of(list));
        set_draw(DRAWS + 4u * list, params.vertices[list >> 2u][list & 3u], count);
        if list < SHADOW_LISTS {
            set_draw(SHADOWS + 4u * list, 3u, count);
        }
    }
}
