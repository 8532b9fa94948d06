#define_import_path dolomite::blocks::uneven

// Own errors of triangles in which samples do not stand evenly: beside the border of a lattice that stands on the samples of a
// map. CPU reference: uneven in plugins/ground/src/blocks/triangle.rs, where it is derived.

#import dolomite::detail::bindings::detail
#import dolomite::blocks::border::{last_begin, metres_between, moved_x, moved_z}
#import dolomite::blocks::errors::{BED_SHARE, greater}
#import dolomite::blocks::nest::{Nest, is_inside, sample_at}
#import dolomite::blocks::samples::{BEFORE_BLOCK, SAMPLES, SAMPLE_COUNT, samples, surface}
#import dolomite::terrain::fixed::{Fixed, fixed_metres, fixed_sub}

// From which share of a step on two steps are not the same.
const EVEN: f32 = 1e-3;
// How far outside of a triangle a sample still counts, as a share of it.
const BESIDE: f32 = 1e-4;

fn line_at(nest: Nest, at: vec2<i32>) -> vec2<i32> {
    return nest.origin + at * nest.step;
}

fn longer(after: Fixed, before: Fixed) -> f32 {
    return fixed_metres(fixed_sub(after, before));
}

// Whether the first step between two samples is as long as the last, along both axes.
fn is_even(nest: Nest, low: vec2<i32>, high: vec2<i32>) -> bool {
    let a = line_at(nest, low);
    let b = line_at(nest, low + vec2(1));
    let c = line_at(nest, high - vec2(1));
    let d = line_at(nest, high);
    let x = longer(moved_x(d.x), moved_x(c.x)) - longer(moved_x(b.x), moved_x(a.x));
    let z = longer(moved_z(d.y), moved_z(c.y)) - longer(moved_z(b.y), moved_z(a.y));
    let step = vec2(fixed_metres(Fixed(detail.step_x.x, detail.step_x.y)), fixed_metres(Fixed(detail.step_z.x, detail.step_z.y)));
    return all(abs(vec2(x, z)) < EVEN * f32(nest.step) * step);
}

fn cross_of(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

// How much the ends count at a place, all relative to the apex.
fn weights_of(place: vec2<f32>, a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2(cross_of(place, b), cross_of(a, place)) / cross_of(a, b);
}

fn is_in(weights: vec2<f32>) -> bool {
    return min(min(weights.x, weights.y), 1.0 - weights.x - weights.y) > -BESIDE;
}

fn greater_of_each(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return select(a, b, b > a);
}

// Of the triangle between three samples, as the vertex `middle` that cuts the side between the last two sees it.
fn uneven_error(nest: Nest, apex: vec2<i32>, first: vec2<i32>, last: vec2<i32>, middle: vec2<i32>) -> f32 {
    let low = min(min(apex, first), last);
    let high = max(max(apex, first), last);
    let base = surface(sample_at(nest, apex));
    let to_first = surface(sample_at(nest, first)) - base;
    let to_last = surface(sample_at(nest, last)) - base;
    let from_apex = line_at(nest, apex);
    let a = metres_between(from_apex, line_at(nest, first));
    let b = metres_between(from_apex, line_at(nest, last));
    let lattice_a = vec2<f32>(first - apex);
    let lattice_b = vec2<f32>(last - apex);
    var largest = vec2(0.0);
    for (var z = low.y; z <= high.y; z++) {
        for (var x = low.x; x <= high.x; x++) {
            let at = vec2(x, z);
            let weights = weights_of(metres_between(from_apex, line_at(nest, at)), a, b);
            if is_in(weights) || is_in(weights_of(vec2<f32>(at - apex), lattice_a, lattice_b)) {
                let off = (surface(sample_at(nest, at)) - base) - weights.x * to_first - weights.y * to_last;
                largest = greater_of_each(largest, abs(off));
            }
        }
    }
    let weights = weights_of(metres_between(from_apex, line_at(nest, middle)), a, b);
    let mean = abs(0.5 * (to_first + to_last) - weights.x * to_first - weights.y * to_last);
    largest += mean;
    return greater(largest.x, BED_SHARE * largest.y);
}

// Whether samples may stand unevenly about a block: a border lies within them.
fn has_border(nest: Nest) -> bool {
    let begin = line_at(nest, nest.first);
    let end = line_at(nest, nest.last);
    let first = vec2(bitcast<i32>(detail.border));
    let last = vec2(last_begin(detail.roots.x), last_begin(detail.roots.y));
    let has = any((begin < first) & (first < end)) || any((begin < last) & (last < end));
    return detail.border > 0u && has;
}

// Writes the own error of a sample's vertex where one of the triangles that it cuts is uneven.
fn put_uneven(nest: Nest, k: u32) {
    let at = vec2(i32(k % SAMPLES), i32(k / SAMPLES));
    // As many as would be from a corner of a cell of 16 steps on.
    let from_cell = bitcast<vec2<u32>>(at) + vec2(16u - BEFORE_BLOCK);
    let twos = vec2(countTrailingZeros(from_cell.x | 16u), countTrailingZeros(from_cell.y | 16u));
    let least = min(twos.x, twos.y);
    let is_centre = twos.x == twos.y;
    if least > select(2u, 1u, is_centre) {
        return;
    }
    let half = i32(1u << least);
    // Along the side and across it; of a centre along both ways.
    var along = select(vec2(0, half), vec2(half, 0), twos.x < twos.y);
    var across = along.yx;
    if is_centre {
        let cell = from_cell >> vec2(least + 1u);
        let even = ((cell.x + cell.y) & 1u) == 0u;
        // The diagonal from north-west to south-east, or the other one; the right angles beside it.
        along = select(vec2(half, -half), vec2(half, half), even);
        across = vec2(along.x, -along.y);
    }
    var own = 0.0;
    var even = true;
    for (var side = 0u; side < 2u; side++) {
        let apex = at + select(across, -across, side == 0u);
        let first = at - along;
        let last = at + along;
        if !is_inside(nest, apex) || !is_inside(nest, first) || !is_inside(nest, last) {
            continue;
        }
        let low = min(min(apex, first), last);
        let high = max(max(apex, first), last);
        even = even && is_even(nest, low, high);
        own = greater(own, uneven_error(nest, apex, first, last, at));
    }
    if !even {
        samples[nest.row + SAMPLE_COUNT + k] = own;
    }
}
