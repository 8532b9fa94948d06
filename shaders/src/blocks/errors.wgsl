#define_import_path dolomite::blocks::errors

// How far triangles are from the samples in them. CPU reference: plugins/ground/src/blocks/triangle.rs. A sample is two heights:
// of the drawn surface, and of the bed as far as it is seen, whose errors count by half.

#import dolomite::blocks::samples::{SAMPLES, surface}

const BED_SHARE: f32 = 0.5;
// What may lie between samples, as a multiple of the largest second difference of neighbouring ones.
const TAIL: f32 = 0.9;
// By how much ground may lie beyond samples, as a multiple of the same.
const BEYOND: f32 = 4.0;

// The greater; what is not a number counts as nothing.
fn greater(a: f32, b: f32) -> f32 {
    return select(a, b, b > a);
}

fn residual(off: vec2<f32>) -> f32 {
    return greater(abs(off.x), BED_SHARE * abs(off.y));
}

// How far a sample lies from the middle between two others.
fn bend(middle: vec2<f32>, a: vec2<f32>, b: vec2<f32>) -> f32 {
    return residual(0.5 * ((middle - a) + (middle - b)));
}

// The same of heights of the bed.
fn bend_of_bed(middle: f32, a: f32, b: f32) -> f32 {
    return abs(0.5 * ((middle - a) + (middle - b)));
}

// How far the bilinear surface between four samples is from its two triangles at most: a quarter of its twist.
fn twist(nw: vec2<f32>, ne: vec2<f32>, sw: vec2<f32>, se: vec2<f32>) -> f32 {
    return 0.25 * residual((se - sw) - (ne - nw));
}

// Largest distance of samples from the half of a cell: right angle at a sample, legs of n steps along x and along z, each
// step a difference of sample numbers that wraps.
fn half_error(corner: u32, n: u32, dx: u32, dz: u32) -> f32 {
    let base = surface(corner);
    let unit = 1.0 / f32(n);
    let x = surface(corner + n * dx) - base;
    let z = surface(corner + n * dz) - base;
    var largest = 0.0;
    for (var l = 0u; l < n; l++) {
        for (var k = 0u; k <= n - l; k++) {
            let off = (surface(corner + k * dx + l * dz) - base) - (f32(k) * unit) * x - (f32(l) * unit) * z;
            largest = greater(largest, residual(off));
        }
    }
    return largest;
}

// The same of the triangle with its right angle at `apex` and its long side `half` steps away: `out` is a step towards the
// side, `along` one along it.
fn side_error(apex: u32, half: u32, out: u32, along: u32) -> f32 {
    let base = surface(apex);
    let unit = 0.5 / f32(half);
    let first = apex + half * out - half * along;
    let a = surface(first) - base;
    let b = surface(first + 2u * half * along) - base;
    var largest = 0.0;
    for (var r = 1u; r <= half; r++) {
        for (var t = 0u; t <= 2u * r; t++) {
            let sample = surface(apex + r * out + t * along - r * along);
            let off = (sample - base) - (f32(2u * r - t) * unit) * a - (f32(t) * unit) * b;
            largest = greater(largest, residual(off));
        }
    }
    return largest;
}
