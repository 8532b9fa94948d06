// Makes the records of blocks from their samples: a workgroup a block. Which numbers, and in which order:
// plugins/ground/src/blocks/record.rs.

#import dolomite::detail::bindings::{counts, detail}
#import dolomite::detail::lattice::on_lattice
#import dolomite::detail::unseen::unseen
#import dolomite::blocks::bindings::{SLOPES, heads, lists, made_list, record_at, records}
#import dolomite::blocks::border::{border_point, metres_between}
#import dolomite::blocks::errors::{BEYOND, TAIL, bend, bend_of_bed, greater, twist}
#import dolomite::blocks::nest::{Nest, centre_count, middle_count, nest_centre, nest_middle, tails, twists}
#import dolomite::blocks::others::{copiers, copy_corner, cutters, put_bits, taken_by}
#import dolomite::blocks::record::{ALWAYS, CELLS, CELL_HIGHS, CELL_LOWS, CORNERS, CORNER_COUNT, ERRORS, HEIGHTS, HIGHS, LOWS, NEST, NO_BLOCK, RINGED, RINGED_COUNT, RING_ERRORS, block_quarter, number_at, quarter_corner, ring_number, ringed_number}
#import dolomite::blocks::samples::{BEFORE_BLOCK, SAMPLES, SAMPLE_COUNT, WIDE, WIDE_COUNT, drawn, sample_row, samples}
#import dolomite::blocks::uneven::{has_border, put_uneven}
#import dolomite::terrain::fixed::ground_offset

const GROUP: u32 = 128u;
// Cells of the ring about the block.
const AROUND: i32 = 3;
// Corners of the block with a ring of one along a side.
const RINGED_CORNERS: u32 = 19u;
const EMPTY_LOW: f32 = 3e38;

// Of each cell with its ring: lowest, highest; of the samples of the bed first, then of the drawn surface.
var<workgroup> lows: array<f32, 484>;
var<workgroup> highs: array<f32, 484>;
// The largest second difference of the bed's samples; then by how much the bed may lie beyond them.
var<workgroup> beyond: array<f32, 484>;
// The largest second difference of the drawn surface and of the bed as far as it is seen.
var<workgroup> finest_bends: array<f32, 484>;
// Errors of mixed corners, -1 to 17 by rows.
var<workgroup> mixed: array<f32, 361>;
// Bits of the largest error of a mixed corner of the block; ordered bits of the lowest and the highest.
var<workgroup> largest: atomic<u32>;
var<workgroup> lowest: atomic<u32>;
var<workgroup> highest: atomic<u32>;
// Which quarters take something that has become another.
var<workgroup> all_taken_by: atomic<u32>;

struct Made {
    // Its first sample.
    row: u32,
    record: u32,
    // Record of the parent; whether there is one.
    parent: u32,
    is_root: bool,
    // North-western corner, lattice coordinates; half side of a cell.
    origin: vec2<u32>,
    cell_half: u32,
    // Where it lies in its parent, cells.
    inside: vec2<u32>,
}

// Centre of the square of `half` that begins so many cells from the north-western corner.
fn square_centre(made: Made, cells: vec2<i32>, half: u32) -> vec2<u32> {
    return made.origin + bitcast<vec2<u32>>(2 * cells) * made.cell_half + vec2(half);
}

fn parent_cell(made: Made, cell: vec2<i32>) -> vec2<i32> {
    return (cell >> vec2(1u)) + vec2<i32>(made.inside);
}

// Error of the centre of a cell of the parent, its ring too.
fn parent_error(made: Made, cell: vec2<i32>) -> f32 {
    let inside = all(cell >= vec2(0)) && all(cell < vec2(i32(CELLS)));
    let own = ERRORS + CORNER_COUNT + bitcast<u32>(cell.y) * CELLS + bitcast<u32>(cell.x);
    let number = select(RING_ERRORS + ring_number(cell), own, inside);
    return bitcast<f32>(records[made.parent + number]);
}

// What the samples of a cell tell; k counts those with the ring.
fn look_at_cell(row: u32, k: u32) {
    let first = row + 4u * (k / WIDE) * SAMPLES + 4u * (k % WIDE);
    // bXZ of the bed, sXZ as it is drawn.
    let b00 = samples[first];
    let b10 = samples[first + 1u];
    let b20 = samples[first + 2u];
    let b30 = samples[first + 3u];
    let b40 = samples[first + 4u];
    let b01 = samples[first + 1u * SAMPLES];
    let b11 = samples[first + 1u + 1u * SAMPLES];
    let b21 = samples[first + 2u + 1u * SAMPLES];
    let b31 = samples[first + 3u + 1u * SAMPLES];
    let b41 = samples[first + 4u + 1u * SAMPLES];
    let b02 = samples[first + 2u * SAMPLES];
    let b12 = samples[first + 1u + 2u * SAMPLES];
    let b22 = samples[first + 2u + 2u * SAMPLES];
    let b32 = samples[first + 3u + 2u * SAMPLES];
    let b42 = samples[first + 4u + 2u * SAMPLES];
    let b03 = samples[first + 3u * SAMPLES];
    let b13 = samples[first + 1u + 3u * SAMPLES];
    let b23 = samples[first + 2u + 3u * SAMPLES];
    let b33 = samples[first + 3u + 3u * SAMPLES];
    let b43 = samples[first + 4u + 3u * SAMPLES];
    let b04 = samples[first + 4u * SAMPLES];
    let b14 = samples[first + 1u + 4u * SAMPLES];
    let b24 = samples[first + 2u + 4u * SAMPLES];
    let b34 = samples[first + 3u + 4u * SAMPLES];
    let b44 = samples[first + 4u + 4u * SAMPLES];
    let s00 = drawn(b00);
    let s10 = drawn(b10);
    let s20 = drawn(b20);
    let s30 = drawn(b30);
    let s40 = drawn(b40);
    let s01 = drawn(b01);
    let s11 = drawn(b11);
    let s21 = drawn(b21);
    let s31 = drawn(b31);
    let s41 = drawn(b41);
    let s02 = drawn(b02);
    let s12 = drawn(b12);
    let s22 = drawn(b22);
    let s32 = drawn(b32);
    let s42 = drawn(b42);
    let s03 = drawn(b03);
    let s13 = drawn(b13);
    let s23 = drawn(b23);
    let s33 = drawn(b33);
    let s43 = drawn(b43);
    let s04 = drawn(b04);
    let s14 = drawn(b14);
    let s24 = drawn(b24);
    let s34 = drawn(b34);
    let s44 = drawn(b44);
    var finest = 0.0;
    finest = greater(finest, greater(greater(bend(s10, s00, s20), bend(s30, s20, s40)), greater(bend(s01, s00, s02), bend(s03, s02, s04))));
    finest = greater(finest, greater(greater(bend(s12, s02, s22), bend(s32, s22, s42)), greater(bend(s21, s20, s22), bend(s23, s22, s24))));
    finest = greater(finest, greater(greater(bend(s14, s04, s24), bend(s34, s24, s44)), greater(bend(s41, s40, s42), bend(s43, s42, s44))));
    var of_bed = 0.0;
    of_bed = greater(of_bed, greater(greater(bend_of_bed(b10, b00, b20), bend_of_bed(b30, b20, b40)), greater(bend_of_bed(b01, b00, b02), bend_of_bed(b03, b02, b04))));
    of_bed = greater(of_bed, greater(greater(bend_of_bed(b12, b02, b22), bend_of_bed(b32, b22, b42)), greater(bend_of_bed(b21, b20, b22), bend_of_bed(b23, b22, b24))));
    of_bed = greater(of_bed, greater(greater(bend_of_bed(b14, b04, b24), bend_of_bed(b34, b24, b44)), greater(bend_of_bed(b41, b40, b42), bend_of_bed(b43, b42, b44))));
    var twisted = 0.0;
    twisted = greater(twisted, greater(greater(twist(s00, s10, s01, s11), twist(s10, s20, s11, s21)), greater(twist(s20, s30, s21, s31), twist(s30, s40, s31, s41))));
    twisted = greater(twisted, greater(greater(twist(s01, s11, s02, s12), twist(s11, s21, s12, s22)), greater(twist(s21, s31, s22, s32), twist(s31, s41, s32, s42))));
    twisted = greater(twisted, greater(greater(twist(s02, s12, s03, s13), twist(s12, s22, s13, s23)), greater(twist(s22, s32, s23, s33), twist(s32, s42, s33, s43))));
    twisted = greater(twisted, greater(greater(twist(s03, s13, s04, s14), twist(s13, s23, s14, s24)), greater(twist(s23, s33, s24, s34), twist(s33, s43, s34, s44))));
    twists[k] = twisted;
    var low = min(min(min(b00, b10), min(b20, b30)), b40);
    low = min(low, min(min(min(b01, b11), min(b21, b31)), b41));
    low = min(low, min(min(min(b02, b12), min(b22, b32)), b42));
    low = min(low, min(min(min(b03, b13), min(b23, b33)), b43));
    low = min(low, min(min(min(b04, b14), min(b24, b34)), b44));
    var high = max(max(max(b00, b10), max(b20, b30)), b40);
    high = max(high, max(max(max(b01, b11), max(b21, b31)), b41));
    high = max(high, max(max(max(b02, b12), max(b22, b32)), b42));
    high = max(high, max(max(max(b03, b13), max(b23, b33)), b43));
    high = max(high, max(max(max(b04, b14), max(b24, b34)), b44));
    lows[k] = low;
    highs[k] = high;
    finest_bends[k] = finest;
    beyond[k] = of_bed;
}

// What may lie between the samples of a cell: see between.rs.
fn finish_cell(made: Made, k: u32) {
    let cell = vec2(i32(k % WIDE), i32(k / WIDE)) - vec2(AROUND);
    // As told by its own samples, and by those of nine cells of which it is one; the middle of these is the same for every block
    // that has it in its ring.
    let own = cell & vec2(i32(CELLS) - 1);
    let shift = select(vec2(0), vec2(1), own == vec2(i32(CELLS) - AROUND)) - select(vec2(0), vec2(1), own == vec2(AROUND - 1));
    var missed = 0.0;
    var tail = 3e38;
    for (var ring = 0; ring < 2; ring++) {
        let middle = cell + ring * shift;
        let before = square_centre(made, middle - vec2(ring), made.cell_half);
        let after = square_centre(made, middle + vec2(ring), made.cell_half);
        let is_on = on_lattice(before) && on_lattice(after);
        let corner = before - vec2(made.cell_half);
        let sides = metres_between(bitcast<vec2<i32>>(corner), bitcast<vec2<i32>>(after + vec2(made.cell_half)));
        let spacing = max(sides.x, sides.y) / f32(8 * ring + 4);
        let alone = unseen(ground_offset(border_point(corner), 0.5 * sides), sides, spacing);
        var bend = finest_bends[k];
        if ring == 0 {
            missed = select(0.0, alone, is_on);
            tail = TAIL * bend + missed;
        } else if is_on {
            for (var z = 0; z < 3; z++) {
                let row = (middle.y + z + AROUND - 1) * i32(WIDE) + middle.x + AROUND - 1;
                bend = greater(greater(bend, finest_bends[row]), greater(finest_bends[row + 1], finest_bends[row + 2]));
            }
            let wider = TAIL * bend + alone;
            tail = select(tail, wider, wider < tail);
        }
    }
    let low = lows[k];
    let high = highs[k];
    let of_bed = beyond[k];
    let most = BEYOND * of_bed + missed;
    // Where samples are under water ground may rise out of it between them.
    let dry = select(0.0, min(TAIL * of_bed + missed, high + most - detail.sea), low < detail.sea);
    tails[k] = greater(tail, dry);
    beyond[k] = most;
    let is_on = on_lattice(square_centre(made, cell, made.cell_half));
    let is_wanted = is_on && all(cell >= vec2(-2)) && all(cell <= vec2(i32(CELLS) + 1));
    lows[k] = select(EMPTY_LOW, low, is_wanted);
    highs[k] = select(-EMPTY_LOW, high, is_wanted);
}

// The interval of the drawn surface in a cell, of that of the samples of the bed and what is around.
fn widen_cell(made: Made, k: u32) {
    if lows[k] > highs[k] {
        return;
    }
    var most = 0.0;
    for (var z = 0u; z < 3u; z++) {
        let row = k - WIDE - 1u + z * WIDE;
        most = greater(greater(most, beyond[row]), greater(beyond[row + 1u], beyond[row + 2u]));
    }
    var low = max(lows[k] - most, detail.sea);
    var high = max(highs[k] + most, detail.sea);
    if !made.is_root {
        let cell = vec2(i32(k % WIDE), i32(k / WIDE)) - vec2(AROUND);
        let above = ringed_number(parent_cell(made, cell));
        low = max(low, bitcast<f32>(records[made.parent + CELL_LOWS + above]));
        high = min(high, bitcast<f32>(records[made.parent + CELL_HIGHS + above]));
    }
    lows[k] = low;
    highs[k] = high;
}

// Error at a vertex as it is nested, its place in half cells.
fn nested_at(made: Made, place: vec2<i32>) -> f32 {
    let at = vec2<u32>(2 * place + vec2(i32(BEFORE_BLOCK)));
    return samples[made.row + SAMPLE_COUNT + at.y * SAMPLES + at.x];
}

// Error of a mixed corner, in the ring too.
fn mixed_error(made: Made, corner: vec2<i32>) -> f32 {
    if made.is_root {
        return ALWAYS;
    }
    var error = nested_at(made, 2 * corner);
    // The cells of the parent before and after the side.
    let after = corner >> vec2(1u);
    let before = after - select(vec2(1, 0), vec2(0, 1), (corner.x & 1) == 1);
    for (var k = 0u; k < 2u; k++) {
        let own = select(before, after, k == 1u);
        if on_lattice(square_centre(made, 2 * own, 2u * made.cell_half)) {
            error = min(error, NEST * parent_error(made, own + vec2<i32>(made.inside)));
        }
    }
    return error;
}

fn mixed_at(corner: vec2<i32>) -> f32 {
    return mixed[(corner.y + 1) * i32(RINGED_CORNERS) + corner.x + 1];
}

// Error of the centre of a cell, of the ring of one too.
fn centre_error(made: Made, cell: vec2<i32>) -> f32 {
    if !on_lattice(square_centre(made, cell, made.cell_half)) {
        return 0.0;
    }
    let odd = cell + vec2(1) - (cell & vec2(1));
    let even = cell + (cell & vec2(1));
    let most = NEST * min(mixed_at(vec2(odd.x, even.y)), mixed_at(vec2(even.x, odd.y)));
    return min(nested_at(made, 2 * cell + vec2(1)), most);
}

// Lowest and highest of the n x n cells from one on.
fn around(first: vec2<i32>, n: i32) -> vec2<f32> {
    var low = EMPTY_LOW;
    var high = -EMPTY_LOW;
    for (var j = 0; j < n; j++) {
        for (var i = 0; i < n; i++) {
            let k = (first.y + j + AROUND) * i32(WIDE) + first.x + i + AROUND;
            low = min(low, lows[k]);
            high = max(high, highs[k]);
        }
    }
    return vec2(low, high);
}

fn put(made: Made, word: u32, value: f32, whose: u32) {
    put_bits(made.record + word, bitcast<u32>(value), whose);
}

fn ordered(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return select(bits | 0x80000000u, ~bits, (bits >> 31u) != 0u);
}

fn unordered(bits: u32) -> f32 {
    return bitcast<f32>(select(~bits, bits & 0x7fffffffu, (bits >> 31u) != 0u));
}

// Height of the bed at a vertex, in half cells.
fn height_at(made: Made, place: vec2<u32>) -> f32 {
    let sample = 2u * place + vec2(BEFORE_BLOCK);
    return samples[made.row + sample.y * SAMPLES + sample.x];
}

fn nest_of(made: Made) -> Nest {
    // Samples on the lattice, from three cells before the block on.
    let begin = bitcast<vec2<i32>>(made.origin) - vec2(i32(6u * made.cell_half));
    let step = i32(made.cell_half / 2u);
    let far = bitcast<vec2<i32>>(detail.roots << vec2(detail.depth + 1u));
    return Nest(made.row, max(-begin / step, vec2(0)), min((far - begin) / step, vec2(i32(SAMPLES) - 1)), begin, step);
}

// Errors of all vertices that stand on samples, in as many steps as halvings.
fn nest_all(nest: Nest, thread: u32) {
    for (var k = thread; k < middle_count(1u); k += GROUP) {
        nest_middle(nest, k, 1u);
    }
    storageBarrier();
    for (var k = thread; k < centre_count(1u); k += GROUP) {
        nest_centre(nest, k, 1u);
    }
    storageBarrier();
    for (var k = thread; k < middle_count(2u); k += GROUP) {
        nest_middle(nest, k, 2u);
    }
    storageBarrier();
    for (var k = thread; k < centre_count(2u); k += GROUP) {
        nest_centre(nest, k, 2u);
    }
    storageBarrier();
    for (var k = thread; k < middle_count(4u); k += GROUP) {
        nest_middle(nest, k, 4u);
    }
    storageBarrier();
}

@compute @workgroup_size(128)
fn make_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let slot = lists[made_list() + group.x];
    let head = heads[slot];
    let quarter = block_quarter(head.centre, head.half);
    let made = Made(
        sample_row(group.x),
        record_at(slot),
        record_at(head.parent),
        head.parent == NO_BLOCK,
        head.centre - vec2(head.half),
        head.half / CELLS,
        quarter_corner(quarter),
    );
    if thread == 0u {
        atomicStore(&largest, 0u);
        atomicStore(&lowest, 0xffffffffu);
        atomicStore(&highest, 0u);
        atomicStore(&all_taken_by, 0u);
    }
    for (var k = thread; k < WIDE_COUNT; k += GROUP) {
        look_at_cell(made.row, k);
    }
    workgroupBarrier();
    for (var k = thread; k < WIDE_COUNT; k += GROUP) {
        finish_cell(made, k);
    }
    let nest = nest_of(made);
    let uneven = select(0u, SAMPLE_COUNT, has_border(nest));
    for (var k = thread; k < uneven; k += GROUP) {
        put_uneven(nest, k);
    }
    storageBarrier();
    workgroupBarrier();
    for (var k = thread; k < WIDE_COUNT; k += GROUP) {
        widen_cell(made, k);
    }
    nest_all(nest, thread);
    for (var k = thread; k < 361u; k += GROUP) {
        let corner = vec2(i32(k % RINGED_CORNERS), i32(k / RINGED_CORNERS)) - vec2(1);
        var error = 0.0;
        if ((corner.x ^ corner.y) & 1) == 1 {
            error = mixed_error(made, corner);
        }
        mixed[k] = error;
    }
    workgroupBarrier();
    for (var k = thread; k < RINGED_COUNT; k += GROUP) {
        let cell = vec2(i32(k % RINGED), i32(k / RINGED)) - vec2(1);
        let wide = (cell.y + AROUND) * i32(WIDE) + cell.x + AROUND;
        let cut_by = cutters(cell);
        put(made, CELL_LOWS + k, lows[wide], cut_by);
        put(made, CELL_HIGHS + k, highs[wide], cut_by);
        let error = centre_error(made, cell);
        if all(cell >= vec2(0)) && all(cell < vec2(i32(CELLS))) {
            let place = bitcast<vec2<u32>>(2 * cell + vec2(1));
            let number = number_at(place);
            let interval = around(cell - vec2(1), 3);
            let copied = copiers(place);
            put(made, HEIGHTS + number, height_at(made, place), copied);
            put(made, ERRORS + number, error, copied | cut_by);
            put(made, LOWS + number, interval.x, copied);
            put(made, HIGHS + number, interval.y, copied);
        } else {
            put(made, RING_ERRORS + ring_number(cell), error, cut_by);
        }
    }
    var greatest = 0.0;
    var low = EMPTY_LOW;
    var high = -EMPTY_LOW;
    for (var k = thread; k < CORNER_COUNT; k += GROUP) {
        let corner = vec2(k % CORNERS, k / CORNERS);
        let cell = vec2<i32>(corner);
        let is_mixed = ((corner.x ^ corner.y) & 1u) == 1u;
        if is_mixed || made.is_root {
            let interval = around(cell - vec2(2), 4);
            var error = ALWAYS;
            if is_mixed {
                error = mixed_at(cell);
                greatest = greater(greatest, error);
                low = min(low, interval.x);
                high = max(high, interval.y);
            }
            let copied = copiers(2u * corner);
            put(made, HEIGHTS + k, height_at(made, 2u * corner), copied);
            put(made, ERRORS + k, error, copied);
            put(made, LOWS + k, interval.x, copied);
            put(made, HIGHS + k, interval.y, copied);
        } else {
            copy_corner(made.record, made.parent, made.inside, corner);
        }
    }
    atomicOr(&all_taken_by, taken_by);
    atomicMax(&largest, bitcast<u32>(greatest));
    atomicMin(&lowest, ordered(low));
    atomicMax(&highest, ordered(high));
    workgroupBarrier();
    if thread == 0u {
        heads[slot].mixed_error = bitcast<f32>(atomicLoad(&largest));
        heads[slot].low = unordered(atomicLoad(&lowest));
        heads[slot].high = unordered(atomicLoad(&highest));
        heads[slot].others = atomicLoad(&all_taken_by) | atomicLoad(&counts[SLOPES + group.x]);
    }
}
