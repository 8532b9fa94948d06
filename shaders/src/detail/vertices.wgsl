#define_import_path dolomite::detail::vertices

// Numbers and heights of the vertices that are drawn; the twin of Finder in
// plugins/tessellation/src/detail/mesh.rs, where the height of an arriving vertex is derived.

#import dolomite::detail::types::{APPEARS, cell_mid}
#import dolomite::detail::bindings::{cells, counts, detail, seen, COARSENING}
#import dolomite::detail::find::find_cell
#import dolomite::detail::lattice::{is_centre, is_root_corner, mid_owner, on_lattice, side_direction, vertex_ends}
#import dolomite::detail::roots::root_corner

fn coarsening() -> f32 {
    return bitcast<f32>(atomicLoad(&counts[COARSENING]));
}

fn appears() -> f32 {
    return APPEARS * coarsening();
}

// Share of the way to the ground of a vertex with this demand.
fn arrived(demand: f32) -> f32 {
    return clamp((demand / coarsening() - APPEARS) / (1.0 - APPEARS), 0.0, 1.0);
}

// Whether a quarter of a cell, by the first of them, is drawn as a cell of its own.
fn is_drawn(first: u32, quarter: u32) -> bool {
    let child = first + (quarter & 3u);
    return first != 0u && seen[child].stamp == detail.stamp && seen[child].centre > appears();
}

// Whether the middle of a side is drawn and belongs to the cell: of two cells to the one with the lesser
// coordinate.
fn owns(at: u32, centre: vec2<u32>, half: u32, side: u32) -> bool {
    let beside = centre + side_direction(side) * (2u * half);
    return seen[at].middles[side] > appears() && (side >= 2u || !on_lattice(detail, beside));
}

struct Owner {
    cell: u32,
    side: u32,
}

// Where a middle stands. `near` is any cell.
fn owner_of(near: u32, mid: vec2<u32>) -> Owner {
    let lesser = mid_owner(mid);
    if on_lattice(detail, lesser.centre) {
        return Owner(find_cell(near, lesser.centre, lesser.half), lesser.side);
    }
    let other = lesser.centre + side_direction(lesser.side) * (2u * lesser.half);
    return Owner(find_cell(near, other, lesser.half), lesser.side ^ 2u);
}

// Number of a vertex that is drawn.
fn vertex_number(near: u32, vertex: vec2<u32>) -> u32 {
    if is_root_corner(detail, vertex) {
        let place = vertex >> vec2(detail.depth + 1u);
        return place.y * (detail.roots.x + 1u) + place.x;
    }
    if is_centre(vertex) {
        return seen[find_cell(near, vertex, 1u << countTrailingZeros(vertex.x))].first;
    }
    let owner = owner_of(near, vertex);
    let half = 1u << min(countTrailingZeros(vertex.x), countTrailingZeros(vertex.y));
    let centre = vertex - side_direction(owner.side) * half;
    var number = seen[owner.cell].first + 1u;
    for (var side = 0u; side < owner.side; side++) {
        number += select(0u, 1u, owns(owner.cell, centre, half, side));
    }
    return number;
}

// A vertex as the height of others depends on it.
struct Term {
    vertex: vec2<u32>,
    weight: f32,
    // Its share of the way, and the surface where it has arrived.
    share: f32,
    surface: f32,
}

fn term(near: u32, vertex: vec2<u32>, weight: f32) -> Term {
    var share = 1.0;
    var height: f32;
    if is_root_corner(detail, vertex) {
        height = root_corner(vertex).x;
    } else if is_centre(vertex) {
        let cell = find_cell(near, vertex, 1u << countTrailingZeros(vertex.x));
        share = arrived(seen[cell].centre);
        height = cells[cell].centre.x;
    } else {
        let owner = owner_of(near, vertex);
        share = arrived(seen[owner.cell].middles[owner.side]);
        height = cell_mid(cells[owner.cell], owner.side).x;
    }
    return Term(vertex, weight, share, max(height, detail.sea));
}

// Height of the drawn surface at a vertex.
fn drawn_height(near: u32, vertex: vec2<u32>) -> f32 {
    var terms: array<Term, 4>;
    terms[0] = term(near, vertex, 1.0);
    var count = 1u;
    var since = 0.0;
    var height = 0.0;
    loop {
        var least = 0u;
        var surface = 0.0;
        for (var k = 0u; k < count; k++) {
            surface += terms[k].weight * terms[k].surface;
            if terms[k].share < terms[least].share {
                least = k;
            }
        }
        let until = max(terms[least].share, since);
        if until >= 1.0 && since == 0.0 {
            // No sum where nothing moves: the very bits of the height.
            return surface;
        }
        height += (until - since) * surface;
        if until >= 1.0 {
            break;
        }
        since = until;
        let leaving = terms[least];
        count -= 1u;
        terms[least] = terms[count];
        let ends = vertex_ends(leaving.vertex);
        for (var e = 0u; e < 2u; e++) {
            let end = select(ends.a, ends.b, e == 1u);
            var known = false;
            for (var k = 0u; k < count; k++) {
                if all(terms[k].vertex == end) {
                    terms[k].weight += 0.5 * leaving.weight;
                    known = true;
                }
            }
            // Never more than the three corners of one triangle.
            if !known && count < 4u {
                terms[count] = term(near, end, 0.5 * leaving.weight);
                count += 1u;
            }
        }
    }
    return height;
}
