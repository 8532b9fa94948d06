// Demands of the middles of all cells that are drawn, and how many vertices have which demand. A
// thread a cell.

#import dolomite::detail::types::{APPEARS, NO_CELL}
#import dolomite::detail::bindings::{counts, detail, links, seen, BINS, HISTOGRAM, LOOK, STEPS_AN_OCTAVE, THREADS, blocks_before, look_block}
#import dolomite::detail::find::find_cell
#import dolomite::detail::lattice::{cell_half, on_lattice, side_direction}

// The greatest demand of the quarters of a cell that touch one of its sides.
fn touching(at: u32, side: u32) -> f32 {
    let first = links[at].children;
    if first == 0u {
        return 0.0;
    }
    var demand = 0.0;
    for (var k = 0u; k < 2u; k++) {
        let child = first + ((side + 3u * k) & 3u);
        if seen[child].stamp == detail.stamp {
            demand = max(demand, seen[child].centre);
        }
    }
    return demand;
}

fn count(demand: f32, vertices: u32) {
    if demand > APPEARS {
        let step = clamp(log2(demand / APPEARS) * STEPS_AN_OCTAVE, 0.0, f32(BINS - 1u));
        atomicAdd(&counts[HISTOGRAM + u32(step)], vertices);
    }
}

@compute @workgroup_size(64)
fn find_middles(@builtin(global_invocation_id) id: vec3<u32>) {
    let last = 4u * blocks_before(LOOK, detail.depth + 1u);
    for (var k = id.x; k < last; k += THREADS) {
        let at = look_block(k / 4u) + (k & 3u);
        let centre = links[at].centre;
        if centre.x == 0u || seen[at].centre <= APPEARS {
            continue;
        }
        let half = cell_half(centre);
        var demands = vec4(0.0);
        for (var side = 0u; side < 4u; side++) {
            let own = max(seen[at].sides[side], touching(at, side));
            let beside = centre + side_direction(side) * (2u * half);
            if !on_lattice(detail, beside) {
                demands[side] = own;
                count(own, 2u);
                continue;
            }
            let there = find_cell(at, beside, half);
            if there != NO_CELL && seen[there].centre > APPEARS {
                let facing = (side + 2u) & 3u;
                demands[side] = max(own, max(seen[there].sides[facing], touching(there, facing)));
                // Each of both cells counts a half.
                count(demands[side], 1u);
            }
        }
        seen[at].middles = demands;
        count(seen[at].centre, 2u);
    }
}
