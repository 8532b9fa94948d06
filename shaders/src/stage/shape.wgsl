#define_import_path dolomite::stage::shape

// How many vertices and primitives a patch has, and which vertices each primitive joins. CPU reference:
// plugins/tessellation/src/shape.rs.

#import dolomite::stage::types::{Shape, TRIANGLES, QUADS, ISOLINES, INNER, CORNER}
#import dolomite::stage::divide::divide_small
#import dolomite::stage::ruler::{Step, regular, transition}

fn corner_count(domain: u32) -> u32 {
    return select(select(4u, 3u, domain == TRIANGLES), 0u, domain == ISOLINES);
}

// Vertices off the outline; of isolines: all.
fn inner_vertices(domain: u32, shape: Shape) -> u32 {
    let a = shape.rows.x;
    if domain == TRIANGLES {
        let rings = a / 2u;
        return 3u * rings * (a - 1u - rings) + (1u - (a & 1u));
    }
    if domain == QUADS {
        return (a - 1u) * (shape.rows.y - 1u);
    }
    return shape.sides.x * (shape.sides.y + 1u);
}

// Triangles inside the strips that meet the sides.
fn grid_triangles(domain: u32, rows: vec2<u32>) -> u32 {
    if domain == TRIANGLES {
        let strips = rows.x / 2u - 1u;
        return 6u * strips * (rows.x - 2u - strips) + (rows.x & 1u);
    }
    return 2u * (rows.x - 2u) * (rows.y - 2u);
}

// Triangles, or segments of isolines.
fn primitive_count(domain: u32, shape: Shape) -> u32 {
    if domain == ISOLINES {
        return shape.sides.x * shape.sides.y;
    }
    if shape.rows.x == 1u {
        return corner_count(domain) - 2u;
    }
    let rest = shape.rows - 2u;
    var count = grid_triangles(domain, shape.rows) + shape.sides.x + shape.sides.y + shape.sides.z;
    if domain == TRIANGLES {
        return count + 3u * rest.x;
    }
    return count + shape.sides.w + 2u * rest.x + 2u * rest.y;
}

// First vertex of ring k >= 1 of a triangle with `a` inner segments.
fn ring_start(a: u32, k: u32) -> u32 {
    return 3u * (k - 1u) * (a - k);
}

// Vertex i of a side of ring k; the last one of a side is the first of the next.
fn ring_vertex(a: u32, k: u32, side: u32, i: u32) -> u32 {
    let m = a - 2u * k;
    let place = side * m + i;
    return ring_start(a, k) + select(place, 0u, place == 3u * m);
}

// The greatest k from 1 to `last` with (k - 1) (s - k) <= place: the root of that, which f32 gives to
// within 1 for s up to 64, then both neighbours are tried.
fn ring_of(s: u32, place: u32, last: u32) -> u32 {
    let square = (i32(s) - 1) * (i32(s) - 1) - 4 * i32(place);
    let root = i32(sqrt(f32(max(square, 0))));
    var k = clamp(u32(max((i32(s) + 1 - root) / 2, 1)), 1u, max(last, 1u));
    k -= select(0u, 1u, (k - 1u) * (s - k) > place);
    k += select(0u, 1u, k < last && k * (s - k - 1u) <= place);
    return k;
}

// Inner segments parallel to a side.
fn along_side(domain: u32, rows: vec2<u32>, side: u32) -> u32 {
    return select(rows.x, rows.y, domain == QUADS && (side & 1u) == 0u);
}

fn side_vertex(domain: u32, shape: Shape, side: u32, i: u32) -> vec2<u32> {
    if i == 0u {
        return vec2(CORNER, select(side, corner_count(domain), side == 0u) - 1u);
    }
    if i == shape.sides[side] {
        return vec2(CORNER, side);
    }
    return vec2(side, i);
}

// Vertex i of the outline of the inner vertices along a side.
fn row_vertex(domain: u32, rows: vec2<u32>, side: u32, i: u32) -> vec2<u32> {
    if domain == TRIANGLES {
        return vec2(INNER, ring_vertex(rows.x, 1u, side, i));
    }
    let columns = rows.x - 1u;
    let top = (rows.y - 2u) * columns;
    switch side {
        case 0u: { return vec2(INNER, top - i * columns); }
        case 1u: { return vec2(INNER, i); }
        case 2u: { return vec2(INNER, i * columns + columns - 1u); }
        default: { return vec2(INNER, top + columns - 1u - i); }
    }
}

// Triangle t of the strips that meet the sides, side 0 first.
fn side_triangle(domain: u32, shape: Shape, place: u32) -> array<vec2<u32>, 3> {
    let last = corner_count(domain) - 1u;
    var t = place;
    var side = 0u;
    var along = along_side(domain, shape.rows, 0u);
    while side < last && t >= shape.sides[side] + along - 2u {
        t -= shape.sides[side] + along - 2u;
        side++;
        along = along_side(domain, shape.rows, side);
    }
    let step = transition(shape.sides[side], along, t);
    let a = side_vertex(domain, shape, side, step.outer);
    let c = row_vertex(domain, shape.rows, side, step.inner);
    if step.advances_outer {
        return array(a, side_vertex(domain, shape, side, step.outer + 1u), c);
    }
    return array(a, row_vertex(domain, shape.rows, side, step.inner + 1u), c);
}

// Triangle t of the strips between the rings of a triangle, from the outermost inwards.
fn ring_triangle(a: u32, t: u32, count: u32) -> array<vec2<u32>, 3> {
    if (a & 1u) == 1u && t + 1u == count {
        let base = ring_start(a, a / 2u);
        return array(vec2(INNER, base), vec2(INNER, base + 1u), vec2(INNER, base + 2u));
    }
    let k = ring_of(a - 1u, divide_small(t, 6u), a / 2u - 1u);
    let m = a - 2u * k;
    let place = t - 6u * (k - 1u) * (a - 1u - k);
    let side = divide_small(place, 2u * m - 2u);
    let step = regular(m, place - side * (2u * m - 2u));
    let x = vec2(INNER, ring_vertex(a, k, side, step.outer));
    let z = vec2(INNER, ring_vertex(a, k + 1u, side, step.inner));
    if step.advances_outer {
        return array(x, vec2(INNER, ring_vertex(a, k, side, step.outer + 1u)), z);
    }
    return array(x, vec2(INNER, ring_vertex(a, k + 1u, side, step.inner + 1u)), z);
}

// Half of an inner cell of a quad, split along the diagonal that points to the middle of the patch.
fn cell_triangle(rows: vec2<u32>, t: u32) -> array<vec2<u32>, 3> {
    let cell = t / 2u;
    let j = divide_small(cell, rows.x - 2u);
    let i = cell - j * (rows.x - 2u);
    let columns = rows.x - 1u;
    let low_left = vec2(INNER, j * columns + i);
    let low_right = vec2(INNER, low_left.y + 1u);
    let top_left = vec2(INNER, low_left.y + columns);
    let top_right = vec2(INNER, top_left.y + 1u);
    let rising = (2u * (i + 1u) < rows.x) == (2u * (j + 1u) < rows.y);
    if (t & 1u) == 0u {
        if rising {
            return array(low_left, low_right, top_right);
        }
        return array(low_left, low_right, top_left);
    }
    if rising {
        return array(low_left, top_right, top_left);
    }
    return array(low_right, top_right, top_left);
}

// Two triangles beside each other inside of a patch, by inner vertices.
struct Pair {
    first: vec3<u32>,
    second: vec3<u32>,
}

// Triangles 2 pair and 2 pair + 1 of those between the rings of a triangle; the last one of an odd
// number stands alone.
fn ring_pair(a: u32, pair: u32) -> Pair {
    let last = a / 2u - 1u;
    if pair == 3u * last * (a - 2u - last) {
        let base = ring_start(a, last + 1u);
        return Pair(vec3(base, base + 1u, base + 2u), vec3(0u));
    }
    let k = ring_of(a - 1u, divide_small(pair, 3u), last);
    let m = a - 2u * k;
    let place = pair - 3u * (k - 1u) * (a - 1u - k);
    let side = select(0u, 1u, place >= m - 1u) + select(0u, 1u, place >= 2u * (m - 1u));
    let q = place - side * (m - 1u);
    let half = (m - 1u) / 2u;
    // Vertices from q on of the outer and the inner row; the last one of a ring is its first.
    let start = vec2(ring_start(a, k), ring_start(a, k + 1u));
    let row = side * vec2(m, m - 2u) + vec2(q);
    let x0 = start.x + row.x;
    let x1 = x0 + 1u;
    let x2 = select(x1 + 1u, start.x, row.x + 2u == 3u * m);
    let z0 = select(start.y + row.y, start.y, row.y == 3u * (m - 2u));
    let z1 = select(z0 + 1u, start.y, row.y + 1u == 3u * (m - 2u));
    return Pair(
        select(vec3(x1, z0, start.y + row.y - 1u), vec3(x0, x1, z0), q <= half),
        select(vec3(x1, z1, z0), vec3(x1, x2, z0), q >= half),
    );
}

// Both triangles of an inner cell of a quad, see cell_triangle.
fn cell_pair(rows: vec2<u32>, cell: u32) -> Pair {
    let j = divide_small(cell, rows.x - 2u);
    let i = cell - j * (rows.x - 2u);
    let columns = rows.x - 1u;
    let low = j * columns + i;
    let top = low + columns;
    let rising = (2u * (i + 1u) < rows.x) == (2u * (j + 1u) < rows.y);
    return Pair(
        vec3(low, low + 1u, select(top, top + 1u, rising)),
        vec3(select(low + 1u, low, rising), top + 1u, top),
    );
}

// The vertices of primitive t, counter-clockwise; a segment of isolines repeats its second.
fn primitive(domain: u32, shape: Shape, t: u32) -> array<vec2<u32>, 3> {
    if domain == ISOLINES {
        let start = t + divide_small(t, shape.sides.y);
        return array(vec2(INNER, start), vec2(INNER, start + 1u), vec2(INNER, start + 1u));
    }
    if shape.rows.x == 1u {
        return array(vec2(CORNER, t), vec2(CORNER, t + 1u), vec2(CORNER, corner_count(domain) - 1u));
    }
    let grid = grid_triangles(domain, shape.rows);
    if t >= grid {
        return side_triangle(domain, shape, t - grid);
    }
    if domain == TRIANGLES {
        return ring_triangle(shape.rows.x, t, grid);
    }
    return cell_triangle(shape.rows, t);
}
