// Makes cells: a workgroup a block of four. Heights come from here alone. First a thread a sample, then a
// thread an error, then a thread a cell.

#import dolomite::detail::types::Cell
#import dolomite::detail::bindings::{cells, counts, detail, detail_pass, links, GROUPS, MAKE, blocks_before, make_block}
#import dolomite::detail::lattice::{cell_half, cell_quarter, cell_sides, lattice_point}
#import dolomite::detail::errors::{BED_SHARE, COUNT, MIDDLE, ROUNDING, SAMPLES, STEPS, TAIL, ERRORS, Place, error_place, on_halves, on_quarter, residual, side_of}
#import dolomite::detail::unseen::unseen
#import dolomite::terrain::fixed::{Fixed, GroundPoint, fixed_add, fixed_negate, ground_point, ground_x, ground_z, mul_wide}
#import dolomite::terrain::height::terrain_height

const THREADS: u32 = 128u;

// COUNT a cell.
var<workgroup> heights: array<vec3<f32>, 324>;
// Bits of the largest errors, which are 0 and above, WORDS a cell.
var<workgroup> largest: array<atomic<u32>, 28>;

const WORDS: u32 = 7u;
const HALVES: u32 = 0u;
// Four.
const QUARTERS: u32 = 1u;
const FINER: u32 = 5u;
const FINEST: u32 = 6u;

// half * step * (k - MIDDLE) / MIDDLE along one axis, rounded towards 0.
fn part(step: vec2<u32>, half: u32, k: u32) -> Fixed {
    let low = mul_wide(step.y, half);
    var size = Fixed(low.y + step.x * half, low.x);
    let share = max(k, MIDDLE) - min(k, MIDDLE);
    if share == 0u {
        return Fixed(0u, 0u);
    }
    if share < MIDDLE {
        let twice = Fixed((size.whole << 1u) | (size.rest >> 31u), size.rest << 1u);
        if share == 2u {
            size = twice;
        } else if share == 3u {
            size = fixed_add(size, twice);
        }
        size = Fixed(size.whole >> 2u, (size.rest >> 2u) | (size.whole << 30u));
    }
    if k < MIDDLE {
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
    let height = heights[child * COUNT + j * SAMPLES + i].x;
    return vec2(max(height, detail.sea), clamp(height, detail.sea - detail.opaque_depth, detail.sea));
}

fn raise(child: u32, word: u32, error: f32) {
    // NaN counts as nothing: no comparison with it holds.
    if error > 0.0 {
        atomicMax(&largest[child * WORDS + word], bitcast<u32>(error));
    }
}

fn raised(child: u32, word: u32) -> f32 {
    return bitcast<f32>(atomicLoad(&largest[child * WORDS + word]));
}

// One sample of one square: off the two triangles by its diagonal, and off the quarter that it lies in.
fn measure(child: u32, place: Place, centre: vec2<u32>, half: u32) {
    let n = place.size;
    let i = place.corner.x;
    let j = place.corner.y;
    let c0 = surface(child, i, j);
    let c1 = surface(child, i + n, j);
    let c2 = surface(child, i + n, j + n);
    let c3 = surface(child, i, j + n);
    let sample = surface(child, i + place.sample.x, j + place.sample.y);
    let u = f32(place.sample.x) / f32(n);
    let v = f32(place.sample.y) / f32(n);
    var outer = cell_quarter(centre, half);
    if n < STEPS {
        // Corners 0, 1, 2, 3 of the square of two squares that it is a quarter of.
        let odd = vec2((i / n) & 1u, (j / n) & 1u);
        outer = select(odd.x, 3u - odd.x, odd.y == 1u);
    }
    let halves = residual(sample - on_halves(c0, c1, c2, c3, u, v, outer));
    let middle = surface(child, i + n / 2u, j + n / 2u);
    let dx = 2.0 * u - 1.0;
    let dz = 2.0 * v - 1.0;
    let out = max(abs(dx), abs(dz));
    let side = side_of(dx, dz);
    var quarter = vec2(0.0);
    // From corner side - 1 to corner side.
    if side == 0u {
        quarter = on_quarter(middle, c3, c0, out, -dz);
    } else if side == 1u {
        quarter = on_quarter(middle, c0, c1, out, dx);
    } else if side == 2u {
        quarter = on_quarter(middle, c1, c2, out, dz);
    } else {
        quarter = on_quarter(middle, c2, c3, out, -dx);
    }
    let quarters = residual(sample - quarter);
    if n == STEPS {
        raise(child, HALVES, halves);
        raise(child, QUARTERS + side, quarters);
        return;
    }
    raise(child, FINER, max(halves, quarters));
    if n == 2u {
        raise(child, FINEST, quarters);
    }
}

fn greatest(v: vec4<f32>) -> f32 {
    return max(max(v.x, v.y), max(v.z, v.w));
}

fn made(child: u32, centre: vec2<u32>, half: u32) -> Cell {
    let finer = raised(child, FINER);
    var low = 1e30;
    var high = -1e30;
    for (var k = 0u; k < COUNT; k++) {
        let height = max(heights[child * COUNT + k].x, detail.sea);
        low = min(low, height);
        high = max(high, height);
    }
    let sides = cell_sides(detail, half);
    let missed = TAIL * raised(child, FINEST)
        + unseen(lattice_point(detail, centre), sides, max(sides.x, sides.y) / f32(STEPS))
        + ROUNDING * max(abs(low), abs(high));
    let own = vec4(raised(child, QUARTERS), raised(child, QUARTERS + 1u), raised(child, QUARTERS + 2u), raised(child, QUARTERS + 3u));
    let quarters = max(own, vec4(finer)) + missed;
    let error = max(raised(child, HALVES) + missed, greatest(quarters));
    let first = child * COUNT;
    let north = heights[first + MIDDLE];
    let east = heights[first + MIDDLE * SAMPLES + STEPS];
    let south = heights[first + STEPS * SAMPLES + MIDDLE];
    return Cell(
        vec4(heights[first + MIDDLE * SAMPLES + MIDDLE], low - error),
        heights[first + MIDDLE * SAMPLES],
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
        for (var k = thread; k < 4u * COUNT; k += THREADS) {
            let centre = links[block + k / COUNT].centre;
            heights[k] = terrain_height(sample_place(centre, cell_half(centre), k % COUNT));
        }
        if thread < 4u * WORDS {
            atomicStore(&largest[thread], 0u);
        }
        workgroupBarrier();
        for (var k = thread; k < 4u * ERRORS; k += THREADS) {
            let child = k / ERRORS;
            let centre = links[block + child].centre;
            measure(child, error_place(k % ERRORS), centre, cell_half(centre));
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
