#define_import_path dolomite::deferred::local

#import bevy_pbr::mesh_view_bindings as bevy
#import bevy_pbr::mesh_view_types::{POINT_LIGHT_FLAGS_SHADOWS_ENABLED_BIT, POINT_LIGHT_FLAGS_CONTACT_SHADOWS_ENABLED_BIT, POINT_LIGHT_FLAGS_SPOT_LIGHT_BIT}
#import bevy_pbr::{lighting, pbr_functions, shadows}
#import dolomite::deferred::bindings::lights
#import dolomite::deferred::gbuffer::SHADOW_RECEIVER
#import dolomite::deferred::models::shade
#import dolomite::deferred::place::{from_camera, in_view, ndc_of, towards_camera}
#import dolomite::deferred::reach::arriving
#import dolomite::deferred::surface::{decode, with_energy}
#import dolomite::deferred::types::Surface

// A pixel's surface; `pixels` is its middle.
fn surface_at(pixels: vec2<f32>, depth: f32, words: vec4<u32>, model: u32) -> Surface {
    let there = in_view(vec3(ndc_of(pixels, bevy::view.viewport), depth), bevy::view.view_from_clip);
    let position = from_camera(there, bevy::view.world_from_view);
    let view = towards_camera(position, bevy::view.clip_from_view, bevy::view.world_from_view);
    let surface = decode(words, model, position, view);
    let scattering = lighting::F_AB(surface.perceptual_roughness, surface.n_dot_v);
    return with_energy(surface, scattering.x + scattering.y);
}

// What of a point or spot light is reflected to the camera, cd/m²; exactly 0 out of its reach.
fn local_light(index: u32, surface: Surface, pixels: vec2<f32>) -> vec3<f32> {
    let light = lights[index];
    let incident = arriving(light, bevy::view.world_position, surface.position);
    if !(max(incident.color.r, max(incident.color.g, incident.color.b)) > 0.0) {
        return vec3(0.0);
    }
    var seen = 1.0;
    if (surface.flags & SHADOW_RECEIVER) != 0u {
        let place = vec4(surface.position + bevy::view.world_position, 1.0);
        // Bevy's own record of the same light.
        let record = &bevy::clustered_lights.data[index];
        if ((*record).flags & POINT_LIGHT_FLAGS_SHADOWS_ENABLED_BIT) != 0u {
            if ((*record).flags & POINT_LIGHT_FLAGS_SPOT_LIGHT_BIT) != 0u {
                seen = shadows::fetch_spot_shadow(index, place, surface.normal, (*record).shadow_map_near_z, pixels);
            } else {
                seen = shadows::fetch_point_shadow(index, place, surface.normal, pixels);
            }
        }
#ifdef CONTACT_SHADOWS
        let steps = bevy::contact_shadows_settings.linear_steps;
        if steps > 0u && seen > 0.0 && ((*record).flags & POINT_LIGHT_FLAGS_CONTACT_SHADOWS_ENABLED_BIT) != 0u {
            seen *= pbr_functions::calculate_contact_shadow(place.xyz, pixels, incident.to_light, steps);
        }
#endif
    }
    return shade(surface, incident) * seen;
}
