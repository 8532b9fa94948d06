#define_import_path dolomite::detail::errors

// Error bounds of a cell from its samples: the twin of Cell::new in
// plugins/tessellation/src/detail/cell.rs, where they are derived.

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

// Samples of all squares that a cell is cut into: one of 8 steps, four of 4, sixteen of 2.
const ERRORS: u32 = 325u;

// A sample of a square.
struct Place {
    // Where the square begins, and its steps.
    corner: vec2<u32>,
    size: u32,
    // Where the sample stands in it.
    sample: vec2<u32>,
}

fn error_place(k: u32) -> Place {
    if k < 81u {
        return Place(vec2(0u), 8u, vec2(k % 9u, k / 9u));
    }
    if k < 181u {
        let square = (k - 81u) / 25u;
        let sample = (k - 81u) % 25u;
        return Place(4u * vec2(square & 1u, square >> 1u), 4u, vec2(sample % 5u, sample / 5u));
    }
    let square = (k - 181u) / 9u;
    let sample = (k - 181u) % 9u;
    return Place(2u * vec2(square & 3u, square >> 2u), 2u, vec2(sample % 3u, sample / 3u));
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
