#define_import_path dolomite::terrain::fixed

// Ground positions and lattice coordinates in 32.32 fixed point. CPU reference:
// plugins/terrain/src/ground.rs and noise/coordinate.rs, bit for bit. All arithmetic wraps.

// Metres (x, z): whole metres, rounded down, and the rest in steps of 2^-32 m.
struct GroundPoint {
    cell: vec2<i32>,
    frac: vec2<u32>,
}

// One axis of either: whole units (two's complement) and steps of 2^-32.
struct Fixed {
    whole: u32,
    rest: u32,
}

const STEPS: f32 = 4294967296.0; // 2^32
const STEP: f32 = 2.3283064e-10; // 2^-32
const FRACTION_STEP: f32 = 5.9604645e-8; // 2^-24

// The 64 bits of a * b, low word first. WGSL has no wide product.
fn mul_wide(a: u32, b: u32) -> vec2<u32> {
    let a0 = a & 0xffffu;
    let a1 = a >> 16u;
    let b0 = b & 0xffffu;
    let b1 = b >> 16u;
    let p00 = a0 * b0;
    let p01 = a0 * b1;
    let p10 = a1 * b0;
    let middle = (p00 >> 16u) + (p01 & 0xffffu) + (p10 & 0xffffu);
    return vec2(
        (p00 & 0xffffu) | (middle << 16u),
        a1 * b1 + (p01 >> 16u) + (p10 >> 16u) + (middle >> 16u),
    );
}

fn fixed_add(a: Fixed, b: Fixed) -> Fixed {
    let rest = a.rest + b.rest;
    return Fixed(a.whole + b.whole + select(0u, 1u, rest < a.rest), rest);
}

fn fixed_sub(a: Fixed, b: Fixed) -> Fixed {
    return Fixed(a.whole - b.whole - select(0u, 1u, a.rest < b.rest), a.rest - b.rest);
}

// position * mantissa * 2^-shift, rounded down: lattice coordinate of a position in metres.
// mantissa in 2^31 .. 2^32, shift in 21 ..= 62.
fn coordinate(position: Fixed, mantissa: u32, shift: u32) -> Fixed {
    let low = mul_wide(position.rest, mantissa);
    let high = mul_wide(position.whole, mantissa);
    // A negative whole part was taken 2^32 too large.
    let borrowed = select(0u, mantissa, (position.whole >> 31u) != 0u);
    let w0 = low.x;
    let w1 = low.y + high.x;
    let w2 = high.y + select(0u, 1u, w1 < low.y) - borrowed;
    if shift < 32u {
        let up = 32u - shift;
        return Fixed((w1 >> shift) | (w2 << up), (w0 >> shift) | (w1 << up));
    }
    if shift == 32u {
        return Fixed(w2, w1);
    }
    let down = shift - 32u;
    return Fixed(bitcast<u32>(bitcast<i32>(w2) >> down), (w1 >> down) | (w2 << (32u - down)));
}

// Fraction of a cell, 0 up to 1, cut to 2^-24, hence exact in f32.
fn fraction(at: Fixed) -> f32 {
    return f32(at.rest >> 8u) * FRACTION_STEP;
}

fn ground_x(p: GroundPoint) -> Fixed {
    return Fixed(bitcast<u32>(p.cell.x), p.frac.x);
}

fn ground_z(p: GroundPoint) -> Fixed {
    return Fixed(bitcast<u32>(p.cell.y), p.frac.y);
}

fn ground_point(x: Fixed, z: Fixed) -> GroundPoint {
    return GroundPoint(vec2(bitcast<i32>(x.whole), bitcast<i32>(z.whole)), vec2(x.rest, z.rest));
}

fn fixed_negate(a: Fixed) -> Fixed {
    return Fixed(~a.whole + select(0u, 1u, a.rest == 0u), ~a.rest + 1u);
}

// Metres, below 2^31 either way, rounded down: exact but for the part below 2^-32. The sign is
// taken off first, so that the rest of a small negative number is exact too.
fn metres_fixed(metres: f32) -> Fixed {
    let size = abs(metres);
    let whole = floor(size);
    let steps = (size - whole) * STEPS;
    if metres >= 0.0 {
        return Fixed(u32(whole), u32(steps));
    }
    return fixed_negate(Fixed(u32(whole), u32(ceil(steps))));
}

// Metres as f32, one rounding for the whole part and one for the sum.
fn fixed_metres(a: Fixed) -> f32 {
    return f32(bitcast<i32>(a.whole)) + f32(a.rest) * STEP;
}

fn ground_offset(p: GroundPoint, metres: vec2<f32>) -> GroundPoint {
    return ground_point(
        fixed_add(ground_x(p), metres_fixed(metres.x)),
        fixed_add(ground_z(p), metres_fixed(metres.y)),
    );
}

// a - b in metres.
fn ground_difference(a: GroundPoint, b: GroundPoint) -> vec2<f32> {
    return vec2(
        fixed_metres(fixed_sub(ground_x(a), ground_x(b))),
        fixed_metres(fixed_sub(ground_z(a), ground_z(b))),
    );
}

// p - anchor in metres; anchor in whole metres.
fn ground_relative(p: GroundPoint, anchor: vec2<i32>) -> vec2<f32> {
    return ground_difference(p, GroundPoint(anchor, vec2(0u)));
}
