#define_import_path dolomite::blocks::nest

// Nested errors of the vertices that stand on samples, from the finest up. CPU reference:
// plugins/ground/src/blocks/errors.rs, where they are derived.

#import dolomite::blocks::errors::{greater, half_error, side_error}
#import dolomite::blocks::record::GROWTH
#import dolomite::blocks::samples::{BEFORE_BLOCK, SAMPLES, SAMPLE_COUNT, WIDE, samples}

// What may lie between samples in each of the wide cells, metres.
var<workgroup> tails: array<f32, 484>;
// How far bilinear surfaces between samples are from their triangles.
var<workgroup> twists: array<f32, 484>;

struct Nest {
    // The block's samples.
    row: u32,
    // First and last sample that is on the lattice.
    first: vec2<i32>,
    last: vec2<i32>,
    // Lattice line of the first, and lines between two.
    origin: vec2<i32>,
    step: i32,
}

fn is_inside(nest: Nest, at: vec2<i32>) -> bool {
    return all(at >= nest.first) && all(at <= nest.last);
}

fn sample_at(nest: Nest, at: vec2<i32>) -> u32 {
    return nest.row + u32(at.y) * SAMPLES + u32(at.x);
}

// The error at a sample; 0 beyond them.
fn known(nest: Nest, at: vec2<i32>) -> f32 {
    if any(at < vec2(0)) || any(at >= vec2(i32(SAMPLES))) {
        return 0.0;
    }
    return samples[sample_at(nest, at) + SAMPLE_COUNT];
}

fn number_of(cell: vec2<i32>) -> i32 {
    return cell.y * i32(WIDE) + cell.x;
}

// The greatest tail, and the greatest twist, of the cells that a vertex touches, beyond the lattice too.
fn between_at(at: vec2<i32>) -> vec2<f32> {
    var most = vec2(0.0);
    for (var k = 0u; k < 4u; k++) {
        let cell = (at - vec2(i32(k & 1u), i32(k >> 1u))) >> vec2(2u);
        if all(cell >= vec2(0)) && all(cell < vec2(i32(WIDE))) {
            let number = number_of(cell);
            most = vec2(greater(most.x, tails[number]), greater(most.y, twists[number]));
        }
    }
    return most;
}

fn put(nest: Nest, at: vec2<i32>, even: f32, finer: f32, tail: f32) {
    let number = sample_at(nest, at) + SAMPLE_COUNT;
    // Where samples stand unevenly the own error is known already, else it is below 0: see uneven.wgsl.
    let uneven = samples[number];
    let own = select(even, uneven, uneven >= 0.0);
    samples[number] = greater(own + tail, GROWTH * finer);
}

// How many samples are mixed corners of cells of 2 `half` steps, about twice as many as half the grid.
fn middle_count(half: u32) -> u32 {
    let grid = 88u / half + 1u;
    return grid * ((grid + 1u) / 2u);
}

// The k-th mixed corner of cells of 2 `half` steps.
fn nest_middle(nest: Nest, k: u32, half: u32) {
    let grid = 88u / half + 1u;
    let row_length = (grid + 1u) / 2u;
    let b = k / row_length;
    let a = 2u * (k % row_length) + 1u - (b & 1u);
    if a >= grid {
        return;
    }
    let step = i32(half);
    let at = vec2(i32(a), i32(b)) * step;
    if !is_inside(nest, at) {
        samples[sample_at(nest, at) + SAMPLE_COUNT] = 0.0;
        return;
    }
    // Whether x is the odd multiple: the side runs along x.
    let level = ((a + BEFORE_BLOCK / half) & 1u) == 1u;
    let along = select(vec2(0, step), vec2(step, 0), level);
    let out = select(vec2(step, 0), vec2(0, step), level);
    let along_number = select(SAMPLES, 1u, level);
    let out_number = select(1u, SAMPLES, level);
    let ends = is_inside(nest, at - along) && is_inside(nest, at + along);
    var own = 0.0;
    // The apex before the side, and the one after it.
    let here = sample_at(nest, at);
    if ends && is_inside(nest, at - out) {
        own = side_error(here - half * out_number, half, out_number, along_number);
    }
    if ends && is_inside(nest, at + out) {
        own = greater(own, side_error(here + half * out_number, half, 0u - out_number, along_number));
    }
    let between = between_at(at);
    var finer = greater(between.x, between.y);
    if half > 1u {
        let quarter = step / 2;
        finer = greater(
            greater(known(nest, at + vec2(-quarter, -quarter)), known(nest, at + vec2(quarter, -quarter))),
            greater(known(nest, at + vec2(quarter, quarter)), known(nest, at + vec2(-quarter, quarter))),
        );
    }
    put(nest, at, own, finer, between.x);
}

fn centre_count(half: u32) -> u32 {
    let grid = 44u / half;
    return grid * grid;
}

// The k-th centre of cells of 2 `half` steps.
fn nest_centre(nest: Nest, k: u32, half: u32) {
    let grid = 44u / half;
    let cell = vec2(k % grid, k / grid);
    let step = i32(half);
    let at = vec2<i32>(cell) * (2 * step) + vec2(step);
    if !is_inside(nest, at - vec2(step)) || !is_inside(nest, at + vec2(step)) {
        samples[sample_at(nest, at) + SAMPLE_COUNT] = 0.0;
        return;
    }
    // Cells are counted from three of the block's cells before it.
    let even = ((cell.x + cell.y + 2u * (BEFORE_BLOCK / (2u * half))) & 1u) == 0u;
    let here = sample_at(nest, at);
    let north = here - half * SAMPLES;
    let south = here + half * SAMPLES;
    // Right angles in the north-east and the south-west, or in the north-west and the south-east.
    let n = 2u * half;
    let first = half_error(select(north - half, north + half, even), n, select(1u, 0xffffffffu, even), SAMPLES);
    let second = half_error(select(south + half, south - half, even), n, select(0xffffffffu, 1u, even), 0u - SAMPLES);
    let finer = greater(
        greater(known(nest, at - vec2(step, 0)), known(nest, at - vec2(0, step))),
        greater(known(nest, at + vec2(step, 0)), known(nest, at + vec2(0, step))),
    );
    put(nest, at, greater(first, second), finer, between_at(at).x);
}
