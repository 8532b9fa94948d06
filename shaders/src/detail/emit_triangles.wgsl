// Triangles of all cells that are drawn and may be seen, and of roots that stay two: what the camera sees
// from the front of the list, what shadows need of the others from its back. A thread a cell.

#import dolomite::detail::bindings::{counts, detail, links, seen, GROUP, KEPT, OTHERS, TRIANGLES, kept_cell, root_count}
#import dolomite::detail::horizon::{OCCLUDED, Mapped, is_behind, map_place}
#import dolomite::detail::cull::{CULL, KEEP_OTHERS, Drawn, draw_at, is_hidden}
#import dolomite::detail::lattice::{cell_half, cell_quarter}
#import dolomite::detail::vertices::{appears, corner_of, is_drawn, middle_of, vertex_number}
#import dolomite::geometry::vertex::VERTEX_WORDS

@group(1) @binding(0) var<storage, read> vertices: array<u32>;
@group(1) @binding(1) var<storage, read_write> indices: array<u32>;

// A corner of triangles.
struct Corner {
    number: u32,
    drawn: Drawn,
    mapped: Mapped,
}

fn corner(number: u32) -> Corner {
    let base = VERTEX_WORDS * number;
    let place = bitcast<vec3<f32>>(vec3(vertices[base], vertices[base + 1u], vertices[base + 2u]));
    return Corner(number, draw_at(place), map_place(place));
}

fn store(place: u32, a: u32, b: u32, c: u32) {
    if place < detail.max_triangles {
        indices[3u * place] = a;
        indices[3u * place + 1u] = b;
        indices[3u * place + 2u] = c;
    }
}

fn is_left_out(a: Corner, b: Corner, c: Corner) -> bool {
    if (detail.flags & CULL) != 0u && is_hidden(a.drawn, b.drawn, c.drawn) {
        return true;
    }
    return (detail.flags & OCCLUDED) != 0u && is_behind(a.mapped, b.mapped, c.mapped);
}

fn emit(a: Corner, b: Corner, c: Corner) {
    if is_left_out(a, b, c) {
        if (detail.flags & KEEP_OTHERS) != 0u {
            // From the back; what is before the first wraps, and is not stored.
            store(detail.max_triangles - 1u - atomicAdd(&counts[OTHERS], 1u), a.number, b.number, c.number);
        }
        return;
    }
    store(atomicAdd(&counts[TRIANGLES], 1u), a.number, b.number, c.number);
}

fn whole_root(at: u32) {
    let centre = links[at].centre;
    let outer = cell_quarter(centre, cell_half(centre));
    var corners: array<Corner, 4>;
    for (var k = 0u; k < 4u; k++) {
        corners[k] = corner(vertex_number(corner_of(at, outer + k)));
    }
    emit(corners[2], corners[1], corners[0]);
    emit(corners[0], corners[3], corners[2]);
}

// Round the cell, from corner 3 by the sides' middles back to it.
fn drawn_cell(at: u32) {
    let children = links[at].children;
    let middle = corner(seen[at].first);
    var before = corner(vertex_number(corner_of(at, 3u)));
    for (var side = 0u; side < 4u; side++) {
        let after = corner(vertex_number(corner_of(at, side)));
        let halved = seen[at].middles[side] > appears();
        var mid = before;
        if halved {
            mid = corner(vertex_number(middle_of(at, side)));
        }
        // Each half of the side belongs to a quarter of the cell.
        if !halved || !is_drawn(children, side) {
            emit(middle, after, mid);
        }
        if halved && !is_drawn(children, side + 3u) {
            emit(middle, mid, before);
        }
        before = after;
    }
}

@compute @workgroup_size(64)
fn emit_triangles(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let threads = groups.x * GROUP;
    for (var at = id.x; at < root_count(); at += threads) {
        if seen[at].seen != 0u && seen[at].centre <= appears() {
            whole_root(at);
        }
    }
    let last = atomicLoad(&counts[KEPT]);
    for (var k = id.x; k < last; k += threads) {
        let at = kept_cell(k);
        if seen[at].seen != 0u && seen[at].centre > appears() {
            drawn_cell(at);
        }
    }
}
