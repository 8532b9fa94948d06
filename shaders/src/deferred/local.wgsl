#define_import_path dolomite::deferred::local

#import bevy_pbr::mesh_view_bindings as bevy
#import bevy_pbr::mesh_view_types::POINT_LIGHT_FLAGS_SHADOWS_ENABLED_BIT
#import bevy_pbr::{lighting as bevy_lighting, pbr_functions, shadows}
#import dolomite::deferred::bindings::lights
#import dolomite::deferred::gbuffer::SHADOW_RECEIVER
#import dolomite::deferred::models::{from_behind, shade}
#import dolomite::deferred::place::{from_camera, in_view, ndc_of, towards_camera}
#import dolomite::deferred::reach::{arriving, before, in_cone, within}
#import dolomite::deferred::surface::{decode, with_energy}
#import dolomite::deferred::types::{CASTS, CONTACT, SPOT, Incident, Surface}

// Point and spot lights at a pixel. Lights are first found, then shaded: `reaches` reads little and says for most
// that they add nothing, so that the pixels that run together shade as many lights as reach one of them, not as many
// as are listed. What `reaches` refuses is exactly 0 in the sum.

// A pixel's surface; `pixels` is its middle.
fn surface_at(pixels: vec2<f32>, depth: f32, words: vec4<u32>, model: u32) -> Surface {
    let there = in_view(vec3(ndc_of(pixels, bevy::view.viewport), depth), bevy::view.view_from_clip);
    let position = from_camera(there, bevy::view.world_from_view);
    let view = towards_camera(position, bevy::view.clip_from_view, bevy::view.world_from_view);
    let surface = decode(words, model, position, view);
    let scattering = bevy_lighting::F_AB(surface.perceptual_roughness, surface.n_dot_v);
    return with_energy(surface, scattering.x + scattering.y);
}

// Whether a light may add anything.
fn reaches(index: u32, surface: Surface) -> bool {
    let offset = (lights[index].position - bevy::view.world_position) - surface.position;
    let range = lights[index].range;
    if !within(offset, range) {
        return false;
    }
    if !(from_behind(surface.model) || before(offset, surface.normal, lights[index].radius, range)) {
        return false;
    }
    if (lights[index].kind & SPOT) == 0u {
        return true;
    }
    return in_cone(offset, lights[index].direction, lights[index].cos_outer);
}

fn incident(index: u32, surface: Surface) -> Incident {
    return arriving(lights[index], bevy::view.world_position, surface.position);
}

// What of a point or spot light is reflected to the camera, cd/m²; exactly 0 out of its reach. Without shadows.
fn open_light(index: u32, surface: Surface) -> vec3<f32> {
    let light = incident(index, surface);
    if !(max(light.color.r, max(light.color.g, light.color.b)) > 0.0) {
        return vec3(0.0);
    }
    return shade(surface, light);
}

#ifdef CASTERS
// How much of a light Bevy's shadow maps let through, and what is near on the screen.
fn seen_of(index: u32, surface: Surface, to_light: vec3<f32>, pixels: vec2<f32>) -> f32 {
    if (surface.flags & SHADOW_RECEIVER) == 0u {
        return 1.0;
    }
    let kind = lights[index].kind;
    let place = vec4(surface.position + bevy::view.world_position, 1.0);
    var seen = 1.0;
    // Bevy has maps for as many lights as a texture has layers: its own record says whether this one has.
    if (kind & CASTS) != 0u && (bevy::clustered_lights.data[index].flags & POINT_LIGHT_FLAGS_SHADOWS_ENABLED_BIT) != 0u {
        if (kind & SPOT) != 0u {
            let near = bevy::clustered_lights.data[index].shadow_map_near_z;
            seen = shadows::fetch_spot_shadow(index, place, surface.normal, near, pixels);
        } else {
            seen = shadows::fetch_point_shadow(index, place, surface.normal, pixels);
        }
    }
#ifdef CONTACT_SHADOWS
    let steps = bevy::contact_shadows_settings.linear_steps;
    if steps > 0u && seen > 0.0 && (kind & CONTACT) != 0u {
        seen *= pbr_functions::calculate_contact_shadow(place.xyz, pixels, to_light, steps);
    }
#endif
    return seen;
}

// The same as `open_light`, of a light that casts shadows.
fn shadowed_light(index: u32, surface: Surface, pixels: vec2<f32>) -> vec3<f32> {
    let light = incident(index, surface);
    if !(max(light.color.r, max(light.color.g, light.color.b)) > 0.0) {
        return vec3(0.0);
    }
    return shade(surface, light) * seen_of(index, surface, light.to_light, pixels);
}
#endif
