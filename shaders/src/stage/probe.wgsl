// For tests and the lab: whole patches from their levels, one workgroup each.

#import dolomite::stage::types::{Rules, Shape, Levels, INNER, CORNER}
#import dolomite::stage::level::{clamp_inner, clamp_outer, discarded, lift_inner, shape_from_levels}
#import dolomite::stage::shape::{corner_count, inner_vertices, primitive, primitive_count}
#import dolomite::stage::coordinate::coordinate

struct Case {
    // Bits of the levels: NaN and denormals travel unharmed.
    outer: vec4<u32>,
    inner: vec2<u32>,
    domain: u32,
    spacing: u32,
    mode: u32,
    clockwise: u32,
    // Where its vertices and primitives go.
    first_vertex: u32,
    first_primitive: u32,
}

@group(0) @binding(0) var<storage, read> cases: array<Case>;
// Vertices and primitives of each case.
@group(0) @binding(1) var<storage, read_write> counts: array<vec2<u32>>;
// In units of 2^-24.
@group(0) @binding(2) var<storage, read_write> coordinates: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read_write> primitives: array<vec4<u32>>;

// Place of a vertex among all of its patch: corners, sides, inner.
fn index_of(domain: u32, shape: Shape, vertex: vec2<u32>) -> u32 {
    if vertex.x == CORNER {
        return vertex.y;
    }
    let corners = corner_count(domain);
    let last = select(vertex.x, corners, vertex.x == INNER);
    var index = corners;
    for (var side = 0u; side < last; side++) {
        index += shape.sides[side] - 1u;
    }
    return index + select(vertex.y - 1u, vertex.y, vertex.x == INNER);
}

// The vertex at a place among all of its patch.
fn vertex_at(domain: u32, shape: Shape, place: u32) -> vec2<u32> {
    let corners = corner_count(domain);
    if place < corners {
        return vec2(CORNER, place);
    }
    var rest = place - corners;
    for (var side = 0u; side < corners; side++) {
        if rest < shape.sides[side] - 1u {
            return vec2(side, rest + 1u);
        }
        rest -= shape.sides[side] - 1u;
    }
    return vec2(INNER, rest);
}

@compute @workgroup_size(64)
fn probe(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let id = group.x + group.y * 32768u;
    if id >= arrayLength(&cases) {
        return;
    }
    let given = cases[id];
    let rules = Rules(given.domain, given.spacing, given.mode);
    if discarded(rules, given.outer) {
        if thread == 0u {
            counts[id] = vec2(0u);
        }
        return;
    }
    let outer = clamp_outer(rules, given.outer);
    let inner = lift_inner(rules, outer, clamp_inner(rules, given.inner));
    let shape = shape_from_levels(rules, outer, inner);
    var vertices = inner_vertices(rules.domain, shape);
    for (var side = 0u; side < corner_count(rules.domain); side++) {
        vertices += shape.sides[side];
    }
    let triangles = primitive_count(rules.domain, shape);
    if thread == 0u {
        counts[id] = vec2(vertices, triangles);
    }
    for (var k = thread; k < vertices; k += 64u) {
        let at = coordinate(rules, shape, vertex_at(rules.domain, shape, k));
        coordinates[given.first_vertex + k] = vec4(at, 0u);
    }
    for (var t = thread; t < triangles; t += 64u) {
        let found = primitive(rules.domain, shape, t);
        let a = index_of(rules.domain, shape, found[0]);
        let b = index_of(rules.domain, shape, found[1]);
        let c = index_of(rules.domain, shape, found[2]);
        let turned = given.clockwise == 1u && rules.domain != 2u;
        primitives[given.first_primitive + t] = vec4(a, select(b, c, turned), select(c, b, turned), 0u);
    }
}
