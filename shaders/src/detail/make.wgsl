// Makes cells: a workgroup a block of four, a thread a sample. Heights come from here alone.

#import dolomite::detail::types::Cell
#import dolomite::detail::bindings::{cells, counts, detail, detail_pass, links, GROUPS, MAKE, blocks_before, make_block}
#import dolomite::detail::lattice::{cell_half, cell_quarter, cell_sides, lattice_point}
#import dolomite::detail::errors::{BED_SHARE, ROUNDING, SAMPLES, STEPS, TAIL, on_halves, on_quarter, residual, side_of}
#import dolomite::detail::unseen::unseen
#import dolomite::terrain::fixed::{Fixed, GroundPoint, fixed_add, fixed_negate, ground_point, ground_x, ground_z, mul_wide}
#import dolomite::terrain::height::terrain_height

var<workgroup> heights: array<vec3<f32>, 100>;

// half * step * (k - 2) / 2 along one axis; the halving is towards 0.
fn part(step: vec2<u32>, half: u32, k: u32) -> Fixed {
    let low = mul_wide(step.y, half);
    var whole = low.y + step.x * half;
    var rest = low.x;
    if k == 2u {
        return Fixed(0u, 0u);
    }
    if k == 1u || k == 3u {
        rest = (rest >> 1u) | (whole << 31u);
        whole = whole >> 1u;
    }
    let size = Fixed(whole, rest);
    if k < 2u {
        return fixed_negate(size);
    }
    return size;
}

fn sample_place(centre: vec2<u32>, half: u32, sample: u32) -> GroundPoint {
    let middle = lattice_point(detail, centre);
    return ground_point(
        fixed_add(ground_x(middle), part(detail.step_x, half, sample % SAMPLES)),
        fixed_add(ground_z(middle), part(detail.step_z, half, sample / SAMPLES)),
    );
}

// Height of the drawn surface, and of the bed as far as it is seen.
fn surface(child: u32, i: u32, j: u32) -> vec2<f32> {
    let height = heights[child * 25u + j * SAMPLES + i].x;
    return vec2(max(height, detail.sea), clamp(height, detail.sea - detail.opaque_depth, detail.sea));
}

struct Errors {
    halves: f32,
    quarters: vec4<f32>,
}

fn square_errors(child: u32, i: u32, j: u32, n: u32, outer: u32) -> Errors {
    let c0 = surface(child, i, j);
    let c1 = surface(child, i + n, j);
    let c2 = surface(child, i + n, j + n);
    let c3 = surface(child, i, j + n);
    let middle = surface(child, i + n / 2u, j + n / 2u);
    var errors = Errors(0.0, vec4(0.0));
    for (var z = 0u; z <= n; z++) {
        for (var x = 0u; x <= n; x++) {
            let sample = surface(child, i + x, j + z);
            let u = f32(x) / f32(n);
            let v = f32(z) / f32(n);
            errors.halves = max(errors.halves, residual(sample - on_halves(c0, c1, c2, c3, u, v, outer)));
            let dx = 2.0 * u - 1.0;
            let dz = 2.0 * v - 1.0;
            let out = max(abs(dx), abs(dz));
            let side = side_of(dx, dz);
            var off = 0.0;
            // From corner side - 1 to corner side.
            if side == 0u {
                off = residual(sample - on_quarter(middle, c3, c0, out, -dz));
                errors.quarters.x = max(errors.quarters.x, off);
            } else if side == 1u {
                off = residual(sample - on_quarter(middle, c0, c1, out, dx));
                errors.quarters.y = max(errors.quarters.y, off);
            } else if side == 2u {
                off = residual(sample - on_quarter(middle, c1, c2, out, dz));
                errors.quarters.z = max(errors.quarters.z, off);
            } else {
                off = residual(sample - on_quarter(middle, c2, c3, out, -dx));
                errors.quarters.w = max(errors.quarters.w, off);
            }
        }
    }
    return errors;
}

fn greatest(v: vec4<f32>) -> f32 {
    return max(max(v.x, v.y), max(v.z, v.w));
}

fn made(child: u32, centre: vec2<u32>, half: u32) -> Cell {
    let whole = square_errors(child, 0u, 0u, STEPS, cell_quarter(centre, half));
    var finer = 0.0;
    var finest = 0.0;
    for (var q = 0u; q < 4u; q++) {
        // Squares in rows: corners 0, 1, 3, 2.
        let outer = select(q, 5u - q, q >= 2u);
        let errors = square_errors(child, (q & 1u) * 2u, (q >> 1u) * 2u, 2u, outer);
        finest = max(finest, greatest(errors.quarters));
        finer = max(finer, errors.halves);
    }
    finer = max(finer, finest);
    var low = 1e30;
    var high = -1e30;
    for (var k = 0u; k < 25u; k++) {
        let height = max(heights[child * 25u + k].x, detail.sea);
        low = min(low, height);
        high = max(high, height);
    }
    let sides = cell_sides(detail, half);
    let missed = TAIL * finest + unseen(lattice_point(detail, centre), sides, max(sides.x, sides.y) / f32(STEPS))
        + ROUNDING * max(abs(low), abs(high));
    let quarters = max(whole.quarters, vec4(finer)) + missed;
    let error = max(whole.halves + missed, greatest(quarters));
    let first = child * 25u;
    let north = heights[first + 2u];
    let east = heights[first + 14u];
    let south = heights[first + 22u];
    return Cell(
        vec4(heights[first + 12u], low - error),
        heights[first + 10u],
        north.x,
        north.yz,
        east.xy,
        east.z,
        south.x,
        south.yz,
        error,
        high + error,
        quarters.xy,
        quarters.zw,
        finer + missed,
        0.0,
    );
}

@compute @workgroup_size(128)
fn make_cells(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let first = blocks_before(MAKE, detail_pass.depth);
    let last = first + atomicLoad(&counts[MAKE + detail_pass.depth]);
    // The same for all threads of a group, as barriers need it.
    for (var at = first + group.x; at < last; at += GROUPS) {
        let block = make_block(at);
        if thread < 100u {
            let centre = links[block + thread / 25u].centre;
            let half = cell_half(centre);
            heights[thread] = terrain_height(sample_place(centre, half, thread % 25u));
        }
        workgroupBarrier();
        if thread < 4u {
            let centre = links[block + thread].centre;
            if centre.x != 0u {
                cells[block + thread] = made(thread, centre, cell_half(centre));
            }
        }
        workgroupBarrier();
    }
}
