// Looks at the cells of one depth: their own error ratios, and what lies around them. A thread a cell.

#import dolomite::detail::types::{Cell, ViewCell, cell_quarters}
#import dolomite::detail::around::{find_around, find_around_root}
#import dolomite::detail::bindings::{cells, counts, detail, detail_pass, links, seen, GROUP, LOOK, blocks_before, look_block}
#import dolomite::detail::lattice::{cell_corner, cell_half, cell_sides, lattice_point}
#import dolomite::detail::view::{Sight, box_share, box_sight}
#import dolomite::terrain::fixed::ground_relative

// Pixels, or segments, a metre, by the metric; see own_error_ratio in select.rs.
fn error_ratio_of_a_metre(sight: Sight, cell: Cell) -> f32 {
    if detail.view.metric == 2u {
        return sight.pixels_per_metre;
    }
    if detail.view.metric == 1u {
        return detail.view.scale / select(max(sight.distance, detail.view.near), 1.0, detail.view.orthographic == 1.0);
    }
    let relief = clamp((cell.high - cell.centre.w - 2.0 * cell.error) * detail.view.classic.w, 0.0, 1.0);
    let blend = min(detail.view.classic.z * sight.distance + 0.4 * (1.0 - relief), 1.0);
    let near = sight.distance * detail.view.classic.z < 0.6;
    return select(detail.view.classic.x, detail.view.classic.y + (detail.view.classic.x - detail.view.classic.y) * blend, near);
}

fn look_at(at: u32, most: f32) {
    let centre = links[at].centre;
    let half = cell_half(centre);
    let cell = cells[at];
    let low = ground_relative(lattice_point(cell_corner(centre, half, 0u)), detail.view.anchor);
    let high = ground_relative(lattice_point(cell_corner(centre, half, 2u)), detail.view.anchor);
    let least = vec3(low.x, cell.centre.w, low.y);
    let greatest = vec3(high.x, cell.high, high.y);
    let sight = box_sight(least, greatest);
    // Of cells beside those in view too: see own_error_ratio.
    let around = greatest - least;
    let factor = box_share(least - around, greatest + around) * detail.view.inverse_tolerance * error_ratio_of_a_metre(sight, cell);
    var whole = cell.error;
    var sides = cell_quarters(cell);
    var finer = cell.finer;
    if detail.view.metric != 2u {
        let metres = cell_sides(half);
        whole = length(metres);
        sides = vec4(max(metres.x, metres.y));
        finer = 0.5 * whole;
    }
    whole = min(max(whole * factor, 0.0), most);
    seen[at].whole = whole;
    seen[at].finer = clamp(finer * factor, 0.0, whole);
    seen[at].sides = clamp(sides * factor, vec4(0.0), vec4(whole));
    seen[at].centre = 0.0;
    seen[at].seen = select(0u, 1u, sight.share > 0.0);
    seen[at].stamp = detail.stamp;
    cells[at].looked = detail.stamp;
}

@compute @workgroup_size(64)
fn look_at_cells(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let depth = detail_pass.depth;
    let first = blocks_before(LOOK, depth);
    let last = 4u * atomicLoad(&counts[LOOK + depth]);
    for (var k = id.x; k < last; k += groups.x * GROUP) {
        let at = look_block(first + k / 4u) + (k & 3u);
        // Where there are few roots a block of them is not full.
        if links[at].centre.x == 0u {
            continue;
        }
        var most = 1e30;
        if depth == 0u {
            find_around_root(at);
        } else {
            let parent = links[at].parent;
            find_around(at, parent);
            most = seen[parent].finer;
        }
        look_at(at, most);
    }
}
