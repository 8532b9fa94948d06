// Makes cells: a workgroup a block of four, eight threads a cell. Heights come from here alone. First the
// samples, then errors, then the cell; each thread has every eighth four of samples, sample, row or square of its cell.

#import dolomite::detail::types::Cell
#import dolomite::detail::bindings::{cells, counts, detail, detail_pass, links, MAKE, blocks_before, make_block}
#import dolomite::detail::errors::{COUNT, MIDDLE, ROUNDING, SAMPLES, STEPS, Square, TAIL, bend_of_bed, off, second_difference}
#import dolomite::detail::lattice::{cell_half, cell_quarter, cell_sides, lattice_point}
#import dolomite::detail::unseen::unseen
#import dolomite::terrain::fixed::{Fixed, GroundPoint, fixed_add, fixed_negate, ground_point, ground_x, ground_z, mul_wide}
#import dolomite::terrain::four::{Four, four_heights}
#import dolomite::terrain::height::terrain_height

// Threads of a cell. No barrier and no atomic number stands between them and a cell's errors: software Vulkan
// pays for both by the thread.
const THREADS: u32 = 8u;
// Samples of a cell, four at a time.
const FOURS: u32 = (COUNT + 3u) / 4u;

// COUNT a cell.
var<workgroup> heights: array<f32, 324>;
// Heights and gradients at the middles of the sides and the centre, five a cell.
var<workgroup> corners: array<vec3<f32>, 20>;
// Of each thread.
var<workgroup> found: array<Found, 32>;
// The blocks to make: from the first to before the last. Read by one thread: barriers may stand only in a loop
// whose bounds are seen to be the same for all threads, and an atomic number's are not.
var<workgroup> blocks: vec2<u32>;

// The largest errors among some samples, and the heights between which they lie.
struct Found {
    quarters: vec4<f32>,
    halves: f32,
    finer: f32,
    finest: f32,
    low: f32,
    high: f32,
    // Of the bed alone: the heights between which it lies, and its largest second difference.
    bed_low: f32,
    bed_high: f32,
    bed_bend: f32,
}

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

fn sample_x(middle: GroundPoint, half: u32, sample: u32) -> Fixed {
    return fixed_add(ground_x(middle), part(detail.step_x, half, sample % SAMPLES));
}

fn sample_z(middle: GroundPoint, half: u32, sample: u32) -> Fixed {
    return fixed_add(ground_z(middle), part(detail.step_z, half, sample / SAMPLES));
}

// Heights of four samples, one after the other; of the last one more than once where fewer are left.
fn sample_four(middle: GroundPoint, half: u32, first: u32) -> vec4<f32> {
    let at = min(vec4(first) + vec4(0u, 1u, 2u, 3u), vec4(COUNT - 1u));
    return four_heights(
        Four(
            sample_x(middle, half, at.x),
            sample_x(middle, half, at.y),
            sample_x(middle, half, at.z),
            sample_x(middle, half, at.w),
        ),
        Four(
            sample_z(middle, half, at.x),
            sample_z(middle, half, at.y),
            sample_z(middle, half, at.z),
            sample_z(middle, half, at.w),
        ),
    );
}

// The sample in the middle of a side 0 to 3, or in the cell's, 4.
fn sample_of_slot(slot: u32) -> u32 {
    let i = select(select(MIDDLE, STEPS, slot == 2u), 0u, slot == 0u);
    let j = select(select(MIDDLE, STEPS, slot == 3u), 0u, slot == 1u);
    return j * SAMPLES + i;
}

fn bed(cell: u32, i: u32, j: u32) -> f32 {
    return heights[cell * COUNT + j * SAMPLES + i];
}

// Height of the drawn surface, and of the bed as far as it is seen.
fn drawn(cell: u32, i: u32, j: u32) -> vec2<f32> {
    let height = bed(cell, i, j);
    return vec2(max(height, detail.sea), clamp(height, detail.sea - detail.opaque_depth, detail.sea));
}

// The same in the cell's middle; 0 where it is not a number.
fn middle_of(cell: u32) -> vec2<f32> {
    let middle = drawn(cell, MIDDLE, MIDDLE);
    return select(vec2(0.0), middle, abs(middle) < vec2(1e38));
}

// Relative to the middle: in a small cell heights differ by less than they are rounded by.
fn surface(cell: u32, i: u32, j: u32, middle: vec2<f32>) -> vec2<f32> {
    return drawn(cell, i, j) - middle;
}

fn square_at(cell: u32, i: u32, j: u32, n: u32, outer: u32, middle: vec2<f32>) -> Square {
    return Square(
        surface(cell, i, j, middle),
        surface(cell, i + n, j, middle),
        surface(cell, i + n, j + n, middle),
        surface(cell, i, j + n, middle),
        surface(cell, i + n / 2u, j + n / 2u, middle),
        outer,
    );
}

// The greater; what is not a number counts as nothing: no comparison with it holds.
fn greater(a: f32, b: f32) -> f32 {
    return select(a, b, b > a);
}

// Through which corner the diagonal of a square of two squares' side goes, as quarters count.
fn diagonal(i: u32, j: u32) -> u32 {
    return select(i & 1u, 3u - (i & 1u), (j & 1u) == 1u);
}

// Errors of the cell as a whole: every eighth sample.
fn whole(cell: u32, first: u32, outer: u32, middle: vec2<f32>, before: Found) -> Found {
    var here = before;
    let square = square_at(cell, 0u, 0u, STEPS, outer, middle);
    for (var k = first; k < COUNT; k += THREADS) {
        let i = k % SAMPLES;
        let j = k / SAMPLES;
        let sample = surface(cell, i, j, middle);
        here.low = select(here.low, sample.x, sample.x < here.low);
        here.high = greater(here.high, sample.x);
        let height = bed(cell, i, j);
        here.bed_low = select(here.bed_low, height, height < here.bed_low);
        here.bed_high = greater(here.bed_high, height);
        let error = off(square, sample, f32(i) / f32(STEPS), f32(j) / f32(STEPS));
        here.halves = greater(here.halves, error.halves);
        let own = vec4(error.side) == vec4(0u, 1u, 2u, 3u);
        here.quarters = select(here.quarters, vec4(error.quarters), own & (vec4(error.quarters) > here.quarters));
    }
    return here;
}

// Of its quarters: every eighth row of samples.
fn quarters(cell: u32, first: u32, middle: vec2<f32>, before: Found) -> Found {
    const N: u32 = STEPS / 2u;
    var here = before;
    for (var k = first; k < 4u * (N + 1u); k += THREADS) {
        let number = k / (N + 1u);
        let row = k % (N + 1u);
        let i = number & 1u;
        let j = number >> 1u;
        let square = square_at(cell, i * N, j * N, N, diagonal(i, j), middle);
        for (var x = 0u; x <= N; x++) {
            let error = off(square, surface(cell, i * N + x, j * N + row, middle), f32(x) / f32(N), f32(row) / f32(N));
            here.finer = greater(here.finer, greater(error.halves, error.quarters));
        }
    }
    return here;
}

// Of their quarters: every eighth square. A sample that is no corner lies between two others.
fn sixteenths(cell: u32, first: u32, middle: vec2<f32>, before: Found) -> Found {
    var here = before;
    for (var number = first; number < 16u; number += THREADS) {
        let i = number & 3u;
        let j = number >> 2u;
        let x = 2u * i;
        let z = 2u * j;
        let nw = surface(cell, x, z, middle);
        let ne = surface(cell, x + 2u, z, middle);
        let se = surface(cell, x + 2u, z + 2u, middle);
        let sw = surface(cell, x, z + 2u, middle);
        let upright = greater(
            second_difference(surface(cell, x, z + 1u, middle), nw, sw),
            second_difference(surface(cell, x + 2u, z + 1u, middle), ne, se),
        );
        let level = greater(
            second_difference(surface(cell, x + 1u, z, middle), nw, ne),
            second_difference(surface(cell, x + 1u, z + 2u, middle), sw, se),
        );
        let even = (diagonal(i, j) & 1u) == 0u;
        let centre = second_difference(surface(cell, x + 1u, z + 1u, middle), select(sw, nw, even), select(ne, se, even));
        here.finest = greater(here.finest, greater(upright, level));
        here.finer = greater(here.finer, greater(here.finest, centre));
        let nw_bed = bed(cell, x, z);
        let ne_bed = bed(cell, x + 2u, z);
        let se_bed = bed(cell, x + 2u, z + 2u);
        let sw_bed = bed(cell, x, z + 2u);
        let upright_bed = greater(
            bend_of_bed(bed(cell, x, z + 1u), nw_bed, sw_bed),
            bend_of_bed(bed(cell, x + 2u, z + 1u), ne_bed, se_bed),
        );
        let level_bed = greater(
            bend_of_bed(bed(cell, x + 1u, z), nw_bed, ne_bed),
            bend_of_bed(bed(cell, x + 1u, z + 2u), sw_bed, se_bed),
        );
        here.bed_bend = greater(here.bed_bend, greater(upright_bed, level_bed));
    }
    return here;
}

fn greatest(v: vec4<f32>) -> f32 {
    return max(max(v.x, v.y), max(v.z, v.w));
}

fn made(cell: u32, centre: vec2<u32>, half: u32) -> Cell {
    var all = found[cell * THREADS];
    for (var k = 1u; k < THREADS; k++) {
        let other = found[cell * THREADS + k];
        all.quarters = max(all.quarters, other.quarters);
        all.halves = max(all.halves, other.halves);
        all.finer = max(all.finer, other.finer);
        all.finest = max(all.finest, other.finest);
        all.low = min(all.low, other.low);
        all.high = max(all.high, other.high);
        all.bed_low = min(all.bed_low, other.bed_low);
        all.bed_high = max(all.bed_high, other.bed_high);
        all.bed_bend = max(all.bed_bend, other.bed_bend);
    }
    // As far as ground may rise out of the sea between samples.
    let depth = max(detail.sea - all.bed_high, 0.0);
    let rising = select(0.0, all.bed_bend - depth / (1.0 + TAIL), all.bed_low < detail.sea);
    all.finer = greater(all.finer, rising);
    all.finest = greater(all.finest, rising);
    let sides = cell_sides(half);
    let middle = middle_of(cell).x;
    let low = middle + all.low;
    let high = middle + all.high;
    let missed = TAIL * all.finest
        + unseen(lattice_point(centre), sides, max(sides.x, sides.y) / f32(STEPS))
        + ROUNDING * max(abs(low), abs(high));
    let quarters = max(all.quarters, vec4(all.finer)) + missed;
    let error = max(all.halves + missed, greatest(quarters));
    let first = 5u * cell;
    let north = corners[first + 1u];
    let east = corners[first + 2u];
    let south = corners[first + 3u];
    return Cell(
        vec4(corners[first + 4u], low - error),
        corners[first],
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
        all.finer + missed,
        0u,
    );
}

@compute @workgroup_size(32)
fn make_cells(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    if thread == 0u {
        let first = blocks_before(MAKE, detail_pass.depth);
        blocks = vec2(first, first + atomicLoad(&counts[MAKE + detail_pass.depth]));
    }
    let ends = workgroupUniformLoad(&blocks);
    let cell = thread / THREADS;
    let own = thread % THREADS;
    for (var at = ends.x + group.x; at < ends.y; at += groups.x) {
        let number = make_block(at) + cell;
        let centre = links[number].centre;
        let half = cell_half(centre);
        let middle_point = lattice_point(centre);
        for (var k = own; k < FOURS; k += THREADS) {
            let four = sample_four(middle_point, half, 4u * k);
            for (var i = 0u; i < min(4u, COUNT - 4u * k); i++) {
                heights[cell * COUNT + 4u * k + i] = four[i];
            }
        }
        // Of five samples the gradient too.
        if own < 5u {
            let sample = sample_of_slot(own);
            let place = ground_point(sample_x(middle_point, half, sample), sample_z(middle_point, half, sample));
            corners[5u * cell + own] = terrain_height(place);
        }
        workgroupBarrier();
        var here = Found(vec4(0.0), 0.0, 0.0, 0.0, 1e30, -1e30, 1e30, -1e30, 0.0);
        let middle = middle_of(cell);
        here = whole(cell, own, cell_quarter(centre, half), middle, here);
        here = quarters(cell, own, middle, here);
        found[thread] = sixteenths(cell, own, middle, here);
        workgroupBarrier();
        // Where there are few roots a block of them is not full.
        if own == 0u && centre.x != 0u {
            cells[number] = made(cell, centre, half);
        }
        if at + groups.x < ends.y {
            // The next block is written over what threads may still read of this one.
            workgroupBarrier();
        }
    }
}
