// Numbers of the drawn ground in each pixel, for pictures of them. The triangles that a view's pools hold are drawn once
// more, and fetch their vertices by themselves, since the level is that of all three corners. Rust:
// plugins/ground/src/inspection.rs.

#import dolomite::geometry::vertex::VERTEX_WORDS
#ifdef INSPECT_ERROR
#import dolomite::terrain::bindings::terrain
#import dolomite::terrain::fixed::{GroundPoint, ground_offset}
#import dolomite::terrain::height::terrain_height
#endif

struct InspectionParams {
    // From places relative to the anchor to clip space, without the jitter of temporal anti-aliasing.
    clip: mat4x4<f32>,
    // Of the world, whole metres along x and z; and its height, metres.
    anchor: vec2<i32>,
    anchor_height: f32,
    // Pixels that an error may have.
    tolerance: f32,
    // Half the viewport, pixels.
    half_size: vec2<f32>,
    // Of a root square, m^2.
    root_area: f32,
    pad: f32,
    // Where the first column and row end and the last ones begin, relative to the anchor, metres; and how much longer a
    // step in the columns between is than one in them.
    first_end: vec2<f32>,
    last_begin: vec2<f32>,
    first_stretch: vec2<f32>,
    last_stretch: vec2<f32>,
}

@group(0) @binding(0) var<uniform> params: InspectionParams;
@group(0) @binding(1) var<storage, read> pool: array<u32>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;

struct Varying {
    @builtin(position) clip: vec4<f32>,
    // Relative to the anchor, metres.
    @location(0) position: vec3<f32>,
    @location(1) @interpolate(flat) bisections: f32,
}

fn position_of(number: u32) -> vec3<f32> {
    let at = indices[number] * VERTEX_WORDS;
    return bitcast<vec3<f32>>(vec3(pool[at], pool[at + 1u], pool[at + 2u]));
}

fn evened(place: vec2<f32>) -> vec2<f32> {
    let first = params.first_end + (place - params.first_end) * params.first_stretch;
    let last = params.last_begin + (place - params.last_begin) * params.last_stretch;
    return select(select(place, last, place > params.last_begin), first, place < params.first_end);
}

// A bisection halves the area, and a root square is two triangles.
fn bisections(a: vec2<f32>, b: vec2<f32>, c: vec2<f32>) -> f32 {
    let corner = evened(a);
    let first = evened(b) - corner;
    let second = evened(c) - corner;
    return max(round(log2(params.root_area / abs(first.x * second.y - first.y * second.x))), 0.0);
}

@vertex
fn vertex(@builtin(vertex_index) number: u32) -> Varying {
    var out: Varying;
    out.position = position_of(number);
    out.clip = params.clip * vec4(out.position, 1.0);
#ifdef INSPECT_LEVEL
    let first = number - number % 3u;
    out.bisections = bisections(position_of(first).xz, position_of(first + 1u).xz, position_of(first + 2u).xz);
#endif
    return out;
}

// Depth below which nothing is drawn, metres: what would be divided by less.
const LEAST_W: f32 = 1e-6;

// Pixels between a point and the one `up` metres above it: the difference of both projections, without taking one from the
// other, which would leave their rounding.
fn pixels(point: vec3<f32>, up: f32) -> f32 {
    let at = params.clip * vec4(point, 1.0);
    let a_metre = params.clip[1];
    let w = max(at.w + up * a_metre.w, LEAST_W);
    let moved = (a_metre.xy - at.xy / max(at.w, LEAST_W) * a_metre.w) * (up / w);
    return length(moved * params.half_size);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec2<f32> {
#ifdef INSPECT_LEVEL
    return vec2(in.bisections, 0.0);
#else
#ifdef INSPECT_ERROR
    let place = ground_offset(GroundPoint(params.anchor, vec2(0u)), in.position.xz);
    let truth = max(terrain_height(place).x, terrain.sea_level) - params.anchor_height;
    return vec2(pixels(in.position, truth - in.position.y), params.tolerance);
#else
    // Counts are added up.
    return vec2(1.0, 0.0);
#endif
#endif
}
