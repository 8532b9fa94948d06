#define_import_path dolomite::blocks::ratio

// Error ratios of vertices. CPU reference: plugins/ground/src/blocks/choose.rs.

#import dolomite::blocks::border::{last_begin, signed_times}
#import dolomite::blocks::record::{ALWAYS, CELLS}
#import dolomite::detail::bindings::detail
#import dolomite::detail::lattice::lattice_point
#import dolomite::terrain::fixed::{Fixed, fixed_add, fixed_metres, fixed_sub, ground_x, ground_z, mul_wide}

// Half cells before a block at which places begin.
const BEFORE: u32 = 64u;
// The ratio of what is always there.
const GREATEST: f32 = 1e30;

// Places along one axis, in half cells of a block, from BEFORE before it on. The lattice may have a border of another width.
struct Axis {
    // Of place 0 to the view's anchor, as if all were like it; half a side of a cell.
    first: Fixed,
    first_step: Fixed,
    inner: Fixed,
    inner_step: Fixed,
    last: Fixed,
    last_step: Fixed,
    // The last place of the first column or row, and of what is before the last.
    first_end: i32,
    inner_end: i32,
}

// How a block lies to the view's anchor.
struct Frame {
    x: Axis,
    z: Axis,
    // Half a side of its cells, metres.
    half: vec2<f32>,
    // What counts in place of an error where the metric asks for lengths: of its mixed corners and centres.
    mixed_size: f32,
    centre_size: f32,
    // By how much shadows come in over the planes.
    swept_abc: vec3<f32>,
    swept_def: vec3<f32>,
}

fn step_times(step: vec2<u32>, count: u32) -> Fixed {
    let low = mul_wide(step.y, count);
    return Fixed(low.y + step.x * count, low.x);
}

// `corner` is the place on the lattice as it were without the border, to the anchor; `line` its line, `half` lines between places.
fn axis_of(corner: Fixed, line: u32, half: u32, roots: u32, step: vec2<u32>, first: vec2<u32>, last: vec2<u32>) -> Axis {
    let inner_step = step_times(step, half);
    let at = fixed_sub(corner, few_times(inner_step, BEFORE));
    let begin = bitcast<i32>(line - BEFORE * half);
    let border = bitcast<i32>(detail.border);
    let last_line = last_begin(roots);
    let inner = fixed_add(at, signed_times(first, border));
    let halvings = countTrailingZeros(half);
    let is_even = detail.border == 0u;
    return Axis(
        fixed_add(at, signed_times(first, begin)),
        fixed_add(inner_step, step_times(first, half)),
        inner,
        inner_step,
        fixed_add(inner, signed_times(last, begin - last_line)),
        fixed_add(inner_step, step_times(last, half)),
        select((border - begin) >> halvings, -1, is_even),
        select((last_line - begin) >> halvings, 256, is_even),
    );
}

fn frame_of(centre: vec2<u32>, half: u32) -> Frame {
    let cell_half = half / CELLS;
    let line = centre - vec2(half);
    let corner = lattice_point(line);
    let x = fixed_sub(ground_x(corner), Fixed(bitcast<u32>(detail.view.anchor.x), 0u));
    let z = fixed_sub(ground_z(corner), Fixed(bitcast<u32>(detail.view.anchor.y), 0u));
    let axis_x = axis_of(x, line.x, cell_half, detail.roots.x, detail.step_x, detail.first_x, detail.last_x);
    let axis_z = axis_of(z, line.y, cell_half, detail.roots.y, detail.step_z, detail.first_z, detail.last_z);
    let step = vec2(fixed_metres(axis_x.inner_step), fixed_metres(axis_z.inner_step));
    return Frame(
        axis_x,
        axis_z,
        step,
        4.0 * max(step.x, step.y),
        2.0 * length(step),
        vec3(swept_by(detail.view.planes[0]), swept_by(detail.view.planes[1]), swept_by(detail.view.planes[2])),
        vec3(swept_by(detail.view.planes[3]), swept_by(detail.view.planes[4]), swept_by(detail.view.planes[5])),
    );
}

// a * k for k up to 255.
fn few_times(a: Fixed, k: u32) -> Fixed {
    let low = (a.rest & 0xffffu) * k;
    let high = (a.rest >> 16u) * k + (low >> 16u);
    return Fixed(a.whole * k + (high >> 16u), (high << 16u) | (low & 0xffffu));
}

// To the anchor.
fn line_along(axis: Axis, at: u32) -> Fixed {
    let k = bitcast<i32>(at);
    let is_first = k <= axis.first_end;
    let is_last = k > axis.inner_end;
    let begin = Fixed(
        select(select(axis.inner.whole, axis.last.whole, is_last), axis.first.whole, is_first),
        select(select(axis.inner.rest, axis.last.rest, is_last), axis.first.rest, is_first),
    );
    let step = Fixed(
        select(select(axis.inner_step.whole, axis.last_step.whole, is_last), axis.first_step.whole, is_first),
        select(select(axis.inner_step.rest, axis.last_step.rest, is_last), axis.first_step.rest, is_first),
    );
    return fixed_add(begin, few_times(step, at));
}

// The same in metres: exact up to one rounding, so the same from every block.
fn place_along(axis: Axis, at: u32) -> f32 {
    return fixed_metres(line_along(axis, at));
}

// A place in half cells from BEFORE before the north-western corner.
fn place_before(frame: Frame, at: vec2<u32>) -> vec2<f32> {
    return vec2(place_along(frame.x, at.x), place_along(frame.z, at.y));
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
    let x = across(low, high, right);
    let y = across(low, high, up);
    let forward = detail.view.forward;
    let along = min(low * forward, high * forward);
    let depth = max(along.x + along.y + along.z, detail.view.near);
    let near = max(depth, distance * detail.view.cos_corner);
    let moved = max(depth, near - (high.y - low.y) * abs(forward.y));
    let far = sqrt(x * x + y * y) / (near * moved);
    let seen = min(far, 1.0 / (detail.view.cos_corner * moved));
    return detail.view.scale * select(seen, sqrt(right.y * right.y + up.y * up.y), detail.view.orthographic == 1.0);
}

// How far the farthest corner of a box is inside of a plane.
fn inside_of(plane: vec4<f32>, low: vec3<f32>, high: vec3<f32>) -> f32 {
    return dot(plane.xyz, select(low, high, plane.xyz >= vec3(0.0))) + plane.w;
}

// By how much shadows come in over a plane.
fn swept_by(plane: vec4<f32>) -> f32 {
    return max(dot(plane.xyz, detail.view.sweep), 0.0);
}

// Share of the detail of a box, as DetailView::share in plugins/ground/src/detail/view.rs: no loop and no jump, since software Vulkan reads what a
// loop indexes lane by lane.
fn share_of(frame: Frame, low: vec3<f32>, high: vec3<f32>) -> f32 {
    let a = inside_of(detail.view.planes[0], low, high);
    let b = inside_of(detail.view.planes[1], low, high);
    let c = inside_of(detail.view.planes[2], low, high);
    let d = inside_of(detail.view.planes[3], low, high);
    let e = inside_of(detail.view.planes[4], low, high);
    let f = inside_of(detail.view.planes[5], low, high);
    let near = vec3(a, b, c) + frame.swept_abc;
    let far = vec3(d, e, f) + frame.swept_def;
    let swept = min(min(min(near.x, near.y), min(near.z, far.x)), min(far.y, far.z));
    let least = min(min(min(a, b), min(c, d)), min(e, f));
    let shadowed = select(detail.view.shadow_share, 0.0, all(detail.view.sweep == vec3(0.0)) || swept < 0.0);
    return select(1.0, shadowed, least < 0.0);
}

// Pixels, or segments, a metre in a box relative to the anchor, by the metric; times its share, over the tolerance. No branch
// depends on a uniform alone: lavapipe compiles a pass with a few of those again each time that it is bound, for 4 to 10 ms.
fn box_factor(frame: Frame, low: vec3<f32>, high: vec3<f32>) -> f32 {
    let share = select(share_of(frame, low, high), 0.0, low.y > high.y);
    let least = low - detail.view.eye;
    let most = high - detail.view.eye;
    let away = max(max(least, -most), vec3(0.0));
    let distance = sqrt(away.x * away.x + away.y * away.y + away.z * away.z);
    let near_by = select(max(distance, detail.view.near), 1.0, detail.view.orthographic == 1.0);
    let steep = clamp((high.y - low.y) * detail.view.classic.w, 0.0, 1.0);
    let blend = min(detail.view.classic.z * distance + 0.4 * (1.0 - steep), 1.0);
    let levels = detail.view.classic.y + (detail.view.classic.x - detail.view.classic.y) * blend;
    let by_place = select(detail.view.classic.x, levels, distance * detail.view.classic.z < 0.6);
    let by_edge = select(by_place, detail.view.scale / near_by, detail.view.metric == 1u);
    let ratio = select(by_edge, pixels_a_metre(least, most, distance), detail.view.metric == 2u);
    return select(share * detail.view.inverse_tolerance * ratio, 0.0, share == 0.0);
}

// Of a vertex with an error and an edge, and its box.
fn box_ratio(frame: Frame, error: f32, edge: f32, low: vec3<f32>, high: vec3<f32>) -> f32 {
    let size = select(edge, error, detail.view.metric == 2u);
    return select(size * box_factor(frame, low, high), GREATEST, error >= ALWAYS);
}

// Of a vertex, its place in half cells of the block.
fn vertex_ratio(frame: Frame, at: vec2<u32>, error: f32, low: f32, high: f32) -> f32 {
    let reach = reach_of(at);
    let least = place_before(frame, at + vec2(BEFORE - reach));
    let most = place_before(frame, at + vec2(BEFORE + reach));
    return box_ratio(frame, error, edge_of(frame, at), vec3(least.x, low, least.y), vec3(most.x, high, most.y));
}
