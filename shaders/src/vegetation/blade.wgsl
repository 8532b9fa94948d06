#define_import_path dolomite::vegetation::blade

// The geometry of a blade: a quadratic Bezier curve that keeps its length. CPU reference:
// plugins/vegetation/src/blade.rs.

const MOST_LEAN: f32 = 0.9965;

// Two control points, relative to the root.
struct Curve {
    middle: vec3<f32>,
    tip: vec3<f32>,
}

// The lean after a push.
fn pushed(lean: vec2<f32>, by: vec2<f32>) -> vec2<f32> {
    let sum = lean + by;
    return sum * min(MOST_LEAN / sqrt(1.0 + dot(sum, sum)), 1.0);
}

// The curve at a lean: the offset of the tip as a share of the length. droop is 0 where it is straight, 1 where it goes
// straight up, then over.
fn curve_of(long: f32, droop: f32, wanted: vec2<f32>) -> Curve {
    let most = MOST_LEAN / max(length(wanted), MOST_LEAN);
    let lean = wanted * most;
    let height = sqrt(max(1.0 - dot(lean, lean), 0.0));
    let tip = vec3(lean.x, height, lean.y);
    let middle = mix(0.5 * tip, vec3(0.0, height, 0.0), droop);
    let polygon = length(middle) + length(tip - middle);
    let scale = long * 3.0 / (2.0 + polygon);
    return Curve(scale * middle, scale * tip);
}

fn place_at(curve: Curve, along: f32) -> vec3<f32> {
    return curve.middle * (2.0 * (1.0 - along) * along) + curve.tip * (along * along);
}

// Where a strip of so many segments ends: such that its area, as a vector, is that of the curve.
fn drawn_tip(curve: Curve, segments: u32) -> vec3<f32> {
    return curve.tip + (curve.middle - 0.5 * curve.tip) / f32(4u * segments - 2u);
}

// Middle of a row of such a strip.
fn row_at(curve: Curve, row: u32, segments: u32) -> vec3<f32> {
    return select(place_at(curve, f32(row) / f32(segments)), drawn_tip(curve, segments), row >= segments);
}

fn tangent_at(curve: Curve, along: f32) -> vec3<f32> {
    return curve.middle * (2.0 * (1.0 - 2.0 * along)) + curve.tip * (2.0 * along);
}

// The width there as a multiple of that at the root, of a strip of so many segments.
fn width_at(along: f32, segments: u32) -> f32 {
    let four = 4.0 * f32(segments * segments);
    return (1.0 - along * along) * (four / (four - 1.0));
}

// What to add to a vertex so that a strip that is seen edge-on does not vanish.
fn widened_edge(offset: vec3<f32>, tangent: vec3<f32>, to_eye: vec3<f32>, least: f32) -> vec3<f32> {
    let turned = cross(tangent, to_eye);
    let across = turned / max(length(turned), 1e-9);
    let seen = dot(offset, across);
    let missing = least - abs(seen);
    if missing > 0.0 && any(offset != vec3(0.0)) {
        return across * select(missing, -missing, seen < 0.0);
    }
    return vec3(0.0);
}
