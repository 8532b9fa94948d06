// Height queries: the drawn triangle under each place that was asked for. A thread a place.

#import dolomite::detail::bindings::detail
#import dolomite::detail::locate::{Located, locate}
#import dolomite::detail::types::NO_CELL
#import dolomite::detail::roots::root_corners
#import dolomite::detail::vertices::{ROOT_CORNER, Vertex, cell_ground, vertex_number}
#import dolomite::geometry::vertex::VERTEX_WORDS
#import dolomite::terrain::fixed::{Fixed, GroundPoint, fixed_metres, fixed_sub, ground_x, ground_z, metres_fixed}

struct Asked {
    // Number of the frame, and how many places.
    frame: u32,
    count: u32,
    pad_a: u32,
    pad_b: u32,
}

// Byte for byte as in plugins/terrain/src/probe/batch.rs.
struct ProbeAnswer {
    // Of a corner of the triangle, above the anchor; and from there to the place.
    height: f32,
    rise: f32,
    // Slopes along x and z, rise over run.
    gradient: f32,
    gradient_z: f32,
    // How far the triangle is from the true surface at most; below 0 where none is.
    bound: f32,
}

// The head is AnswerHead in plugins/ground/src/detail/probe.rs.
struct Answers {
    frame: u32,
    count: u32,
    // Of the choice of vertices that was drawn.
    stamp: u32,
    anchor_height: f32,
    list: array<ProbeAnswer>,
}

// Of the triangles that the stage draws: see vertex.wgsl.
@group(1) @binding(1) var<storage, read> drawn_vertices: array<u32>;
@group(1) @binding(2) var<uniform> asked: Asked;
@group(1) @binding(3) var<storage, read> places: array<GroundPoint>;
@group(1) @binding(4) var<storage, read_write> answers: Answers;

// Rounding of f32 numbers of this size, twice.
const ROUNDING: f32 = 1.2e-7;

fn stored(number: u32) -> vec3<f32> {
    let base = number * VERTEX_WORDS;
    return bitcast<vec3<f32>>(vec3(drawn_vertices[base], drawn_vertices[base + 1u], drawn_vertices[base + 2u]));
}

// From a vertex to a place, metres: exact up to the last step.
fn from_vertex(place: GroundPoint, vertex: vec3<f32>) -> vec2<f32> {
    let x = fixed_sub(ground_x(place), Fixed(bitcast<u32>(detail.view.anchor.x), 0u));
    let z = fixed_sub(ground_z(place), Fixed(bitcast<u32>(detail.view.anchor.y), 0u));
    return vec2(fixed_metres(fixed_sub(x, metres_fixed(vertex.x))), fixed_metres(fixed_sub(z, metres_fixed(vertex.z))));
}

// The drawn surface at a vertex whose geomorph is done.
fn surface_at(vertex: Vertex) -> f32 {
    if vertex.slot == ROOT_CORNER {
        return max(root_corners[vertex.cell].x, detail.sea);
    }
    return max(cell_ground(vertex).x, detail.sea);
}

fn cross_of(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

fn answer_at(place: GroundPoint) -> ProbeAnswer {
    let nothing = ProbeAnswer(0.0, 0.0, 0.0, 0.0, -1.0);
    var found = locate(place);
    if found.cell == NO_CELL {
        return nothing;
    }
    var corners: array<vec3<f32>, 3>;
    // How far each corner still is from the ground, upwards.
    var morph: vec3<f32>;
    for (var k = 0u; k < 3u; k++) {
        let number = vertex_number(found.corners[k]);
        if number >= detail.max_vertices {
            return nothing;
        }
        corners[k] = stored(number);
        morph[k] = corners[k].y + detail.anchor_height - surface_at(found.corners[k]);
    }
    let a = corners[1].xz - corners[0].xz;
    let b = corners[2].xz - corners[0].xz;
    let area = cross_of(a, b);
    if area == 0.0 {
        return nothing;
    }
    let off = from_vertex(place, corners[0]);
    let rises = vec2(corners[1].y - corners[0].y, corners[2].y - corners[0].y);
    let slope = vec2(rises.x * b.y - rises.y * a.y, rises.y * a.x - rises.x * b.x) / area;
    let rise = dot(slope, off);
    // During the geomorph of corners the drawn triangle is off the one on the ground by as much as they are,
    // each by its share of the place.
    let second = clamp(cross_of(off, b) / area, 0.0, 1.0);
    let third = clamp(cross_of(a, off) / area, 0.0, 1.0 - second);
    let moved = abs(dot(morph, vec3(1.0 - second - third, second, third)));
    // Corners are stored in f32: along the ground far from the anchor, and in height.
    let along = max(max(abs(corners[0].x), abs(corners[0].z)), max(abs(a.x) + abs(b.x), abs(a.y) + abs(b.y)));
    let rounding = ROUNDING * (along * (abs(slope.x) + abs(slope.y)) + abs(corners[0].y) + abs(rise) + abs(detail.anchor_height));
    return ProbeAnswer(corners[0].y, rise, slope.x, slope.y, found.error + moved + rounding);
}

@compute @workgroup_size(64)
fn answer(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x == 0u {
        answers.frame = asked.frame;
        answers.count = asked.count;
        answers.stamp = detail.stamp;
        answers.anchor_height = detail.anchor_height;
    }
    if id.x < asked.count {
        answers.list[id.x] = answer_at(places[id.x]);
    }
}
