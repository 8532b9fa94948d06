// Bicubic Bezier patches of 16 control points (Bezier 1968; Farin, Curves and Surfaces, 5th ed., 2002).
// Entity parameter 0.x: material.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, entity_params, in_view, patch_point, stage_position}

// Length of a side's control polygon in wanted edges: never less than its curve.
fn side_level(input: Patch, view: StageView, a: u32, b: u32, c: u32, d: u32) -> f32 {
    let p = stage_position(input, patch_point(input, a, 0u).xyz);
    let q = stage_position(input, patch_point(input, b, 0u).xyz);
    let r = stage_position(input, patch_point(input, c, 0u).xyz);
    let s = stage_position(input, patch_point(input, d, 0u).xyz);
    // The outer terms first: the same sum in both directions.
    return (edge_level(view, p, q) + edge_level(view, r, s)) + edge_level(view, q, r);
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    var low = vec3(1e30);
    var high = vec3(-1e30);
    for (var k = 0u; k < 16u; k++) {
        let p = stage_position(input, patch_point(input, k, 0u).xyz);
        low = min(low, p);
        high = max(high, p);
    }
    if !in_view(view, (low + high) * 0.5, distance(low, high) * 0.5) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    let u0 = side_level(input, view, 0u, 4u, 8u, 12u);
    let v0 = side_level(input, view, 0u, 1u, 2u, 3u);
    let u1 = side_level(input, view, 3u, 7u, 11u, 15u);
    let v1 = side_level(input, view, 12u, 13u, 14u, 15u);
    let across = side_level(input, view, 4u, 5u, 6u, 7u);
    let up = side_level(input, view, 1u, 5u, 9u, 13u);
    // A side that has shrunk to a point keeps one segment.
    let outer = max(vec4(u0, v0, u1, v1), vec4(1.0));
    return PatchLevels(outer, vec2(max(across, max(v0, v1)), max(up, max(u0, u1))));
}

// Bernstein polynomials of degree 3 and 2.
fn cubic(t: f32) -> vec4<f32> {
    let s = 1.0 - t;
    return vec4(s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t);
}

fn row(input: Patch, j: u32, b: vec4<f32>) -> vec3<f32> {
    return patch_point(input, j, 0u).xyz * b.x + patch_point(input, j + 1u, 0u).xyz * b.y
        + patch_point(input, j + 2u, 0u).xyz * b.z + patch_point(input, j + 3u, 0u).xyz * b.w;
}

fn slope(t: f32) -> vec4<f32> {
    let s = 1.0 - t;
    return 3.0 * vec4(-s * s, s * s - 2.0 * s * t, 2.0 * s * t - t * t, t * t);
}

fn surface(input: Patch, u: vec4<f32>, v: vec4<f32>) -> vec3<f32> {
    return row(input, 0u, u) * v.x + row(input, 4u, u) * v.y + row(input, 8u, u) * v.z + row(input, 12u, u) * v.w;
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    var vertex: Vertex;
    vertex.position = surface(input, cubic(at.x), cubic(at.y));
    // Where a side has shrunk to a point the normal is that of a place a little inside.
    let inside = clamp(at.xy, vec2(0.002), vec2(0.998));
    let along_u = surface(input, slope(inside.x), cubic(inside.y));
    let along_v = surface(input, cubic(inside.x), slope(inside.y));
    vertex.normal = cross(along_u, along_v);
    vertex.uv = at.xy;
    vertex.previous = vertex.position;
    vertex.material = u32(entity_params(input, 0u).x);
    return vertex;
}
