#define_import_path dolomite::stage::level

// From the levels that a control function wrote to the levels that count. CPU reference:
// plugins/tessellation/src/level.rs. Numbers are read by their bits, so that NaN, infinities
// and denormals mean the same on a GPU that flushes or assumes them away.

#import dolomite::stage::types::{Levels, Rules, Shape, ONE, EQUAL, FRACTIONAL_EVEN, FRACTIONAL_ODD, TRIANGLES, QUADS, ISOLINES, D3D}

// Number of segments of a level: rounded up to an integer, even integer or odd integer.
fn segments(level: u32, spacing: u32) -> u32 {
    let even = 2u * ((level + 2u * ONE - 1u) >> 24u);
    let odd = 2u * ((level + 3u * ONE - 1u) >> 24u) - 1u;
    let equal = (level + ONE - 1u) >> 23u;
    return select(select(odd, even, spacing == FRACTIONAL_EVEN), equal, spacing == EQUAL);
}

// Whether an outer level discards its patch: not positive, or NaN.
fn discards(level: u32) -> bool {
    return level == 0u || level > 0x7f800000u;
}

// Clamps and rounds a level, given by its bits; what is no positive number gives the least.
fn clamp_level(bits: u32, spacing: u32, mode: u32) -> u32 {
    let least = select(ONE, 2u * ONE, spacing == FRACTIONAL_EVEN);
    let greatest = select(64u * ONE, 63u * ONE, spacing == FRACTIONAL_ODD);
    if bits < 0x3f800000u || bits > 0x7f800000u {
        return least;
    }
    let exponent = (bits >> 23u) - 127u;
    if exponent >= 6u {
        return greatest;
    }
    let exact = ((bits & (ONE - 1u)) | ONE) << exponent;
    var level = exact;
    if spacing == EQUAL {
        level = ((exact + ONE - 1u) >> 23u) << 23u;
    } else if mode == D3D {
        // To nearest even in 16.16, of which half is taken, rounded up.
        let nearest = (exact + 63u + ((exact >> 7u) & 1u)) >> 7u;
        level = ((nearest + 1u) >> 1u) << 8u;
    }
    return clamp(level, least, greatest);
}

// Least inner level where anything is above 1: "1 + epsilon, then rounded".
fn above_one(spacing: u32, mode: u32) -> u32 {
    return select(2u * ONE, select(ONE + 1u, ONE + 256u, mode == D3D), spacing == FRACTIONAL_ODD);
}

// The shape of levels that are clamped already; isolines carry their lines in outer.x.
fn shape_from_levels(rules: Rules, outer: vec4<u32>, inner: vec2<u32>) -> Shape {
    var shape: Shape;
    shape.outer = outer;
    shape.inner = inner;
    let lines = rules.domain == ISOLINES;
    shape.sides = vec4(
        segments(outer.x, select(rules.spacing, EQUAL, lines)),
        segments(outer.y, rules.spacing),
        segments(outer.z, rules.spacing),
        segments(outer.w, rules.spacing),
    );
    shape.rows = vec2(segments(inner.x, rules.spacing), segments(inner.y, rules.spacing));
    return shape;
}

// Lifts inner levels above 1 where anything else is above 1.
fn lift_inner(rules: Rules, outer: vec4<u32>, inner: vec2<u32>) -> vec2<u32> {
    var greatest = max(max(outer.x, outer.y), max(inner.x, inner.y));
    greatest = max(greatest, max(outer.z, outer.w));
    if greatest > ONE {
        return max(inner, vec2(above_one(rules.spacing, rules.mode)));
    }
    return inner;
}

// Whether the patch is discarded.
fn discarded(rules: Rules, bits: vec4<u32>) -> bool {
    var discard_it = discards(bits.x) || discards(bits.y);
    if rules.domain != ISOLINES {
        discard_it = discard_it || discards(bits.z);
    }
    if rules.domain == QUADS {
        discard_it = discard_it || discards(bits.w);
    }
    return discard_it;
}

// Outer levels, clamped; those that the domain does not have are 1.
fn clamp_outer(rules: Rules, bits: vec4<u32>) -> vec4<u32> {
    let lines = rules.domain == ISOLINES;
    var outer = vec4(ONE);
    outer.x = clamp_level(bits.x, select(rules.spacing, EQUAL, lines), rules.mode);
    outer.y = clamp_level(bits.y, rules.spacing, rules.mode);
    if !lines {
        outer.z = clamp_level(bits.z, rules.spacing, rules.mode);
    }
    if rules.domain == QUADS {
        outer.w = clamp_level(bits.w, rules.spacing, rules.mode);
    }
    return outer;
}

// Inner levels, clamped, not yet lifted.
fn clamp_inner(rules: Rules, bits: vec2<u32>) -> vec2<u32> {
    let u = clamp_level(bits.x, rules.spacing, rules.mode);
    let v = clamp_level(bits.y, rules.spacing, rules.mode);
    return vec2(u, select(v, u, rules.domain == TRIANGLES));
}
