// Writes the vertices of all cells that are drawn, each as it is once its geomorph is done; and what the heights
// of those in their geomorph depend on. A thread a cell.

#import dolomite::detail::types::NO_CELL
#import dolomite::detail::bindings::{counts, detail, links, seen, MORPHING, GROUP, KEPT, kept_cell}
#import dolomite::detail::lattice::{cell_half, cell_side_mid, lattice_point}
#import dolomite::detail::records::{RECORD, records}
#import dolomite::detail::room::corner_count
#import dolomite::detail::roots::root_corner
#import dolomite::detail::vertices::{CENTRE, Vertex, appears, morph_share, cell_error_ratio, cell_ground, corner_of, vertex_number}
#import dolomite::geometry::vertex::{VERTEX_WORDS, pack_normal}
#import dolomite::terrain::fixed::ground_relative

// As the stage draws them: see vertex.wgsl.
@group(1) @binding(1) var<storage, read_write> vertices: array<u32>;

fn store(number: u32, at: vec2<u32>, ground: vec3<f32>) -> f32 {
    let surface = max(ground.x, detail.sea);
    let place = ground_relative(lattice_point(at), detail.view.anchor);
    let depth = clamp(detail.sea - ground.x, -detail.depth_range, detail.depth_range);
    let base = number * VERTEX_WORDS;
    vertices[base] = bitcast<u32>(place.x);
    vertices[base + 1u] = bitcast<u32>(surface - detail.anchor_height);
    vertices[base + 2u] = bitcast<u32>(place.y);
    vertices[base + 3u] = pack_normal(normalize(vec3(-ground.y, 1.0, -ground.z)), 0u);
    vertices[base + 4u] = pack2x16snorm(vec2(depth / detail.depth_range, 0.0));
    return surface;
}

// Corners of a cell between which a vertex of it lies in the middle: of a side from the lesser coordinate on,
// of the centre from the parent's centre on. Roots count as if they had parents.
fn ends_of(slot: u32, at: u32, centre: vec2<u32>, half: u32) -> vec2<u32> {
    if slot == CENTRE {
        let upper = (centre / half) & vec2(2u);
        let outer = select(select(0u, 1u, upper.x != 0u), select(3u, 2u, upper.x != 0u), upper.y != 0u);
        return vec2(outer + 2u, outer);
    }
    return vec2(select(slot - 1u, slot, slot < 2u), select(slot, slot + 3u, slot < 2u));
}

@compute @workgroup_size(64)
fn place_vertices(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let threads = groups.x * GROUP;
    let rows = detail.roots.x + 1u;
    for (var k = id.x; k < corner_count(); k += threads) {
        let at = vec2(k % rows, k / rows) << vec2(detail.depth + 1u);
        if k < detail.max_vertices {
            let surface = store(k, at, root_corner(at));
            records[RECORD * k] = bitcast<u32>(1.0);
            records[RECORD * k + 1u] = bitcast<u32>(surface);
        }
    }
    let last = atomicLoad(&counts[KEPT]);
    for (var k = id.x; k < last; k += threads) {
        let cell = kept_cell(k);
        if seen[cell].centre <= appears() {
            continue;
        }
        let centre = links[cell].centre;
        let half = cell_half(centre);
        // The centre last: bit 4.
        var left = seen[cell].own | (1u << CENTRE);
        while left != 0u {
            let slot = countTrailingZeros(left);
            left &= left - 1u;
            let vertex = Vertex(cell, slot);
            let number = vertex_number(vertex);
            if number >= detail.max_vertices {
                continue;
            }
            let at = select(cell_side_mid(centre, half, slot), centre, slot == CENTRE);
            let surface = store(number, at, cell_ground(vertex));
            let share = morph_share(cell_error_ratio(vertex));
            let base = RECORD * number;
            records[base] = bitcast<u32>(share);
            records[base + 1u] = bitcast<u32>(surface);
            if share < 1.0 {
                let ends = ends_of(slot, cell, centre, half);
                records[base + 2u] = vertex_number(corner_of(cell, ends.x));
                records[base + 3u] = vertex_number(corner_of(cell, ends.y));
                records[RECORD * detail.max_vertices + atomicAdd(&counts[MORPHING], 1u)] = number;
            }
        }
    }
}
