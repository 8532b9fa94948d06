#define_import_path dolomite::blocks::leaves

// Which cells of a block are drawn, of its vertices one by one: see cells.wgsl, which does it by rows.

#import dolomite::blocks::record::quarter_at

// The way of each vertex to the ground, 0 where it is not there.
var<workgroup> share: array<f32, 545>;

fn corner_number(at: vec2<u32>) -> u32 {
    return at.y * 17u + at.x;
}

fn is_there(number: u32) -> bool {
    return share[number] > 0.0;
}

// Whether a cell of a size below the block's is drawn as a cell, not by what holds it.
fn exists(cell: vec2<u32>, size: u32) -> bool {
    let odd = (cell | vec2(1u)) * size;
    let even = (cell + (cell & vec2(1u))) * size;
    return is_there(corner_number(vec2(odd.x, even.y))) && is_there(corner_number(vec2(even.x, odd.y)));
}

fn drawn_by_child(children: u32, cell: vec2<u32>, size: u32) -> bool {
    return ((children >> quarter_at((cell * size) >> vec2(3u))) & 1u) == 1u;
}
