#define_import_path dolomite::detail::errors

// How far the meshes of a cell are from its samples. CPU reference: plugins/ground/src/detail/errors.rs;
// what comes of it is derived in cell.rs.

// Steps between samples along a side, samples along it, the one in its middle, and samples of a cell.
const STEPS: u32 = 8u;
const SAMPLES: u32 = 9u;
const MIDDLE: u32 = 4u;
const COUNT: u32 = 81u;
// What may lie between samples, as a multiple of the finest second difference.
const TAIL: f32 = 1.5;
// Share by which a bed's error counts.
const BED_SHARE: f32 = 0.5;
// Error of a height as a share of the largest.
const ROUNDING: f32 = 6e-7;

// Corners 0 to 3 of a square of samples, its middle, and through which corner its diagonal goes.
struct Square {
    nw: vec2<f32>,
    ne: vec2<f32>,
    se: vec2<f32>,
    sw: vec2<f32>,
    middle: vec2<f32>,
    outer: u32,
}

// What a sample is off the square as two triangles, and off the quarter that it lies in, and which that is.
struct Off {
    halves: f32,
    quarters: f32,
    side: u32,
}

fn residual(off: vec2<f32>) -> f32 {
    return max(abs(off.x), BED_SHARE * abs(off.y));
}

// Interpolated over two triangles: corners 0 to 3 of the square, place u, v, the diagonal through the
// corner `outer`.
fn on_halves(c0: vec2<f32>, c1: vec2<f32>, c2: vec2<f32>, c3: vec2<f32>, u: f32, v: f32, outer: u32) -> vec2<f32> {
    if (outer & 1u) == 0u {
        let bend = select(c3, c1, u > v);
        return c0 + (bend - c0) * max(u, v) + (c2 - bend) * min(u, v);
    }
    let before = u + v < 1.0;
    let bend = select(c2, c0, before);
    let west = 1.0 - u;
    let first = select(v, west, before);
    let second = select(west, v, before);
    return c1 + (bend - c1) * first + (c3 - bend) * second;
}

// The side at whose triangle a place lies: dx, dz about the middle, -1 to 1.
fn side_of(dx: f32, dz: f32) -> u32 {
    if abs(dx) > abs(dz) {
        return select(2u, 0u, dx < 0.0);
    }
    return select(3u, 1u, dz < 0.0);
}

// Interpolated over the triangle between the middle and a side, from corner a to corner b.
fn on_quarter(middle: vec2<f32>, a: vec2<f32>, b: vec2<f32>, out: f32, along: f32) -> vec2<f32> {
    return middle * (1.0 - out) + (a + b) * (0.5 * out) + (b - a) * (0.5 * along);
}

// The sample at a place in the square, 0 to 1.
fn off(square: Square, sample: vec2<f32>, u: f32, v: f32) -> Off {
    let halves = residual(sample - on_halves(square.nw, square.ne, square.se, square.sw, u, v, square.outer));
    let dx = 2.0 * u - 1.0;
    let dz = 2.0 * v - 1.0;
    let side = side_of(dx, dz);
    // From corner side - 1 to corner side.
    let upright = (side & 1u) == 0u;
    let second = side >= 2u;
    let a = select(select(square.nw, square.se, second), select(square.sw, square.ne, second), upright);
    let b = select(select(square.ne, square.sw, second), select(square.nw, square.se, second), upright);
    let along = select(select(dx, -dx, second), select(-dz, dz, second), upright);
    let quarter = on_quarter(square.middle, a, b, max(abs(dx), abs(dz)), along);
    return Off(halves, residual(sample - quarter), side);
}

// How far a sample lies from the middle between two others.
fn second_difference(sample: vec2<f32>, a: vec2<f32>, b: vec2<f32>) -> f32 {
    return residual(sample - 0.5 * (a + b));
}

// The same of heights of the bed.
fn bend_of_bed(middle: f32, a: f32, b: f32) -> f32 {
    return abs(0.5 * ((middle - a) + (middle - b)));
}
