// Draws what is known of the ground into the map of the horizon: where the middle of a side of a parent's cell is there, the
// two cells beside it are cut at their centres, so that they are whole triangles; these lie nowhere below the interval of
// that middle. A workgroup a block, half a row of cells a thread.

#import dolomite::blocks::bindings::{drawn_list, heads, lists, records, seen}
#import dolomite::blocks::looked::{CENTRE_BITS, looked_vertex}
#import dolomite::blocks::ratio::{BEFORE, place_before}
#import dolomite::blocks::record::{LOWS, WINDOW, number_at}
#import dolomite::blocks::way::{block_at, coarsening_now, ratio_in}
#import dolomite::detail::bindings::detail
#import dolomite::detail::lattice::on_lattice
#import dolomite::detail::square::draw_square

@compute @workgroup_size(32)
fn draw_horizon(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let slot = lists[drawn_list() + group.x];
    let block = block_at(slot);
    let coarsening = coarsening_now();
    let cell_half = heads[slot].half / 16u;
    let corner_of = heads[slot].centre - vec2(heads[slot].half);
    // Mixed corners are what is not a centre.
    var bits = seen[slot].there[thread] >> CENTRE_BITS;
    while bits != 0u {
        // In half cells.
        let corner = looked_vertex(thread, CENTRE_BITS + firstTrailingBit(bits));
        bits &= bits - 1u;
        let number = number_at(corner);
        if ratio_in(block, number, corner) <= WINDOW * coarsening {
            continue;
        }
        // One cell each way along the side, two across it; none beyond the border of the ground.
        let level = (corner.x & 2u) == 2u;
        let across = select(vec2(2u, 0u), vec2(0u, 2u), level);
        let at = corner_of + corner * cell_half;
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
}
