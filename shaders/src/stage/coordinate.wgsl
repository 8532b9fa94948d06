#define_import_path dolomite::stage::coordinate

// Where the vertices of a patch lie in its domain. CPU reference:
// plugins/tessellation/src/coordinate.rs. Coordinates are in units of 2^-24.

#import dolomite::stage::types::{Rules, Shape, UNIT, TRIANGLES, QUADS, EQUAL, D3D, INNER, CORNER}
#import dolomite::stage::divide::divide_small
#import dolomite::stage::place::{StageEdge, place, scaled, stage_edge}
#import dolomite::stage::shape::{ring_of, ring_start}

// Corners of triangles: w, u, v; of quads: (0,0), (1,0), (1,1), (0,1).
fn corner_coordinate(domain: u32, corner: u32) -> vec3<u32> {
    if domain == TRIANGLES {
        return UNIT * vec3<u32>(vec3(corner == 1u, corner == 2u, corner == 0u));
    }
    return UNIT * vec3<u32>(vec3(corner == 1u || corner == 2u, corner >= 2u, false));
}

// The point of a side at `at` along it, counter-clockwise.
fn side_coordinate(domain: u32, side: u32, at: u32) -> vec3<u32> {
    let rest = UNIT - at;
    if domain == TRIANGLES {
        switch side {
            case 0u: { return vec3(0u, rest, at); }
            case 1u: { return vec3(at, 0u, rest); }
            default: { return vec3(rest, at, 0u); }
        }
    }
    switch side {
        case 0u: { return vec3(0u, rest, 0u); }
        case 1u: { return vec3(at, 0u, 0u); }
        case 2u: { return vec3(UNIT, at, 0u); }
        default: { return vec3(rest, UNIT, 0u); }
    }
}

// A ring vertex as the 16.16 fixed-point reference rounds it: (start, end, off).
fn reference_ring(edge: StageEdge, k: u32, i: u32, side: u32) -> vec3<u32> {
    let off = ((place(edge, k, D3D) >> 8u) * 0xaaaau + 32768u) >> 16u;
    let inwards = (off + 1u) / 2u;
    let p = select(edge.count - k - i, k + i, side == 1u);
    let first = (place(edge, p, D3D) >> 8u) - inwards;
    let last = 65536u - first - off;
    return vec3(select(first, last, side == 1u), select(last, first, side == 1u), off) << vec3(8u);
}

// Vertex i of a side of ring k.
struct RingPlace {
    k: u32,
    side: u32,
    i: u32,
}

// Where inner vertex `index` of a triangle with `a` inner segments stands.
fn ring_place(a: u32, index: u32) -> RingPlace {
    let k = ring_of(a, divide_small(index, 3u), a / 2u);
    let m = a - 2u * k;
    let at = index - ring_start(a, k);
    let side = select(0u, 1u, at >= m) + select(0u, 1u, at >= 2u * m);
    return RingPlace(k, side, at - side * m);
}

// Its coordinate; `along` is the place of vertex k + i of the edge.
fn ring_at(edge: StageEdge, ring: RingPlace, along: u32, mode: u32) -> vec3<u32> {
    let k = ring.k;
    // Towards the side's start, towards its end, and its distance.
    var c: vec3<u32>;
    if mode == D3D {
        c = reference_ring(edge, k, ring.i, ring.side);
    } else {
        let corner = ring.i == 0u;
        let part = scaled(edge, k, select(1u, 2u, corner), 3u);
        c = select(vec3(UNIT - along - part, along - part, 2u * part), vec3(UNIT - 2u * part, part, part), corner);
    }
    c = select(select(c, c.yzx, ring.side == 1u), c.zxy, ring.side == 0u);
    let third = select(UNIT / 3u, 0x5555u << 8u, mode == D3D);
    return select(c, vec3(third, third, UNIT - 2u * third), 2u * k == edge.count);
}

// Inner vertex `index` of a triangle.
fn ring_coordinate(edge: StageEdge, index: u32, mode: u32) -> vec3<u32> {
    let ring = ring_place(edge.count, index);
    return ring_at(edge, ring, place(edge, ring.k + ring.i, mode), mode);
}

fn inner_coordinate(rules: Rules, shape: Shape, index: u32) -> vec3<u32> {
    if rules.domain == TRIANGLES {
        return ring_coordinate(stage_edge(shape.inner.x, rules.spacing), index, rules.mode);
    }
    if rules.domain == QUADS {
        let columns = shape.rows.x - 1u;
        let row = divide_small(index, columns);
        return vec3(
            place(stage_edge(shape.inner.x, rules.spacing), 1u + index - row * columns, rules.mode),
            place(stage_edge(shape.inner.y, rules.spacing), 1u + row, rules.mode),
            0u,
        );
    }
    let columns = shape.sides.y + 1u;
    let line = divide_small(index, columns);
    return vec3(
        place(stage_edge(shape.outer.y, rules.spacing), index - line * columns, rules.mode),
        place(stage_edge(shape.outer.x, EQUAL), line, rules.mode),
        0u,
    );
}

// Where a vertex of a patch lies; the vertex as in types.wgsl.
fn coordinate(rules: Rules, shape: Shape, vertex: vec2<u32>) -> vec3<u32> {
    if vertex.x == INNER {
        return inner_coordinate(rules, shape, vertex.y);
    }
    if vertex.x == CORNER {
        return corner_coordinate(rules.domain, vertex.y);
    }
    let edge = stage_edge(shape.outer[vertex.x], rules.spacing);
    return side_coordinate(rules.domain, vertex.x, place(edge, vertex.y, rules.mode));
}

// As numbers; exact, for they are multiples of 2^-24 up to 1.
fn as_numbers(c: vec3<u32>) -> vec3<f32> {
    return vec3<f32>(vec3<i32>(c)) * (1.0 / f32(UNIT));
}
