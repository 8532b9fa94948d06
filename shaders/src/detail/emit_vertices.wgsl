// Numbers and writes the vertices of all cells that are drawn, after the corners of the roots. Two
// entries, since heights and triangles need all numbers. A thread a cell.

#import dolomite::detail::types::cell_mid
#import dolomite::detail::bindings::{cells, counts, detail, links, seen, LOOK, THREADS, VERTICES, blocks_before, look_block}
#import dolomite::detail::lattice::{cell_half, cell_side_mid, lattice_point}
#import dolomite::detail::roots::root_corner
#import dolomite::detail::vertices::{appears, drawn_height, owns}
#import dolomite::stage::vertex::{VERTEX_WORDS, pack_normal}
#import dolomite::terrain::fixed::ground_relative

// As the stage draws them: see vertex.wgsl.
@group(1) @binding(1) var<storage, read_write> vertices: array<u32>;

fn corner_count() -> u32 {
    return (detail.roots.x + 1u) * (detail.roots.y + 1u);
}

fn store(number: u32, at: vec2<u32>, height: f32, ground: vec3<f32>) {
    if number >= detail.max_vertices {
        return;
    }
    let place = ground_relative(lattice_point(detail, at), detail.view.anchor);
    let depth = clamp(detail.sea - ground.x, -detail.depth_range, detail.depth_range);
    let base = number * VERTEX_WORDS;
    vertices[base] = bitcast<u32>(place.x);
    vertices[base + 1u] = bitcast<u32>(height - detail.anchor_height);
    vertices[base + 2u] = bitcast<u32>(place.y);
    vertices[base + 3u] = pack_normal(normalize(vec3(-ground.y, 1.0, -ground.z)), 0u);
    vertices[base + 4u] = pack2x16snorm(vec2(depth / detail.depth_range, 0.0));
}

@compute @workgroup_size(64)
fn number_vertices(@builtin(global_invocation_id) id: vec3<u32>) {
    let last = 4u * blocks_before(LOOK, detail.depth + 1u);
    for (var k = id.x; k < last; k += THREADS) {
        let at = look_block(k / 4u) + (k & 3u);
        let centre = links[at].centre;
        if centre.x == 0u || seen[at].centre <= appears() {
            continue;
        }
        let half = cell_half(centre);
        var own = 1u;
        for (var side = 0u; side < 4u; side++) {
            own += select(0u, 1u, owns(at, centre, half, side));
        }
        seen[at].first = corner_count() + atomicAdd(&counts[VERTICES], own);
    }
}

@compute @workgroup_size(64)
fn emit_vertices(@builtin(global_invocation_id) id: vec3<u32>) {
    let rows = detail.roots.x + 1u;
    for (var k = id.x; k < corner_count(); k += THREADS) {
        let at = vec2(k % rows, k / rows) << vec2(detail.depth + 1u);
        let ground = root_corner(at);
        store(k, at, max(ground.x, detail.sea), ground);
    }
    let last = 4u * blocks_before(LOOK, detail.depth + 1u);
    for (var k = id.x; k < last; k += THREADS) {
        let at = look_block(k / 4u) + (k & 3u);
        let centre = links[at].centre;
        if centre.x == 0u || seen[at].centre <= appears() {
            continue;
        }
        let half = cell_half(centre);
        var number = seen[at].first;
        store(number, centre, drawn_height(at, centre), cells[at].centre.xyz);
        for (var side = 0u; side < 4u; side++) {
            if owns(at, centre, half, side) {
                number += 1u;
                let mid = cell_side_mid(centre, half, side);
                store(number, mid, drawn_height(at, mid), cell_mid(cells[at], side));
            }
        }
    }
}
