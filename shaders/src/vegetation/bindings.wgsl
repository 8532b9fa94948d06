#define_import_path dolomite::vegetation::bindings

// What the passes share.

#import dolomite::geometry::vertex::{VERTEX_WORDS, unpack_normal}
#import dolomite::vegetation::types::GrowParams

// A corner so near to the height of the sea lies on its surface, metres: f32's steps a kilometre from the anchor, and some.
const SURFACE: f32 = 0.002;

@group(0) @binding(0) var<uniform> params: GrowParams;
@group(0) @binding(1) var<storage, read> vertices: array<u32>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;
// The head of the ground's work buffer.
@group(0) @binding(3) var<storage, read> head: array<u32>;
@group(0) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;
// Two words each: the first corner of a triangle among the indices; layer, ring, tile.
@group(0) @binding(5) var<storage, read_write> pieces: array<vec2<u32>>;

fn corner_position(corner: u32) -> vec3<f32> {
    let at = indices[corner] * VERTEX_WORDS;
    return bitcast<vec3<f32>>(vec3(vertices[at], vertices[at + 1u], vertices[at + 2u]));
}

// Height of the ground at a corner that is drawn at some height: below a surface of water that of its bed.
fn corner_bed(corner: u32, height: f32) -> f32 {
    let depth = unpack2x16snorm(vertices[indices[corner] * VERTEX_WORDS + 4u]).x * params.depth_range;
    let is_water = depth > 0.0 && abs(height + params.layers[0].above) < SURFACE;
    return height - select(0.0, depth, is_water);
}

fn corner_normal(corner: u32) -> vec3<f32> {
    return unpack_normal(vertices[indices[corner] * VERTEX_WORDS + 3u]);
}
