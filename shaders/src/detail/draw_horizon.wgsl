// Draws what is known of the ground into the map of the horizon: of every cell that is drawn, itself or by its
// quarters, a flat square of its lowest height, and one of it and the next cell to the east, and to the south.
// A thread a cell.

#import dolomite::detail::types::NO_CELL
#import dolomite::detail::bindings::{cells, counts, detail, links, seen, GROUP, KEPT, kept_cell, root_count}
#import dolomite::detail::horizon::BLIND
#import dolomite::detail::lattice::{cell_corner, cell_half, lattice_point}
#import dolomite::detail::square::draw_square
#import dolomite::detail::vertices::{appears, is_drawn}
#import dolomite::terrain::fixed::ground_relative

// Whether ground that is as high as the eye may be beside it: see stand in horizon.rs.
fn stand(low: vec2<f32>, high: vec2<f32>, highest: f32, first: u32) {
    let eye = detail.horizon.eye;
    let reach = detail.horizon.near_reach;
    if highest < eye.y - reach {
        return;
    }
    let middle = (low + high) * 0.5;
    for (var k = 0u; k < 4u; k++) {
        let upper = vec2(k == 1u || k == 2u, k >= 2u);
        let least = select(low, middle, upper) - reach;
        let greatest = select(middle, high, upper) + reach;
        if all(eye.xz >= least) && all(eye.xz <= greatest) && !is_drawn(first, k) {
            atomicStore(&counts[BLIND], 1u);
        }
    }
}

fn take(at: u32, first: u32) {
    let centre = links[at].centre;
    let half = cell_half(centre);
    let low = ground_relative(lattice_point(cell_corner(centre, half, 0u)), detail.view.anchor);
    let high = ground_relative(lattice_point(cell_corner(centre, half, 2u)), detail.view.anchor);
    let lowest = cells[at].centre.w - detail.anchor_height;
    draw_square(vec3(low.x, lowest, low.y), high);
    for (var side = 2u; side < 4u; side++) {
        let next = seen[at].beside[side];
        if next != NO_CELL && seen[next].centre > appears() {
            let size = high - low;
            let more = select(vec2(0.0, size.y), vec2(size.x, 0.0), side == 2u);
            draw_square(vec3(low.x, min(lowest, cells[next].centre.w - detail.anchor_height), low.y), high + more);
        }
    }
    stand(low, high, cells[at].high - detail.anchor_height, first);
}

@compute @workgroup_size(64)
fn draw_horizon(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let threads = groups.x * GROUP;
    for (var at = id.x; at < root_count(); at += threads) {
        if seen[at].centre <= appears() {
            take(at, 0u);
        }
    }
    let last = atomicLoad(&counts[KEPT]);
    for (var k = id.x; k < last; k += threads) {
        let at = kept_cell(k);
        if seen[at].centre > appears() {
            take(at, links[at].children);
        }
    }
}
