#define_import_path dolomite::blocks::raised

// Where vertices are drawn on their way to the ground. CPU reference: placed in plugins/ground/src/blocks/mesh.rs.

#import dolomite::blocks::bindings::records
#import dolomite::blocks::record::{GRADIENTS, HEIGHTS, number_at, quarter_at, unpack_gradient, vertex_at}
#import dolomite::blocks::way::Block
#import dolomite::detail::bindings::detail

// The ends of the edge that a vertex cuts, in half cells. Not of corners of the block.
fn ends_of(at: vec2<u32>, quarter: u32) -> array<vec2<u32>, 2> {
    let tx = countTrailingZeros(at.x | 32u);
    let tz = countTrailingZeros(at.y | 32u);
    let least = min(tx, tz);
    let half = 1u << least;
    let above = select(quarter_at(at >> vec2(least + 1u)), quarter, half == 16u);
    // As unsigned numbers that wrap.
    let across = select(0u - half, half, (above & 1u) == 0u);
    let step = select(select(vec2(0u, half), vec2(half, 0u), tx < tz), vec2(half, across), tx == tz);
    return array(at - step, at + step);
}

// Height of the bed and gradient as they are drawn.
fn drawn_ground(block: Block, number: u32, way: f32) -> vec4<f32> {
    let own = ground_at(block, number);
    if way >= 1.0 {
        return own;
    }
    let ends = ends_of(vertex_at(number), block.quarter);
    let before = 0.5 * (ground_at(block, number_at(ends[0])) + ground_at(block, number_at(ends[1])));
    return mix(before, own, way);
}

// Height of the drawn surface, of the bed, and gradient.
fn ground_at(block: Block, number: u32) -> vec4<f32> {
    let bed = bitcast<f32>(records[block.record + HEIGHTS + number]);
    return vec4(max(bed, detail.sea), bed, unpack_gradient(records[block.record + GRADIENTS + number]));
}

// Height of the drawn surface alone, as drawn_ground has it.
fn drawn_height(block: Block, number: u32, way: f32) -> f32 {
    let own = surface_at(block, number);
    if way >= 1.0 {
        return own;
    }
    let ends = ends_of(vertex_at(number), block.quarter);
    let before = 0.5 * (surface_at(block, number_at(ends[0])) + surface_at(block, number_at(ends[1])));
    return mix(before, own, way);
}

fn surface_at(block: Block, number: u32) -> f32 {
    return max(bitcast<f32>(records[block.record + HEIGHTS + number]), detail.sea);
}
