#define_import_path dolomite::geometry::once

// What is kept of a surface between its draw and the pass that shades it once a pixel, and where that pass finds it
// again. CPU reference: plugins/geometry/src/once.rs.
//
// Triangles of a picture within a pixel of the truth cover few pixels each, and a device shades them in squares of 2 × 2
// (software: 4 × 2): most of what is shaded then is thrown away. So draws keep four words a pixel, and what is seen at
// last is shaded in one triangle over the picture.
//
// Depth is reversed: 0 is the far end, which nothing that was drawn has.

#import dolomite::geometry::vertex::octahedral

// Depth; normal, 16 bits a coordinate; uv over its range; material and, from bit 8 on, the producer.
fn pack_surface(depth: f32, normal: vec3<f32>, uv: vec2<f32>, material: u32, producer: u32) -> vec4<u32> {
    return vec4(bitcast<u32>(depth), pack2x16snorm(octahedral(normal)), pack2x16snorm(uv), min(material, 255u) | (producer << 8u));
}

// Whether it is a surface of this producer; nothing was drawn where all words are 0.
fn is_of(kept: vec4<u32>, producer: u32) -> bool {
    return kept.x != 0u && kept.w >> 8u == producer;
}

fn unpack_surface_normal(word: u32) -> vec3<f32> {
    let p = unpack2x16snorm(word);
    let z = 1.0 - abs(p.x) - abs(p.y);
    let folded = (1.0 - abs(p.yx)) * select(vec2(-1.0), vec2(1.0), p >= vec2(0.0));
    let n = select(folded, p, z >= 0.0);
    return normalize(vec3(n.x, n.y, z));
}

// The planes of places that are drawn in a column and in a row of the picture and at a depth, and the one whose distance
// is w of clip space: a place p is on a plane where dot(plane, vec4(p, 1)) = 0.
struct Rows {
    column: vec4<f32>,
    row: vec4<f32>,
    depth: vec4<f32>,
    w: vec4<f32>,
}

// `at`: place in the picture, -1 to 1, y up.
fn clip_rows(clip_from_anchor: mat4x4<f32>, at: vec2<f32>, depth: f32) -> Rows {
    let rows = transpose(clip_from_anchor);
    return Rows(rows[0] - at.x * rows[3], rows[1] - at.y * rows[3], rows[2] - depth * rows[3], rows[3]);
}

// Where the three planes meet (Cramer's rule).
fn place_at(rows: Rows) -> vec3<f32> {
    let across = cross(rows.row.xyz, rows.depth.xyz);
    let sum = rows.column.w * across + rows.row.w * cross(rows.depth.xyz, rows.column.xyz) + rows.depth.w * cross(rows.column.xyz, rows.row.xyz);
    return -sum / dot(rows.column.xyz, across);
}

// What a pixel spans on a surface.
struct Footprint {
    dx: vec3<f32>,
    dy: vec3<f32>,
}

// Least cosine between a surface's normal and the way to the eye that counts: below it a pixel spans what it would at
// that angle. Normals of vertices may face away where the triangle does not.
const LEAST_COSINE: f32 = 0.05;

// Along the surface with this normal through a place: the derivatives of the place, with a row and a column held. `size`
// is that of the picture, pixels.
fn footprint(rows: Rows, place: vec3<f32>, normal: vec3<f32>, size: vec2<f32>) -> Footprint {
    // The planes of column and row meet in the way of the light.
    let way = cross(rows.column.xyz, rows.row.xyz);
    let facing = dot(normal, way);
    let least = LEAST_COSINE * length(way);
    let scale = dot(rows.w, vec4(place, 1.0)) * 2.0 / select(min(facing, -least), max(facing, least), facing >= 0.0);
    return Footprint(cross(rows.row.xyz, normal) * (scale / size.x), cross(rows.column.xyz, normal) * (scale / size.y));
}
