#define_import_path dolomite::vegetation::bindings

// What the passes share.

#import dolomite::geometry::vertex::{VERTEX_WORDS, unpack_normal}
#import dolomite::vegetation::types::GrowParams

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

fn corner_normal(corner: u32) -> vec3<f32> {
    return unpack_normal(vertices[indices[corner] * VERTEX_WORDS + 3u]);
}
