#define_import_path dolomite::blocks::ratio

// Error ratios of vertices. CPU reference: plugins/ground/src/blocks/choose.rs.

#import dolomite::blocks::record::{ALWAYS, CELLS}
#import dolomite::detail::bindings::detail
#import dolomite::detail::lattice::lattice_point
#import dolomite::terrain::fixed::{Fixed, fixed_add, fixed_metres, fixed_sub, ground_x, ground_z, mul_wide}

// Half cells before a block at which places begin.
const BEFORE: u32 = 64u;
// The ratio of what is always there.
const GREATEST: f32 = 1e30;

// How a block lies to the view's anchor.
struct Frame {
    // BEFORE half cells before its north-western corner: boxes of vertices begin before the block.
    x: Fixed,
    z: Fixed,
    // Half a side of its cells.
    step_x: Fixed,
    step_z: Fixed,
    // The same in metres.
    half: vec2<f32>,
}

fn step_times(step: vec2<u32>, count: u32) -> Fixed {
    let low = mul_wide(step.y, count);
    return Fixed(low.y + step.x * count, low.x);
}

fn frame_of(centre: vec2<u32>, half: u32) -> Frame {
    let step_x = step_times(detail.step_x, half / CELLS);
    let step_z = step_times(detail.step_z, half / CELLS);
    let corner = lattice_point(centre - vec2(half));
    var x = fixed_sub(ground_x(corner), Fixed(bitcast<u32>(detail.view.anchor.x), 0u));
    var z = fixed_sub(ground_z(corner), Fixed(bitcast<u32>(detail.view.anchor.y), 0u));
    x = fixed_sub(x, few_times(step_x, BEFORE));
    z = fixed_sub(z, few_times(step_z, BEFORE));
    return Frame(x, z, step_x, step_z, vec2(fixed_metres(step_x), fixed_metres(step_z)));
}

// a * k for k up to 255.
fn few_times(a: Fixed, k: u32) -> Fixed {
    let low = (a.rest & 0xffffu) * k;
    let high = (a.rest >> 16u) * k + (low >> 16u);
    return Fixed(a.whole * k + (high >> 16u), (high << 16u) | (low & 0xffffu));
}

// A place in half cells from BEFORE before the north-western corner, metres to the anchor: exact up to one rounding, so the
// same from every block.
fn place_before(frame: Frame, at: vec2<u32>) -> vec2<f32> {
    return vec2(
        fixed_metres(fixed_add(frame.x, few_times(frame.step_x, at.x))),
        fixed_metres(fixed_add(frame.z, few_times(frame.step_z, at.y))),
    );
}

// A place in half cells from the north-western corner.
fn place_in(frame: Frame, at: vec2<u32>) -> vec2<f32> {
    return place_before(frame, at + vec2(BEFORE));
}

// By how many half cells of the block the descendants of a vertex are away from it, at most.
fn reach_of(at: vec2<u32>) -> u32 {
    // 32 is the other end of the block.
    let tx = countTrailingZeros(at.x | 32u);
    let tz = countTrailingZeros(at.y | 32u);
    return select(2u, 3u, tx == tz) << min(tx, tz);
}

// The length that counts in place of an error where the metric asks for lengths: of the edge that the vertex cuts.
fn edge_of(frame: Frame, at: vec2<u32>) -> f32 {
    let tx = countTrailingZeros(at.x | 32u);
    let tz = countTrailingZeros(at.y | 32u);
    let side = frame.half * f32(2u << min(tx, tz));
    return select(max(side.x, side.y), length(side), tx == tz);
}

// Largest |P_z a_x - P_x a_z| of a box relative to the eye.
fn across(low: vec3<f32>, high: vec3<f32>, axis: vec3<f32>) -> f32 {
    let a = low.z * axis.x;
    let b = high.z * axis.x;
    let c = low.x * axis.z;
    let d = high.x * axis.z;
    return max(max(a, b) - min(c, d), max(c, d) - min(a, b));
}

// The most pixels that a vertical metre in a box relative to the eye is.
fn pixels_a_metre(low: vec3<f32>, high: vec3<f32>, distance: f32) -> f32 {
    let right = detail.view.right;
    let up = detail.view.up;
    if detail.view.orthographic == 1.0 {
        return detail.view.scale * sqrt(right.y * right.y + up.y * up.y);
    }
    let x = across(low, high, right);
    let y = across(low, high, up);
    let forward = detail.view.forward;
    let along = min(low * forward, high * forward);
    let depth = max(along.x + along.y + along.z, detail.view.near);
    let near = max(depth, distance * detail.view.cos_corner);
    let moved = max(depth, near - (high.y - low.y) * abs(forward.y));
    let far = sqrt(x * x + y * y) / (near * moved);
    return detail.view.scale * min(far, 1.0 / (detail.view.cos_corner * moved));
}

// How far the farthest corner of a box is inside of a plane.
fn inside_of(plane: vec4<f32>, low: vec3<f32>, high: vec3<f32>) -> f32 {
    return dot(plane.xyz, select(low, high, plane.xyz >= vec3(0.0))) + plane.w;
}

// By how much shadows come in over a plane.
fn swept_by(plane: vec4<f32>) -> f32 {
    return max(dot(plane.xyz, detail.view.sweep), 0.0);
}

// Share of the detail of a box, as box_share in detail/view.wgsl: no loop and no jump, since software Vulkan reads what a
// loop indexes lane by lane.
fn share_of(low: vec3<f32>, high: vec3<f32>) -> f32 {
    let a = inside_of(detail.view.planes[0], low, high);
    let b = inside_of(detail.view.planes[1], low, high);
    let c = inside_of(detail.view.planes[2], low, high);
    let d = inside_of(detail.view.planes[3], low, high);
    let e = inside_of(detail.view.planes[4], low, high);
    let f = inside_of(detail.view.planes[5], low, high);
    var swept = min(a + swept_by(detail.view.planes[0]), b + swept_by(detail.view.planes[1]));
    swept = min(swept, min(c + swept_by(detail.view.planes[2]), d + swept_by(detail.view.planes[3])));
    swept = min(swept, min(e + swept_by(detail.view.planes[4]), f + swept_by(detail.view.planes[5])));
    let least = min(min(min(a, b), min(c, d)), min(e, f));
    let shadowed = select(detail.view.shadow_share, 0.0, all(detail.view.sweep == vec3(0.0)) || swept < 0.0);
    return select(1.0, shadowed, least < 0.0);
}

// Pixels, or segments, a metre in a box relative to the anchor, by the metric; times its share, over the tolerance.
fn box_factor(low: vec3<f32>, high: vec3<f32>) -> f32 {
    let share = select(share_of(low, high), 0.0, low.y > high.y);
    let least = low - detail.view.eye;
    let most = high - detail.view.eye;
    let away = max(max(least, -most), vec3(0.0));
    let distance = sqrt(away.x * away.x + away.y * away.y + away.z * away.z);
    var ratio = 0.0;
    if detail.view.metric == 2u {
        ratio = pixels_a_metre(least, most, distance);
    } else if detail.view.metric == 1u {
        ratio = detail.view.scale / select(max(distance, detail.view.near), 1.0, detail.view.orthographic == 1.0);
    } else {
        let steep = clamp((high.y - low.y) * detail.view.classic.w, 0.0, 1.0);
        let blend = min(detail.view.classic.z * distance + 0.4 * (1.0 - steep), 1.0);
        let near = distance * detail.view.classic.z < 0.6;
        ratio = select(detail.view.classic.x, detail.view.classic.y + (detail.view.classic.x - detail.view.classic.y) * blend, near);
    }
    return select(share * detail.view.inverse_tolerance * ratio, 0.0, share == 0.0);
}

// Of a vertex, its place in half cells of the block.
fn vertex_ratio(frame: Frame, at: vec2<u32>, error: f32, low: f32, high: f32) -> f32 {
    let reach = reach_of(at);
    let least = place_before(frame, at + vec2(BEFORE - reach));
    let most = place_before(frame, at + vec2(BEFORE + reach));
    let size = select(edge_of(frame, at), error, detail.view.metric == 2u);
    let ratio = size * box_factor(vec3(least.x, low, least.y), vec3(most.x, high, most.y));
    return select(ratio, GREATEST, error >= ALWAYS);
}
