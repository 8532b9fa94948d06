// Height queries: the drawn triangle under each place that was asked for, by the view's last choice. A thread a place.

#import dolomite::blocks::locate::{cross_of_sides, locate}
#import dolomite::blocks::raised::{drawn_ground, ground_at}
#import dolomite::blocks::ratio::place_in
#import dolomite::blocks::record::{NO_BLOCK, vertex_at}
#import dolomite::blocks::way::{Block, block_at, coarsening_now, way_of}
#import dolomite::detail::bindings::detail
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

@group(1) @binding(2) var<uniform> asked: Asked;
@group(1) @binding(3) var<storage, read> places: array<GroundPoint>;
@group(1) @binding(4) var<storage, read_write> answers: Answers;

// Rounding of f32 numbers of this size, twice.
const ROUNDING: f32 = 1.2e-7;

// A corner as it is drawn; in w how far it is above the ground on which it will stand.
fn corner_of(block: Block, number: u32, coarsening: f32) -> vec4<f32> {
    let drawn = drawn_ground(block, number, way_of(block, number, coarsening)).x;
    let place = place_in(block.frame, vertex_at(number));
    return vec4(place.x, drawn - detail.anchor_height, place.y, drawn - ground_at(block, number).x);
}

// From a drawn corner to a place, metres: exact up to the last step.
fn from_corner(place: GroundPoint, corner: vec4<f32>) -> vec2<f32> {
    let x = fixed_sub(ground_x(place), Fixed(bitcast<u32>(detail.view.anchor.x), 0u));
    let z = fixed_sub(ground_z(place), Fixed(bitcast<u32>(detail.view.anchor.y), 0u));
    return vec2(fixed_metres(fixed_sub(x, metres_fixed(corner.x))), fixed_metres(fixed_sub(z, metres_fixed(corner.z))));
}

fn answer_at(place: GroundPoint) -> ProbeAnswer {
    let nothing = ProbeAnswer(0.0, 0.0, 0.0, 0.0, -1.0);
    let coarsening = coarsening_now();
    let found = locate(place, coarsening);
    if found.slot == NO_BLOCK {
        return nothing;
    }
    let block = block_at(found.slot);
    let first = corner_of(block, found.corners.x, coarsening);
    let second = corner_of(block, found.corners.y, coarsening);
    let third = corner_of(block, found.corners.z, coarsening);
    let a = second.xz - first.xz;
    let b = third.xz - first.xz;
    let area = cross_of_sides(a, b);
    if area == 0.0 {
        return nothing;
    }
    let off = from_corner(place, first);
    let rises = vec2(second.y - first.y, third.y - first.y);
    let slope = vec2(rises.x * b.y - rises.y * a.y, rises.y * a.x - rises.x * b.x) / area;
    let rise = dot(slope, off);
    // While corners are on their way the drawn triangle is off the one on the ground by as much as they are, each by its share
    // of the place.
    let to_second = clamp(cross_of_sides(off, b) / area, 0.0, 1.0);
    let to_third = clamp(cross_of_sides(a, off) / area, 0.0, 1.0 - to_second);
    let moved = abs(dot(vec3(first.w, second.w, third.w), vec3(1.0 - to_second - to_third, to_second, to_third)));
    // Corners are stored in f32: along the ground far from the anchor, and in height.
    let along = max(max(abs(first.x), abs(first.z)), max(abs(a.x) + abs(b.x), abs(a.y) + abs(b.y)));
    let rounding = ROUNDING * (along * (abs(slope.x) + abs(slope.y)) + abs(first.y) + abs(rise) + abs(detail.anchor_height));
    return ProbeAnswer(first.y, rise, slope.x, slope.y, found.error + moved + rounding);
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
