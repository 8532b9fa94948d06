#define_import_path dolomite::city::post

// Posts of lamps: isolines along Catmull-Rom curves, amplified to tubes. Three patches a lamp, of one control point:
// foot (x, z), direction as an angle, height. The CPU reference: plugins/city/src/tube.rs.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, in_view, patch_point, stage, stage_position}
#import dolomite::geometry::amplify_types::StoredVertex
#import dolomite::city::types::CityParams

@group(1) @binding(0) var<uniform> city: CityParams;

const MOST_SIDES: u32 = 16u;

struct Piece {
    a: vec2<f32>,
    b: vec2<f32>,
    c: vec2<f32>,
    d: vec2<f32>,
}

// Piece 0, 1 or 2 of a post, out and up: ends are repeated.
fn post_piece(height: f32, piece: u32) -> Piece {
    let foot = vec2(0.0);
    let top = vec2(0.0, height);
    let corner = vec2(city.post.x, height);
    let tip = vec2(city.post.x, height * (1.0 - city.post.y));
    if piece == 0u {
        return Piece(foot, foot, top, corner);
    }
    if piece == 1u {
        return Piece(foot, top, corner, tip);
    }
    return Piece(top, corner, tip, tip);
}

fn post_place(p: Piece, t: f32) -> vec2<f32> {
    let second = p.a * 2.0 - p.b * 5.0 + p.c * 4.0 - p.d;
    let third = (p.b - p.c) * 3.0 + p.d - p.a;
    return p.b + ((p.c - p.a) + (second + third * t) * t) * (0.5 * t);
}

fn post_slope(p: Piece, t: f32) -> vec2<f32> {
    let second = p.a * 2.0 - p.b * 5.0 + p.c * 4.0 - p.d;
    let third = (p.b - p.c) * 3.0 + p.d - p.a;
    return ((p.c - p.a) + (second * 2.0 + third * (3.0 * t)) * t) * 0.5;
}

// Metres that are allowed at the middle of a post: half of the tolerance for its segments, half for its sides.
fn allowed(input: Patch, lamp: vec4<f32>) -> f32 {
    let middle = stage_position(input, vec3(lamp.x, 0.5 * lamp.w, lamp.y));
    let away = max(distance(middle, stage.view.eye) - lamp.w, 0.1);
    return 0.5 * city.relief.x * away / stage.view.pixels_per_radian;
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let lamp = patch_point(input, 0u, 0u);
    let middle = stage_position(input, vec3(lamp.x, 0.5 * lamp.w, lamp.y));
    if !in_view(view, middle, 0.6 * lamp.w + city.post.x) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    let p = post_piece(lamp.w, input.number % 3u);
    let start = p.a * 2.0 - p.b * 5.0 + p.c * 4.0 - p.d;
    let end = start + ((p.b - p.c) * 3.0 + p.d - p.a) * 3.0;
    let bend = max(length(start), length(end));
    let n = clamp(sqrt(bend / (8.0 * allowed(input, lamp))), 1.0, 64.0);
    return PatchLevels(vec4(1.0, n, 1.0, 1.0), vec2(1.0));
}

// The direction of the tube stands where the normal does, the way it leans in uv, the number of sides in the material.
fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let lamp = patch_point(input, 0u, 0u);
    let out = vec2(cos(lamp.z), sin(lamp.z));
    let p = post_piece(lamp.w, input.number % 3u);
    let place = post_place(p, at.x);
    let slope = post_slope(p, at.x);
    var vertex: Vertex;
    vertex.position = vec3(lamp.x + out.x * place.x, place.y, lamp.y + out.y * place.x);
    vertex.normal = vec3(out.x * slope.x, slope.y, out.y * slope.x);
    vertex.uv = out;
    vertex.previous = vertex.position;
    let sides = ceil(3.14159265 * sqrt(city.post.z / (2.0 * allowed(input, lamp))));
    vertex.material = u32(clamp(sides, 3.0, f32(MOST_SIDES)));
    return vertex;
}

// Corner k of the ring around a vertex; the frame's axis is the normal of the post's plane, the same all along.
fn tube_corner(v: StoredVertex, sides: u32, k: u32) -> StoredVertex {
    let across = normalize(vec3(-v.uv.y, 0.0, v.uv.x));
    let up = cross(across, v.normal);
    let angle = 6.2831853 * f32(k % sides) / f32(sides);
    let out = across * cos(angle) + up * sin(angle);
    let moved = out * city.post.z;
    return StoredVertex(v.position + moved, out, vec2(f32(k) / f32(sides), 0.0), v.previous + moved, 0u);
}

// Sides of two triangles; those beyond the wanted number have no area.
fn amplify(a: StoredVertex, b: StoredVertex, c: StoredVertex, number: u32) -> StoredVertex {
    let side = number / 6u;
    let corner = number % 6u;
    let at_end = corner == 1u || corner == 2u || corner == 4u;
    let next = corner == 2u || corner == 4u || corner == 5u;
    let sides = max(a.material, 3u);
    let k = select(0u, side + select(0u, 1u, next), side < sides);
    if at_end {
        return tube_corner(b, sides, k);
    }
    return tube_corner(a, sides, k);
}
