#define_import_path dolomite::tessellation::pattern

// The triangles of one quad patch from the levels of its edges: the twin of
// plugins/tessellation/src/pattern.rs, integer for integer. A patch has an inner grid of a x b
// segments; strips join it to its four sides, walking both polylines in the order of their
// segments' midpoints (merge path: Green, McColl, Bader 2012).

#import dolomite::tessellation::types::MAX_LEVEL

// Segments of the two edges of a side; y is 0 where it has one edge.
fn side_level(side: vec2<u32>) -> u32 {
    return side.x + side.y;
}

// Inner segments along x and z; (1, 1) only where every side has one segment.
fn inner_levels(levels: vec4<u32>) -> vec2<u32> {
    if all(levels == vec4(1u)) {
        return vec2(1u);
    }
    return clamp(vec2(max(levels.x, levels.y), max(levels.z, levels.w)), vec2(2u), vec2(MAX_LEVEL));
}

fn inner_vertices(inner: vec2<u32>) -> u32 {
    return (inner.x - 1u) * (inner.y - 1u);
}

// levels: segments of the four sides.
fn triangle_count(levels: vec4<u32>, inner: vec2<u32>) -> u32 {
    if inner.x == 1u {
        return 2u;
    }
    let rest = inner - 2u;
    return 2u * rest.x * rest.y + 2u * rest.x + 2u * rest.y + levels.x + levels.y + levels.z + levels.w;
}

// Midpoint of segment i along the side, numerator and denominator.
fn side_midpoint(side: vec2<u32>, i: u32) -> vec2<u32> {
    if side.y == 0u {
        return vec2(2u * i + 1u, 2u * side.x);
    }
    if i < side.x {
        return vec2(2u * i + 1u, 4u * side.x);
    }
    return vec2(2u * side.y + 2u * (i - side.x) + 1u, 4u * side.y);
}

// Whether midpoint i of the side comes before midpoint j of the inner polyline.
fn outer_first(side: vec2<u32>, i: u32, j: u32, along: u32) -> bool {
    let m = side_midpoint(side, i);
    return m.x * 2u * along <= (2u * j + 3u) * m.y;
}

// A vertex of a patch: x = 4 for inner grid vertex (y, z), else x = side and y = place along it.
const INNER: u32 = 4u;

fn strip_inner(s: u32, inner: vec2<u32>, k: u32) -> vec3<u32> {
    switch s {
        case 0u: { return vec3(INNER, 1u + k, 1u); }
        case 1u: { return vec3(INNER, 1u + k, inner.y - 1u); }
        case 2u: { return vec3(INNER, 1u, 1u + k); }
        default: { return vec3(INNER, inner.x - 1u, 1u + k); }
    }
}

// Triangle t of the strip along side s, counter-clockwise seen from +Y; columns are vertices.
fn strip_triangle(s: u32, side: vec2<u32>, inner: vec2<u32>, t: u32) -> array<vec3<u32>, 3> {
    let along = select(inner.y, inner.x, s < 2u);
    let outer_count = side_level(side);
    let inner_count = along - 2u;
    var low = select(0u, t - inner_count, t > inner_count);
    var high = min(t, outer_count);
    while low < high {
        let middle = (low + high) / 2u;
        if outer_first(side, middle, t - 1u - middle, along) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    let i = low;
    let j = t - low;
    var take_outer = j >= inner_count;
    if !take_outer && i < outer_count {
        take_outer = outer_first(side, i, j, along);
    }
    let p = vec3(s, i, 0u);
    let q = strip_inner(s, inner, j);
    var r = vec3(s, i + 1u, 0u);
    if !take_outer {
        r = strip_inner(s, inner, j + 1u);
    }
    // Sides 1 and 2 are mirror images of sides 0 and 3.
    if s == 1u || s == 2u {
        return array(p, r, q);
    }
    return array(p, q, r);
}

// Triangle t of a patch: the inner grid first, then the strips of sides 0 to 3.
fn patch_triangle(sides: array<vec2<u32>, 4>, inner: vec2<u32>, t: u32) -> array<vec3<u32>, 3> {
    if inner.x == 1u {
        if t == 0u {
            return array(vec3(0u, 0u, 0u), vec3(1u, 0u, 0u), vec3(0u, 1u, 0u));
        }
        return array(vec3(0u, 1u, 0u), vec3(1u, 0u, 0u), vec3(1u, 1u, 0u));
    }
    let rest = inner - 2u;
    let grid = 2u * rest.x * rest.y;
    if t < grid {
        let cell = t / 2u;
        let i = 1u + cell % rest.x;
        let j = 1u + cell / rest.x;
        if t % 2u == 0u {
            return array(vec3(INNER, i, j), vec3(INNER, i, j + 1u), vec3(INNER, i + 1u, j));
        }
        return array(vec3(INNER, i + 1u, j), vec3(INNER, i, j + 1u), vec3(INNER, i + 1u, j + 1u));
    }
    var place = t - grid;
    let count0 = side_level(sides[0]) + rest.x;
    if place < count0 {
        return strip_triangle(0u, sides[0], inner, place);
    }
    place -= count0;
    let count1 = side_level(sides[1]) + rest.x;
    if place < count1 {
        return strip_triangle(1u, sides[1], inner, place);
    }
    place -= count1;
    let count2 = side_level(sides[2]) + rest.y;
    if place < count2 {
        return strip_triangle(2u, sides[2], inner, place);
    }
    return strip_triangle(3u, sides[3], inner, place - count2);
}
