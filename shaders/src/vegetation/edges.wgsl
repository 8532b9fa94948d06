#define_import_path dolomite::vegetation::edges

// Which triangle holds a place, exactly: corners and places in whole steps of 2^-12 m seen from above. A place on an
// edge or a corner belongs to one of the triangles that meet there, as if it stood a hair to a side that is the same
// for all. CPU reference: plugins/vegetation/src/render/edges.rs.

#import dolomite::terrain::fixed::mul_wide

const STEPS: f32 = 4096.0;
const STEP: f32 = 0.000244140625;
// Farthest that a corner counts, metres: differences of two fit 32 bits.
const FARTHEST: f32 = 131072.0;

fn to_steps(metres: vec2<f32>) -> vec2<i32> {
    return vec2<i32>(round(clamp(metres, vec2(-FARTHEST), vec2(FARTHEST)) * STEPS));
}

fn to_metres(steps: vec2<i32>) -> vec2<f32> {
    return vec2<f32>(steps) * STEP;
}

// a * b in 64 bits, two's complement, low word first.
fn product(a: i32, b: i32) -> vec2<u32> {
    let size = mul_wide(u32(abs(a)), u32(abs(b)));
    if (a < 0) == (b < 0) {
        return size;
    }
    let low = ~size.x + 1u;
    return vec2(low, ~size.y + select(0u, 1u, low == 0u));
}

// Sign of a * b - c * d.
fn sign_of(a: i32, b: i32, c: i32, d: i32) -> i32 {
    let left = f32(a) * f32(b);
    let right = f32(c) * f32(d);
    // Each is off by three roundings of f32 at most.
    let off = (abs(left) + abs(right)) * 4.8e-7;
    if abs(left - right) > off {
        return select(-1, 1, left > right);
    }
    let p = product(a, b);
    let q = product(c, d);
    if p.y != q.y {
        return select(-1, 1, bitcast<i32>(p.y) > bitcast<i32>(q.y));
    }
    if p.x != q.x {
        return select(-1, 1, p.x > q.x);
    }
    return 0;
}

// On which side of the way from a to b a place lies: 1 where the triangle is.
fn side_of(a: vec2<i32>, b: vec2<i32>, p: vec2<i32>) -> i32 {
    let along = b - a;
    let to = p - a;
    return sign_of(along.x, to.y, along.y, to.x);
}

// Whether a place on the line belongs to this side.
fn owns(along: vec2<i32>) -> bool {
    return along.y > 0 || (along.y == 0 && along.x < 0);
}

fn is_within(a: vec2<i32>, b: vec2<i32>, p: vec2<i32>) -> bool {
    let side = side_of(a, b, p);
    return side > 0 || (side == 0 && owns(b - a));
}

// Of a triangle that goes round so that its own side is the positive one.
fn holds(a: vec2<i32>, b: vec2<i32>, c: vec2<i32>, p: vec2<i32>) -> bool {
    return is_within(a, b, p) && is_within(b, c, p) && is_within(c, a, p);
}

// Whether no place of a square belongs to the triangle because an edge has all of it outside; safe against rounding.
fn is_beside(a: vec2<i32>, b: vec2<i32>, least: vec2<i32>, most: vec2<i32>) -> bool {
    let along = vec2<f32>(b - a);
    // The corner farthest in.
    let near = vec2<f32>(vec2(select(most.x, least.x, along.y > 0.0), select(least.y, most.y, along.x > 0.0)) - a);
    let left = along.x * near.y;
    let right = along.y * near.x;
    return left - right < -1e-6 * (abs(left) + abs(right));
}

// Shares of the corners in a place within the triangle.
fn weights(a: vec2<i32>, b: vec2<i32>, c: vec2<i32>, p: vec2<i32>) -> vec3<f32> {
    let ab = vec2<f32>(b - a);
    let ac = vec2<f32>(c - a);
    let ap = vec2<f32>(p - a);
    let area = ab.x * ac.y - ab.y * ac.x;
    let v = clamp((ap.x * ac.y - ap.y * ac.x) / area, 0.0, 1.0);
    let w = clamp((ab.x * ap.y - ab.y * ap.x) / area, 0.0, 1.0 - v);
    return vec3(1.0 - v - w, v, w);
}
