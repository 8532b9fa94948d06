#define_import_path dolomite::blocks::way

// A block that is drawn, and how far its vertices are on their way to the ground.

#import dolomite::blocks::bindings::{COARSENING, heads, record_at, records, seen}
#import dolomite::blocks::ratio::{Frame, frame_of, vertex_ratio}
#import dolomite::blocks::record::{ERRORS, HIGHS, LOWS, NO_BLOCK, WINDOW, block_quarter, vertex_at}
#import dolomite::detail::bindings::{counts, detail}

struct Block {
    record: u32,
    quarter: u32,
    frame: Frame,
}

fn block_at(slot: u32) -> Block {
    let centre = heads[slot].centre;
    let half = heads[slot].half;
    return Block(record_at(slot), block_quarter(centre, half), frame_of(centre, half));
}

fn coarsening_now() -> f32 {
    return bitcast<f32>(atomicLoad(&counts[COARSENING]));
}

// The error ratio of a vertex, its place in half cells.
fn ratio_in(block: Block, number: u32, at: vec2<u32>) -> f32 {
    let error = bitcast<f32>(records[block.record + ERRORS + number]);
    let low = bitcast<f32>(records[block.record + LOWS + number]);
    let high = bitcast<f32>(records[block.record + HIGHS + number]);
    return vertex_ratio(block.frame, at, error, low, high);
}

// The way of a vertex to the ground, 0 where it is not there.
fn way_of(block: Block, number: u32, coarsening: f32) -> f32 {
    let at = vertex_at(number);
    let ratio = ratio_in(block, number, at);
    let way = clamp((ratio / coarsening - WINDOW) / (1.0 - WINDOW), 1e-6, 1.0);
    let is_corner = all((at & vec2(31u)) == vec2(0u));
    return select(select(0.0, way, ratio > WINDOW * coarsening), 1.0, is_corner);
}

// Bits of the quarters that are drawn as blocks of their own.
fn find_children(children: vec4<u32>, coarsening: f32) -> u32 {
    var bits = 0u;
    for (var k = 0u; k < 4u; k++) {
        let child = children[k];
        let known = child != NO_BLOCK && seen[child].stamp == detail.stamp;
        let mixed = select(0.0, bitcast<f32>(atomicLoad(&seen[child].mixed)), known);
        bits |= select(0u, 1u << k, mixed > WINDOW * coarsening);
    }
    return bits;
}
