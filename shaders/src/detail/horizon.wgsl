#define_import_path dolomite::detail::horizon

// Ground that other ground hides, by a map of the upright plane ahead of the eye; it is derived in
// plugins/ground/src/detail/horizon.rs. Columns are u, to the side; layers, four of which double a depth, are
// depths; what they hold is s, upwards, in bits that are ordered like numbers: 0 for nothing yet.

#import dolomite::detail::bindings::{counts, detail, HORIZON}

// Bit of DetailParams.flags.
const OCCLUDED: u32 = 8u;

const COLUMNS: u32 = 512u;
const LAYERS: u32 = 96u;
const AN_OCTAVE: f32 = 4.0;
// What the logarithm of a depth may be off by, in layers.
const LAYER_ROUNDING: f32 = 0.01;
// Pixels that occluders are smaller by, and what they hide is larger by.
const MARGIN: f32 = 0.25;
// More than anything is: beyond are infinities.
const MOST: f32 = 1e30;
// Word behind the map: not 0 where drawn ground may be as high as the eye beside it.
const BLIND: u32 = HORIZON + COLUMNS * LAYERS;

struct Mapped {
    u: f32,
    s: f32,
    depth: f32,
}

fn map_place(place: vec3<f32>) -> Mapped {
    let from_eye = place - detail.horizon.eye;
    let ahead = detail.horizon.ahead;
    let depth = dot(ahead, from_eye.xz);
    let q = 1.0 / depth;
    return Mapped((ahead.x * from_eye.z - ahead.y * from_eye.x) * q, from_eye.y * q, depth);
}

fn column_of(u: f32) -> f32 {
    return (u + detail.horizon.reach) * (f32(COLUMNS) / (2.0 * detail.horizon.reach));
}

fn margin_at(u: f32, s: f32) -> f32 {
    return MARGIN * detail.horizon.pixel * (1.0 + u * u + s * s);
}

fn layer_of(depth: f32) -> f32 {
    return log2(depth / detail.horizon.nearest) * AN_OCTAVE;
}

// Greater numbers have greater bits; none has 0.
fn ordered(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return select(bits | 0x80000000u, ~bits, (bits >> 31u) != 0u);
}

// Whether all is behind drawn ground that lies at a depth and beyond, between two u, and no higher than `top`; no |s| in it is
// greater than `steepness`.
fn is_behind_all(depth: f32, left: f32, right: f32, top: f32, steepness: f32) -> bool {
    let layer = floor(layer_of(depth) - LAYER_ROUNDING);
    if !(depth >= detail.horizon.nearest && layer >= 0.0) || atomicLoad(&counts[BLIND]) != 0u {
        return false;
    }
    if !(steepness < MOST && abs(left) < MOST && abs(right) < MOST) {
        return false;
    }
    let margin = margin_at(max(abs(left), abs(right)), steepness);
    let most = f32(COLUMNS - 1u);
    let first = u32(clamp(floor(column_of(left - margin)), 0.0, most));
    let last = u32(clamp(floor(column_of(right + margin)), 0.0, most));
    let row = HORIZON + min(u32(layer), LAYERS - 1u) * COLUMNS;
    let mine = ordered(top + margin);
    for (var k = first; k <= last; k++) {
        if atomicLoad(&counts[row + k]) <= mine {
            return false;
        }
    }
    return true;
}

// Whether a triangle is behind drawn ground wherever it is in view.
fn is_behind(a: Mapped, b: Mapped, c: Mapped) -> bool {
    let depth = min(min(a.depth, b.depth), c.depth);
    let left = min(min(a.u, b.u), c.u);
    let right = max(max(a.u, b.u), c.u);
    let top = max(max(a.s, b.s), c.s);
    let steepness = max(max(abs(a.s), abs(b.s)), abs(c.s));
    return is_behind_all(depth, left, right, top, steepness);
}

// The same of what is in a flat square or below it, with these corners.
fn is_below_behind(a: Mapped, b: Mapped, c: Mapped, d: Mapped) -> bool {
    let depth = min(min(a.depth, b.depth), min(c.depth, d.depth));
    let left = min(min(a.u, b.u), min(c.u, d.u));
    let right = max(max(a.u, b.u), max(c.u, d.u));
    let top = max(max(a.s, b.s), max(c.s, d.s));
    let steepness = max(max(abs(a.s), abs(b.s)), max(abs(c.s), abs(d.s)));
    return is_behind_all(depth, left, right, top, steepness);
}
