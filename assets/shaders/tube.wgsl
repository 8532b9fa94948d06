// Tubes along Catmull-Rom curves: isolines of four control points, each segment amplified to a prism.
// Control point: position, radius. Entity parameter 0.x: material.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, entity_params, in_view, patch_point, stage_position}
#import dolomite::geometry::amplify_types::StoredVertex

// Position and radius between control points 1 and 2 (Catmull and Rom 1974, uniform, tension 1/2).
fn curve(input: Patch, t: f32) -> vec4<f32> {
    let a = patch_point(input, 0u, 0u);
    let b = patch_point(input, 1u, 0u);
    let c = patch_point(input, 2u, 0u);
    let d = patch_point(input, 3u, 0u);
    return b + 0.5 * t * ((c - a) + t * ((2.0 * a - 5.0 * b + 4.0 * c - d) + t * (3.0 * (b - c) + d - a)));
}

fn tangent(input: Patch, t: f32) -> vec3<f32> {
    let a = patch_point(input, 0u, 0u).xyz;
    let b = patch_point(input, 1u, 0u).xyz;
    let c = patch_point(input, 2u, 0u).xyz;
    let d = patch_point(input, 3u, 0u).xyz;
    return 0.5 * ((c - a) + t * (2.0 * (2.0 * a - 5.0 * b + 4.0 * c - d) + 3.0 * t * (3.0 * (b - c) + d - a)));
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let a = stage_position(input, curve(input, 0.0).xyz);
    let b = stage_position(input, curve(input, 0.5).xyz);
    let c = stage_position(input, curve(input, 1.0).xyz);
    let reach = distance(a, b) + distance(b, c);
    if !in_view(view, b, reach) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    // A straight piece needs one segment, a bend as many as its pixels ask for.
    let bend = 1.0 - dot(normalize(b - a), normalize(c - b));
    let wanted = edge_level(view, a, b) + edge_level(view, b, c);
    return PatchLevels(vec4(1.0, 1.0 + wanted * min(12.0 * bend, 1.0), 1.0, 1.0), vec2(1.0));
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let p = curve(input, at.x);
    var vertex: Vertex;
    vertex.position = p.xyz;
    // The direction of the tube stands where the normal does; amplify turns it into a ring.
    vertex.normal = tangent(input, at.x);
    vertex.uv = vec2(p.w, at.x);
    vertex.previous = p.xyz;
    vertex.material = u32(entity_params(input, 0u).x);
    return vertex;
}

const SIDES: u32 = 12u;

// Corner `k` of the ring around a vertex of the line.
fn ring(v: StoredVertex, k: u32) -> StoredVertex {
    // Any axis that the direction does not follow; the lines of lamp posts lie in planes across z.
    let across = normalize(cross(v.normal, vec3(0.1, 0.05, 1.0)));
    let up = cross(across, v.normal);
    let angle = 6.2831853 * f32(k % SIDES) / f32(SIDES);
    let out = across * cos(angle) + up * sin(angle);
    return StoredVertex(v.position + out * v.uv.x, out, vec2(f32(k) / f32(SIDES), v.uv.y), v.previous + out * v.uv.x, v.material);
}

// Twelve sides of two triangles.
fn amplify(a: StoredVertex, b: StoredVertex, c: StoredVertex, number: u32) -> StoredVertex {
    let side = number / 6u;
    let corner = number % 6u;
    // Corners in the order (a, k), (b, k), (b, k + 1), (a, k), (b, k + 1), (a, k + 1).
    let far = corner == 1u || corner == 2u || corner == 4u;
    let next = corner == 2u || corner == 4u || corner == 5u;
    let k = side + select(0u, 1u, next);
    if far {
        return ring(b, k);
    }
    return ring(a, k);
}
