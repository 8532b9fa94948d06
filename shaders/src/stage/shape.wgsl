#define_import_path dolomite::stage::shape

// How many vertices and primitives a patch has, and which vertices each primitive joins: the twin of
// plugins/tessellation/src/stage/shape.rs.

#import dolomite::stage::types::{Shape, TRIANGLES, QUADS, ISOLINES, INNER, CORNER, MIDDLE}
#import dolomite::stage::divide::divide_small
#import dolomite::stage::ruler::{Step, half_strip, regular, transition}

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

// The greatest k from 1 to `last` with (k - 1) (s - k) <= place.
fn ring_of(s: u32, place: u32, last: u32) -> u32 {
    var low = 1u;
    var high = last;
    while low < high {
        let middle = (low + high + 1u) / 2u;
        if (middle - 1u) * (s - middle) <= place {
            low = middle;
        } else {
            high = middle - 1u;
        }
    }
    return low;
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
#ifdef STAGE_SPLIT
    if i == shape.first[side] {
        return vec2(MIDDLE, side);
    }
#endif
    return vec2(side, i);
}

// Step t of the strip along a side. Each half of a split side has its half of the inner row.
fn side_step(shape: Shape, side: u32, along: u32, t: u32) -> Step {
    let total = shape.sides[side];
#ifdef STAGE_SPLIT
    let first = shape.first[side];
    if first > 0u {
        let row = along - 2u;
        let half = row / 2u;
        if t < first + half {
            return half_strip(first, half, t);
        }
        let step = half_strip(total - first, row - half, t - first - half);
        return Step(step.outer + first, step.inner + half, step.advances_outer);
    }
#endif
    return transition(total, along, t);
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
    let step = side_step(shape, side, along, t);
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
