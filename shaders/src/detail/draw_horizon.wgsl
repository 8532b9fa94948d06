// Draws what is known of the ground into the map of the horizon: of every cell that is drawn, itself or by its
// quarters, a flat square of its lowest height, and one of it and the next cell to the east, and to the south.
// A thread a cell.

#import dolomite::detail::types::NO_CELL
#import dolomite::detail::bindings::{cells, counts, detail, links, seen, GROUP, HORIZON, KEPT, kept_cell, root_count}
#import dolomite::detail::horizon::{BLIND, COLUMNS, LAYERS, LAYER_ROUNDING, Mapped, column_of, layer_of, map_place, margin_at, ordered}
#import dolomite::detail::lattice::{cell_corner, cell_half, lattice_point}
#import dolomite::detail::vertices::{appears, is_drawn}
#import dolomite::terrain::fixed::ground_relative

// s of a flat square, `lift` above the eye, at u: see side_of in horizon.rs.
fn side_of(corners: array<Mapped, 4>, lift: f32, u: f32) -> f32 {
    var all = corners;
    var highest = -1e30;
    for (var k = 0u; k < 4u; k++) {
        let a = all[k];
        let b = all[(k + 1u) & 3u];
        if (a.u - u) * (b.u - u) <= 0.0 && a.u != b.u {
            let qa = 1.0 / a.depth;
            let qb = 1.0 / b.depth;
            highest = max(highest, lift * (qa + (qb - qa) * ((u - a.u) / (b.u - a.u))));
        }
    }
    return highest;
}

// Relative to the stage's anchor.
fn draw_square(low: vec3<f32>, high: vec2<f32>) {
    let lift = low.y - detail.horizon.eye.y;
    let corners = array(
        map_place(low),
        map_place(vec3(high.x, low.yz)),
        map_place(vec3(high.x, low.y, high.y)),
        map_place(vec3(low.xy, high.y)),
    );
    let depths = vec4(corners[0].depth, corners[1].depth, corners[2].depth, corners[3].depth);
    let nearest = min(min(depths.x, depths.y), min(depths.z, depths.w));
    let farthest = max(max(depths.x, depths.y), max(depths.z, depths.w));
    let layer = ceil(layer_of(farthest) + LAYER_ROUNDING);
    if !(nearest >= detail.horizon.nearest && layer < f32(LAYERS) && abs(lift) < 1e30) {
        return;
    }
    let us = vec4(corners[0].u, corners[1].u, corners[2].u, corners[3].u);
    let left = min(min(us.x, us.y), min(us.z, us.w));
    let right = max(max(us.x, us.y), max(us.z, us.w));
    let margin = margin_at(max(abs(left), abs(right)), abs(lift) / nearest);
    let first = u32(max(ceil(column_of(left + margin)), 0.0));
    let last = u32(clamp(floor(column_of(right - margin)), 0.0, f32(COLUMNS)));
    let width = 2.0 * detail.horizon.reach / f32(COLUMNS);
    let row = HORIZON + u32(max(layer, 0.0)) * COLUMNS;
    for (var k = first; k < last; k++) {
        let u = f32(k) * width - detail.horizon.reach;
        let s = min(side_of(corners, lift, u - margin), side_of(corners, lift, u + width + margin));
        atomicMax(&counts[row + k], ordered(s - margin));
    }
}

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
