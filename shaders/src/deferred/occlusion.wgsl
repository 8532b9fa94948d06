#define_import_path dolomite::deferred::occlusion

// Ambient occlusion in screen space, as `occlusion/reference.rs` of `dolomite_deferred` has it, with where its equations
// come from: slices of directions about the view direction, of which each pixel near by hides an arc.

const PI: f32 = 3.14159265;

// The bits of a slice: parts of equal weight of its integral.
const PARTS: f32 = 32.0;

// `Uniform` in `render/occlusion.rs` of `dolomite_deferred`.
struct Settings {
    // What is farther away blocks nothing, metres.
    radius: f32,
    // How far a surface reaches behind what is seen of it, metres.
    thickness: f32,
    // How far from a pixel is looked at most, in pixels.
    most_pixels: f32,
    // A pixel is found for so many in a row, and so many rows.
    scale: i32,
    // Half-turns of directions a pixel, and pixels that are looked at on each side of one.
    slices: u32,
    steps: u32,
    pad: vec2<u32>,
}

// How places of the view come from pixels.
struct Eye {
    // Pixels.
    size: vec2<f32>,
    // At the border of the view `x / -z` and `y / -z`, or `x` and `y` where all rays run along the camera's axis.
    tangents: vec2<f32>,
    // Of the middle, for views that are not symmetric.
    shift: vec2<f32>,
    orthographic: bool,
}

fn eye_of(clip_from_view: mat4x4<f32>, size: vec2<f32>) -> Eye {
    let orthographic = clip_from_view[3].w == 1.0;
    let tangents = 1.0 / vec2(clip_from_view[0].x, clip_from_view[1].y);
    let shift = select(clip_from_view[2].xy, -clip_from_view[3].xy, orthographic);
    return Eye(size, abs(tangents), shift, orthographic);
}

// Metres along the camera's axis of a depth that is not 0.
fn metres_of(depth: f32, clip_from_view: mat4x4<f32>) -> f32 {
    let a = clip_from_view[2].z;
    let b = clip_from_view[3].z;
    return select(b / (depth + a), (b - depth) / a, clip_from_view[3].w == 1.0);
}

// The place in view space of the middle of a pixel.
fn place_of(eye: Eye, pixel: vec2<i32>, metres: f32) -> vec3<f32> {
    let ndc = (vec2<f32>(pixel) + 0.5) / eye.size * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    let flat = (ndc + eye.shift) * eye.tangents;
    return vec3(flat * select(metres, 1.0, eye.orthographic), -metres);
}

// Metres of a pixel across the view.
fn footprint(eye: Eye, metres: f32) -> f32 {
    return 2.0 * eye.tangents.y / eye.size.y * select(metres, 1.0, eye.orthographic);
}

fn towards_eye(eye: Eye, place: vec3<f32>) -> vec3<f32> {
    return select(-normalize(place), vec3(0.0, 0.0, 1.0), eye.orthographic);
}

struct Angle {
    theta: f32,
    sine: f32,
    cosine: f32,
}

fn angle(theta: f32) -> Angle {
    return Angle(theta, sin(theta), cos(theta));
}

// The inner integral from the view direction to an angle; the normal's is `gamma`.
fn primitive(at: Angle, gamma: Angle) -> f32 {
    let twice = (2.0 * at.cosine * at.cosine - 1.0) * gamma.cosine + 2.0 * at.sine * at.cosine * gamma.sine;
    let area = 0.25 * (gamma.cosine - twice + 2.0 * at.theta * gamma.sine);
    return select(area, -area, at.theta < 0.0);
}

// To 7e-5 (Abramowitz and Stegun, 4.4.45).
fn arc_cosine(x: f32) -> f32 {
    let a = min(abs(x), 1.0);
    let positive = sqrt(1.0 - a) * (1.5707288 + a * (-0.2121144 + a * (0.074261 - a * 0.0187293)));
    return select(positive, PI - positive, x < 0.0);
}

// The bits of the parts whose middle lies between two shares.
fn parts(low: f32, high: f32) -> u32 {
    let first = u32(low * PARTS + 0.5);
    let end = u32(high * PARTS + 0.5);
    if first >= end || first >= 32u {
        return 0u;
    }
    return (0xffffffffu >> (32u - min(end - first, 32u))) << first;
}

fn order(x: i32, y: i32) -> i32 {
    let low = (((x ^ y) & 1) << 1u) | (y & 1);
    let high = (((x ^ y) >> 1u) << 1u) | (y >> 1u);
    return (low << 2u) | high;
}

// The turn of the slices and the shift of the steps: each once in every 4 × 4 pixels.
fn pattern(cell: vec2<i32>) -> vec2<f32> {
    let at = cell & vec2(3);
    return (vec2<f32>(vec2(order(at.x, at.y), order(at.y ^ 1, at.x ^ 2))) + 0.5) / 16.0;
}

// What a pixel of the filter counts along an axis, so that each of the pattern's four columns counts the same.
fn share_of(away: vec2<f32>) -> f32 {
    let shares = saturate(2.5 - abs(away));
    return shares.x * shares.y;
}

struct Slice {
    tangent: vec3<f32>,
    // At a right angle to the projected normal, towards the tangent.
    across: vec3<f32>,
    // Of the projected normal.
    length: f32,
    gamma: Angle,
    // The inner integral up to the first end, and over all.
    low: f32,
    all: f32,
}

fn slice_of(tangent: vec3<f32>, view: vec3<f32>, normal: vec3<f32>) -> Slice {
    let axis = cross(tangent, view);
    let projected = normal - axis * dot(normal, axis);
    let len = length(projected);
    let unit = projected / max(len, 1e-6);
    let side = select(1.0, -1.0, dot(unit, tangent) < 0.0);
    let gamma = angle(side * arc_cosine(dot(unit, view)));
    let low = primitive(angle(gamma.theta - 0.5 * PI), gamma);
    let high = primitive(angle(gamma.theta + 0.5 * PI), gamma);
    let across = tangent * gamma.cosine - view * gamma.sine;
    return Slice(tangent, across, len, gamma, low, max(high - low, 1e-6));
}

// The share of a slice's inner integral up to a place that was looked at on a side, 1 or -1: its angle is that of its
// height over the surface's own plane, for pixels do not lie in the plane of a slice.
fn share_in(slice: Slice, away: vec3<f32>, normal: vec3<f32>, side: f32) -> f32 {
    let height = dot(normal, away);
    // Below the surface's plane is beyond the end of that side.
    if height <= 0.0 {
        return select(1.0, 0.0, side < 0.0);
    }
    let of_normal = select(1.0, -1.0, dot(slice.across, away) < 0.0);
    let cosine = height / max(length(away) * slice.length, 1e-20);
    let at = angle(slice.gamma.theta + of_normal * arc_cosine(cosine));
    return saturate((primitive(at, slice.gamma) - slice.low) / slice.all);
}
