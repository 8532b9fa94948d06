// Gathers point and spot lights: each is drawn as a hull that encloses its reach, and its light is added where a
// surface lies within. Back faces are drawn that lie behind the surface, so a camera inside of the hull sees it.

#import bevy_pbr::mesh_view_bindings as bevy
#import bevy_pbr::prepass_utils
#import dolomite::deferred::bindings::{lighting_ids, lights, listed}
#import dolomite::deferred::gbuffer::{UNLIT, unpack_flags}
#import dolomite::deferred::local::{open_light, surface_at}
#ifdef CASTERS
#import dolomite::deferred::local::shadowed_light
#endif
#import dolomite::deferred::types::Light

struct Hull {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) light: u32,
    // Depths between which the light reaches: the far one, the near one.
    @location(1) @interpolate(flat) depths: vec2<f32>,
}

// Hulls and ranges are larger by this, for the rounding of their corners.
const MARGIN: f32 = 1.001;

// Depth at a distance before the camera; `nowhere` is the answer where there is none.
fn depth_at(distance: f32, nowhere: f32) -> f32 {
    let m = bevy::view.clip_from_view;
    let clip = vec2(m[3].z - m[2].z * distance, m[3].w - m[2].w * distance);
    if clip.y <= 0.0 {
        return nowhere;
    }
    return clip.x / clip.y;
}

// Corners of the unit hull of spots lie on two circles: `corner.z` tells which, `corner.xy` is on a circle around
// the axis or its middle.
fn spot_corner(light: Light, corner: vec3<f32>) -> vec3<f32> {
    // Below 60 degrees a cone, from there on a cylinder around half the sphere.
    let narrow = light.cos_outer > 0.5;
    let base = select(1.0, light.sin_outer / max(light.cos_outer, 0.5), narrow);
    let apex = select(1.0, 0.0, narrow);
    let axis = light.direction;
    let helper = select(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), abs(axis.x) > 0.7);
    let side = normalize(cross(axis, helper));
    let up = cross(axis, side);
    let across = (side * corner.x + up * corner.y) * mix(apex, base, corner.z);
    // The apex a little behind the light.
    return across + axis * mix(-0.002, 1.0, corner.z);
}

@vertex
fn vertex(@location(0) corner: vec3<f32>, @builtin(instance_index) instance: u32) -> Hull {
    var hull: Hull;
    hull.light = listed[instance];
    let light = lights[hull.light];
    let reach = light.range * MARGIN;
#ifdef SPOTS
    let offset = spot_corner(light, corner) * reach;
#else
    let offset = corner * reach;
#endif
    let middle = light.position - bevy::view.world_position;
    let m = bevy::view.world_from_view;
    let axes = transpose(mat3x3(m[0].xyz, m[1].xyz, m[2].xyz));
    let in_view = axes * (middle + offset);
    hull.position = bevy::view.clip_from_view * vec4(in_view, 1.0);
    let distance = -(axes * middle).z;
    hull.depths = vec2(depth_at(distance + reach, -1.0), depth_at(distance - reach, 2.0));
    // What reaches beyond the far plane must not be cut off by it. Corners lie up to 2.06 of the reach away: those of a
    // cone just below 60 degrees.
    if depth_at(distance + 2.1 * reach, -1.0) <= 0.0 {
        hull.position.z = 0.0;
    }
    return hull;
}

@fragment
fn fragment(hull: Hull) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(hull.position.xy);
    let depth = prepass_utils::prepass_depth(hull.position, 0u);
    if depth < hull.depths.x || depth > hull.depths.y {
        return vec4(0.0);
    }
    let words = textureLoad(bevy::deferred_prepass_texture, pixel, 0);
    let model = textureLoad(lighting_ids, pixel, 0).r;
    if model == 0u || (unpack_flags(words.w) & UNLIT) != 0u {
        return vec4(0.0);
    }
    let surface = surface_at(hull.position.xy, depth, words, model);
#ifdef CASTERS
    return vec4(shadowed_light(hull.light, surface, hull.position.xy), 0.0);
#else
    return vec4(open_light(hull.light, surface), 0.0);
#endif
}
