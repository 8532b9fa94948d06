// Draws the ground that is drawn into the map of the horizon: of each cell whose parent's cell is cut at its centre a flat
// square, nowhere above what is drawn in it, and one of it and the next cell to the east, and to the south, so that columns
// between two are hidden too. A workgroup a block.
//
// Two cells of two blocks are no pair here. There the middle of the side of a parent's cell serves: where it is there, the two
// cells beside it are cut at their centres, so that they are whole triangles; these lie nowhere below its interval.

#import dolomite::blocks::bindings::{drawn_list, heads, lists, records, seen}
#import dolomite::blocks::lowest::{NONE, lowest_of}
#import dolomite::blocks::looked::{CENTRE_BITS, looked_vertex}
#import dolomite::blocks::ratio::{BEFORE, place_before}
#import dolomite::blocks::record::{CELLS, LOWS, WINDOW, number_at}
#import dolomite::blocks::way::{Block, block_at, coarsening_now, ratio_in}
#import dolomite::detail::bindings::detail
#import dolomite::detail::lattice::on_lattice
#import dolomite::detail::square::draw_square

const GROUP: u32 = 32u;

// Which middles of sides of the parent's cells are there, by rows of corners; and which centres may be.
var<workgroup> middles: array<atomic<u32>, 17>;
var<workgroup> centres: array<atomic<u32>, 16>;
// Below what the drawn surface is nowhere in each cell, above the stage's anchor.
var<workgroup> lows: array<f32, 256>;

// The two cells of the parent's beside a middle on the block's border; its place in half cells.
fn draw_beside(block: Block, slot: u32, corner: vec2<u32>, number: u32) {
    let cell_half = heads[slot].half / CELLS;
    // One cell each way along the side, two across it; none beyond the border of the ground.
    let level = (corner.x & 2u) == 2u;
    let across = select(vec2(2u, 0u), vec2(0u, 2u), level);
    let at = heads[slot].centre - vec2(heads[slot].half) + corner * cell_half;
    let before = select(0u, 4u, on_lattice(at - across * cell_half));
    let after = select(0u, 4u, on_lattice(at + across * cell_half));
    let least = select(vec2(before, 2u), vec2(2u, before), level);
    let most = select(vec2(after, 2u), vec2(2u, after), level);
    let from_corner = corner + vec2(BEFORE);
    let low = place_before(block.frame, from_corner - least);
    let high = place_before(block.frame, from_corner + most);
    let height = bitcast<f32>(records[block.record + LOWS + number]) - detail.anchor_height;
    draw_square(vec3(low.x, height, low.y), high);
}

fn note_row(block: Block, slot: u32, thread: u32) {
    let coarsening = coarsening_now();
    let all = seen[slot].there[thread];
    atomicOr(&centres[thread >> 1u], (all & 255u) << (8u * (thread & 1u)));
    // Mixed corners are what is not a centre.
    var bits = all >> CENTRE_BITS;
    while bits != 0u {
        // In half cells.
        let corner = looked_vertex(thread, CENTRE_BITS + firstTrailingBit(bits));
        bits &= bits - 1u;
        let number = number_at(corner);
        if ratio_in(block, number, corner) <= WINDOW * coarsening {
            continue;
        }
        atomicOr(&middles[corner.y >> 1u], 1u << (corner.x >> 1u));
        if any((corner & vec2(31u)) == vec2(0u)) {
            draw_beside(block, slot, corner, number);
        }
    }
}

@compute @workgroup_size(32)
fn draw_horizon(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let slot = lists[drawn_list() + group.x];
    let block = block_at(slot);
    if thread < 17u {
        atomicStore(&middles[thread], 0u);
    }
    if thread < 16u {
        atomicStore(&centres[thread], 0u);
    }
    workgroupBarrier();
    note_row(block, slot, thread);
    workgroupBarrier();
    for (var k = thread; k < CELLS * CELLS; k += GROUP) {
        let at = vec2(k % CELLS, k / CELLS);
        // Corner of the parent's cell at its centre, and the middles of the four sides about it.
        let centre = at | vec2(1u);
        let beside = (atomicLoad(&middles[centre.y]) >> (centre.x - 1u)) & 5u;
        let above = (atomicLoad(&middles[centre.y - 1u]) | atomicLoad(&middles[centre.y + 1u])) >> centre.x;
        let is_cut = beside != 0u || (above & 1u) == 1u;
        var low = NONE;
        if is_cut {
            low = lowest_of(block.record, at, ((atomicLoad(&centres[at.y]) >> at.x) & 1u) == 1u);
        }
        lows[k] = low;
    }
    workgroupBarrier();
    for (var k = thread; k < CELLS * CELLS; k += GROUP) {
        let at = vec2(k % CELLS, k / CELLS);
        let first = BEFORE + 2u * at;
        let low = place_before(block.frame, first);
        // The cell itself, with the one to the east, with the one to the south.
        for (var more = 0u; more < 3u; more++) {
            let next = vec2(more & 1u, more >> 1u);
            let is_inside = all(at + next < vec2(CELLS));
            let other = select(k, k + next.x + CELLS * next.y, is_inside);
            let height = select(NONE, min(lows[k], lows[other]), is_inside);
            if height > NONE {
                draw_square(vec3(low.x, height, low.y), place_before(block.frame, first + 2u * (vec2(1u) + next)));
            }
        }
    }
}
