//! Where the vertices of a patch lie in its domain. The CPU reference of
//! `shaders/src/stage/coordinate.wgsl`.
//!
//! Inner vertices of a triangle lie on rings: ring k is the triangle on which each barycentric
//! coordinate is at least ⅔ p(k), where p(k) is the place of vertex k along an edge of the inner
//! level; the vertices of a ring's side are those of the edge, moved inwards at a right angle
//! (OpenGL 4.6 core, 11.2.2.2). With m = ⅔ p(k) the vertex above place p has, besides m, the
//! coordinates p − m / 2 and 1 − p − m / 2.

use super::place::{Edge, UNIT};
use super::shape::{Shape, VertexRef, ring_of, ring_start};
use super::{Domain, Mode, Spacing};

/// Coordinates (u, v, w) in units of 2⁻²⁴.
pub type Coordinate = [u32; 3];

/// Where a vertex of a patch lies.
#[must_use]
pub fn coordinate(shape: &Shape, vertex: VertexRef, mode: Mode) -> Coordinate {
    match vertex {
        VertexRef::Corner(corner) => corner_coordinate(shape.domain, corner),
        VertexRef::Side(side, i) => {
            let s = side as usize;
            let (first, edge) = (shape.first[s], Edge::new(shape.outer[s], shape.spacing));
            // Of a split side each half has a place of its own, rounded down to the unit; the patches
            // along the halves own its vertices and evaluate them.
            let place = if first == 0 {
                edge.place(i, mode)
            } else if i < first {
                edge.place(i, mode) / 2
            } else {
                let second = Edge::new(shape.second[s], shape.spacing);
                (UNIT + second.place(i - first, mode)) / 2
            };
            side_coordinate(shape.domain, side, place)
        }
        VertexRef::Middle(side) => side_coordinate(shape.domain, side, UNIT / 2),
        VertexRef::Inner(index) => match shape.domain {
            Domain::Triangles => {
                ring_coordinate(Edge::new(shape.inner[0], shape.spacing), index, mode)
            }
            Domain::Quads => {
                let columns = shape.rows[0] - 1;
                let (i, j) = (1 + index % columns, 1 + index / columns);
                [
                    Edge::new(shape.inner[0], shape.spacing).place(i, mode),
                    Edge::new(shape.inner[1], shape.spacing).place(j, mode),
                    0,
                ]
            }
            Domain::Isolines => {
                let columns = shape.sides[1] + 1;
                let (i, line) = (index % columns, index / columns);
                [
                    Edge::new(shape.outer[1], shape.spacing).place(i, mode),
                    Edge::new(shape.outer[0], Spacing::Equal).place(line, mode),
                    0,
                ]
            }
        },
    }
}

/// Corner 0 to 2 of triangles: w, u, v; corner 0 to 3 of quads: (0,0), (1,0), (1,1), (0,1).
#[must_use]
pub const fn corner_coordinate(domain: Domain, corner: u32) -> Coordinate {
    match (domain, corner) {
        (Domain::Triangles, 0) => [0, 0, UNIT],
        (_, 0) => [0, 0, 0],
        (_, 1) => [UNIT, 0, 0],
        (Domain::Triangles, _) | (_, 3) => [0, UNIT, 0],
        _ => [UNIT, UNIT, 0],
    }
}

/// The point of a side at `place` along it, counter-clockwise.
#[must_use]
pub const fn side_coordinate(domain: Domain, side: u32, place: u32) -> Coordinate {
    let rest = UNIT - place;
    match (domain, side) {
        (Domain::Triangles, 0) => [0, rest, place],
        (Domain::Triangles, 1) => [place, 0, rest],
        (Domain::Triangles, _) => [rest, place, 0],
        (_, 0) => [0, rest, 0],
        (_, 1) => [place, 0, 0],
        (_, 2) => [UNIT, place, 0],
        _ => [rest, UNIT, 0],
    }
}

/// Inner vertex `index` of a triangle.
fn ring_coordinate(edge: Edge, index: u32, mode: Mode) -> Coordinate {
    let a = edge.segments;
    let k = ring_of(a, index / 3, a / 2);
    if a == 2 * k {
        return match mode {
            Mode::Exact => [UNIT / 3, UNIT / 3, UNIT - 2 * (UNIT / 3)],
            Mode::D3d => [0x5555 << 8, 0x5555 << 8, UNIT - (0xaaaa << 8)],
        };
    }
    let m = a - 2 * k;
    let place = index - ring_start(a, k);
    let (side, i) = (place / m, place % m);
    // On side s the coordinate towards its start falls, that towards its end rises, the third is
    // the distance of the side.
    let [start, end, off] = match mode {
        Mode::Exact if i == 0 => {
            let corner = edge.scaled(k, 2, 3);
            [UNIT - 2 * corner, corner, corner]
        }
        Mode::Exact => {
            let third = edge.scaled(k, 1, 3);
            let along = edge.place(k + i, mode);
            [UNIT - along - third, along - third, 2 * third]
        }
        Mode::D3d => reference_ring(edge, k, i, side),
    };
    match side {
        0 => [off, start, end],
        1 => [end, off, start],
        _ => [start, end, off],
    }
}

/// A ring vertex as the 16.16 fixed-point reference rounds it: ⅔ is 0xaaaa, half of the distance is
/// rounded up, and the coordinate of v on side 0 and of u on sides 1 and 2 is the one that is
/// computed first.
fn reference_ring(edge: Edge, k: u32, i: u32, side: u32) -> [u32; 3] {
    let one = 1 << 16;
    let off = ((edge.place(k, Mode::D3d) >> 8) * 0xaaaa + (1 << 15)) >> 16;
    let inwards = off.div_ceil(2);
    let place = if side == 1 {
        k + i
    } else {
        edge.segments - k - i
    };
    let first = (edge.place(place, Mode::D3d) >> 8) - inwards;
    let last = one - first - off;
    let both = if side == 1 {
        [last, first]
    } else {
        [first, last]
    };
    [both[0] << 8, both[1] << 8, off << 8]
}
