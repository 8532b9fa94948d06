#define_import_path dolomite::ground::functions

// The ground as a kind of patches: quads over the ground plane, u towards +x and v towards -z. CPU reference:
// plugins/ground/src/cover/functions.rs.
//
// Control points 0 to 3 are the corners (0,0), (1,0), (1,1), (0,1): place and height relative to the
// entity, whose origin is whole metres near the focus. Point 4 holds the least and the greatest height
// of the ground in the patch. Parameter 0.x of the entity is the height from the lowest to the highest
// ground of all, metres.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, entity_origin, entity_params, patch_point, stage_position}
#import dolomite::geometry::draw_types::{Shaded, Surface}
#import dolomite::terrain::fixed::{GroundPoint, ground_offset}
#import dolomite::terrain::bindings::terrain
#import dolomite::terrain::height::terrain_height
#import dolomite::ground::types::DEPTH_RANGE
#import dolomite::ground::surface::material as ground_material

// The bed of water deeper than this cannot be seen, metres: the surface above it is flat.
const OPAQUE_DEPTH: f32 = 12.0;
// Share of the segments that patches get which are seen through a shadow map alone.
const SHADOW_DETAIL: f32 = 0.25;

// Where the surface of a corner is drawn, in stage space.
fn drawn_corner(input: Patch, k: u32) -> vec3<f32> {
    let point = patch_point(input, k, 0u);
    return stage_position(input, vec3(point.x, max(point.y, terrain.sea_level), point.z));
}

// How far shadows reach from the highest ground down to the lowest, along the light; 0 without.
fn shadow_sweep(view: StageView, relief: f32) -> vec3<f32> {
    let reach = length(view.sweep.xyz);
    if reach == 0.0 {
        return vec3(0.0);
    }
    let along = view.sweep.xyz / reach;
    // 0.05: below 3 degrees of sun the shadows of everything reach everywhere.
    return along * (relief / max(-along.y, 0.05));
}

// 1 when the box meets the frustum, SHADOW_DETAIL when only the box swept along the light does, else 0.
fn seen(view: StageView, low: vec3<f32>, high: vec3<f32>, sweep: vec3<f32>) -> f32 {
    var share = 1.0;
    for (var k = 0u; k < 6u; k++) {
        let plane = view.planes[k];
        let farthest = select(low, high, plane.xyz >= vec3(0.0));
        let inside = dot(plane.xyz, farthest) + plane.w;
        if inside < 0.0 {
            share = SHADOW_DETAIL;
            if inside + max(dot(plane.xyz, sweep), 0.0) < 0.0 {
                return 0.0;
            }
        }
    }
    return select(share, 0.0, share != 1.0 && all(sweep == vec3(0.0)));
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let a = drawn_corner(input, 0u);
    let b = drawn_corner(input, 1u);
    let c = drawn_corner(input, 2u);
    let d = drawn_corner(input, 3u);
    let heights = patch_point(input, 4u, 0u).xy;
    let height_of = entity_origin(input).y - view.anchor.y;
    let least = max(heights.x, terrain.sea_level) + height_of;
    let greatest = max(heights.y, terrain.sea_level) + height_of;
    let sweep = shadow_sweep(view, entity_params(input, 0u).x);
    let share = seen(view, vec3(a.x, least, c.z), vec3(c.x, greatest, a.z), sweep);
    if share == 0.0 {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    if heights.y < terrain.sea_level - OPAQUE_DEPTH {
        return PatchLevels(vec4(1.0), vec2(1.0));
    }
    // At least the tiniest level: 0 would discard the patch.
    let u_low = max(share * edge_level(view, d, a), 1e-3);
    let v_low = max(share * edge_level(view, a, b), 1e-3);
    let u_high = max(share * edge_level(view, b, c), 1e-3);
    let v_high = max(share * edge_level(view, c, d), 1e-3);
    return PatchLevels(vec4(u_low, v_low, u_high, v_high), vec2(max(v_low, v_high), max(u_low, u_high)));
}

// The box of the patch, as a sphere.
fn bounds(input: Patch, view: StageView) -> vec4<f32> {
    let a = drawn_corner(input, 0u);
    let c = drawn_corner(input, 2u);
    let heights = max(patch_point(input, 4u, 0u).xy, vec2(terrain.sea_level)) + entity_origin(input).y - view.anchor.y;
    let low = vec3(a.x, heights.x, c.z);
    let high = vec3(c.x, heights.y, a.z);
    return vec4((low + high) * 0.5, length(high - low) * 0.5);
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let a = patch_point(input, 0u, 0u);
    let c = patch_point(input, 2u, 0u);
    let place = a.xz + (c.xz - a.xz) * at.xy;
    let origin = entity_origin(input);
    let ground = terrain_height(ground_offset(GroundPoint(vec2<i32>(origin.xz), vec2(0u)), place));
    var vertex: Vertex;
    vertex.position = vec3(place.x, max(ground.x, terrain.sea_level), place.y);
    vertex.normal = vec3(-ground.y, 1.0, -ground.z);
    // For the material: how deep the ground lies below the sea.
    vertex.uv = vec2(clamp(terrain.sea_level - ground.x, -DEPTH_RANGE, DEPTH_RANGE), 0.0);
    vertex.previous = vertex.position;
    vertex.material = 0u;
    return vertex;
}

fn material(surface: Surface) -> Shaded {
    return ground_material(surface);
}
