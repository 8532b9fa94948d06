// Error ratios of the middles of all cells that are kept, and how many vertices have which error ratio. A thread a
// cell. All of them clear the map of the horizon, which a later pass draws.

#import dolomite::detail::types::{APPEARS, NO_CELL}
#import dolomite::detail::bindings::{counts, detail, links, seen, BINS, GROUP, HISTOGRAM, KEPT, STEPS_AN_OCTAVE, kept_cell}
#import dolomite::detail::horizon::clear_horizon
#import dolomite::detail::lattice::{cell_half, on_lattice, side_direction}
#import dolomite::detail::room::room

// Bit of the flags: vertices are counted by their error ratio, for a budget.
const COUNTED: u32 = 16u;

// The greatest error ratio of the quarters of a cell that touch one of its sides.
fn touching(at: u32, side: u32) -> f32 {
    let first = links[at].children;
    if first == 0u {
        return 0.0;
    }
    var error_ratio = 0.0;
    for (var k = 0u; k < 2u; k++) {
        let child = first + ((side + 3u * k) & 3u);
        if seen[child].stamp == detail.stamp {
            error_ratio = max(error_ratio, seen[child].centre);
        }
    }
    return error_ratio;
}

fn count(error_ratio: f32, vertices: u32) {
    if error_ratio > APPEARS {
        let step = clamp(log2(error_ratio / APPEARS) * STEPS_AN_OCTAVE, 0.0, f32(BINS - 1u));
        atomicAdd(&counts[HISTOGRAM + u32(step)], vertices);
    }
}

@compute @workgroup_size(64)
fn find_middles(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    clear_horizon(id.x, groups.x * GROUP);
    let last = atomicLoad(&counts[KEPT]);
    for (var k = id.x; k < last; k += groups.x * GROUP) {
        let at = kept_cell(k);
        let centre = links[at].centre;
        let half = cell_half(centre);
        let beside = seen[at].beside;
        var error_ratios = vec4(0.0);
        for (var side = 0u; side < 4u; side++) {
            let own = max(seen[at].sides[side], touching(at, side));
            let there = beside[side];
            if there == NO_CELL {
                // Nothing is beyond the border of the ground.
                if !on_lattice(centre + side_direction(side) * (2u * half)) {
                    error_ratios[side] = own;
                }
            } else if seen[there].centre > APPEARS {
                let facing = (side + 2u) & 3u;
                error_ratios[side] = max(own, max(seen[there].sides[facing], touching(there, facing)));
            }
        }
        seen[at].middles = error_ratios;
        // In halves: a centre counts two, a middle one for each of the cells beside it. Where all of them
        // have room anyway a budget alone asks.
        if 10u * last > room() || (detail.flags & COUNTED) != 0u {
            count(seen[at].centre, 2u);
            for (var side = 0u; side < 4u; side++) {
                count(error_ratios[side], select(1u, 2u, beside[side] == NO_CELL));
            }
        }
    }
}
