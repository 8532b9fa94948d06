// Triangles of all cells that are drawn and may be seen, and of roots that stay two. A thread a cell.

#import dolomite::detail::bindings::{counts, detail, links, seen, LOOK, THREADS, TRIANGLES, blocks_before, look_block}
#import dolomite::detail::lattice::{cell_corner, cell_half, cell_quarter, cell_side_mid}
#import dolomite::detail::vertices::{appears, is_drawn, vertex_number}

@group(1) @binding(1) var<storage, read_write> indices: array<u32>;

fn store(number: u32, a: u32, b: u32, c: u32) {
    if number < detail.max_triangles {
        indices[3u * number] = a;
        indices[3u * number + 1u] = b;
        indices[3u * number + 2u] = c;
    }
}

fn whole_root(at: u32, centre: vec2<u32>, half: u32) {
    let outer = cell_quarter(centre, half);
    var corners: array<u32, 4>;
    for (var k = 0u; k < 4u; k++) {
        corners[k] = vertex_number(at, cell_corner(centre, half, outer + k));
    }
    let number = atomicAdd(&counts[TRIANGLES], 2u);
    store(number, corners[2], corners[1], corners[0]);
    store(number + 1u, corners[0], corners[3], corners[2]);
}

fn drawn_cell(at: u32, centre: vec2<u32>, half: u32) {
    let children = links[at].children;
    var middles: array<bool, 4>;
    var own: array<bool, 4>;
    var triangles = 0u;
    for (var side = 0u; side < 4u; side++) {
        middles[side] = seen[at].middles[side] > appears();
        own[side] = is_drawn(children, side);
    }
    for (var side = 0u; side < 4u; side++) {
        triangles += select(1u, select(1u, 0u, own[side]) + select(1u, 0u, own[(side + 3u) & 3u]), middles[side]);
    }
    if triangles == 0u {
        return;
    }
    var number = atomicAdd(&counts[TRIANGLES], triangles);
    let middle = seen[at].first;
    for (var side = 0u; side < 4u; side++) {
        let here = own[side];
        let there = own[(side + 3u) & 3u];
        if middles[side] && here && there {
            continue;
        }
        var after = 0u;
        var before = 0u;
        if !middles[side] || !here {
            after = vertex_number(at, cell_corner(centre, half, side));
        }
        if !middles[side] || !there {
            before = vertex_number(at, cell_corner(centre, half, side + 3u));
        }
        if !middles[side] {
            store(number, middle, after, before);
            number += 1u;
            continue;
        }
        let mid = vertex_number(at, cell_side_mid(centre, half, side));
        if !here {
            store(number, middle, after, mid);
            number += 1u;
        }
        if !there {
            store(number, middle, mid, before);
            number += 1u;
        }
    }
}

@compute @workgroup_size(64)
fn emit_triangles(@builtin(global_invocation_id) id: vec3<u32>) {
    let last = 4u * blocks_before(LOOK, detail.depth + 1u);
    for (var k = id.x; k < last; k += THREADS) {
        let at = look_block(k / 4u) + (k & 3u);
        let centre = links[at].centre;
        if centre.x == 0u || seen[at].seen == 0u {
            continue;
        }
        let half = cell_half(centre);
        if seen[at].centre > appears() {
            drawn_cell(at, centre, half);
        } else if half == 1u << detail.depth {
            whole_root(at, centre, half);
        }
    }
}
