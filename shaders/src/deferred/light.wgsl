// Lights a view's G-buffer in one full-screen triangle a shading model: directional lights, light from everywhere,
// what the surfaces emit, and point and spot lights by one of three ways: BRUTE_FORCE goes through all that the view
// sees, TILED through the lists of the pixel's tile, VOLUMES takes what was gathered before.
//
// What no light of the view needs is not compiled: SUNS says that there are directional lights, SUN_SHADOWS that one
// of them casts shadows, CASTERS that a point or spot light does, LISTS that there are lights to go through. MODEL is
// the lighting id of the pixels that are drawn. OCCLUDED says that there is ambient occlusion in screen space: Bevy's, or
// by AMBIENT_OCCLUSION that of this crate.

#import bevy_pbr::mesh_view_bindings as bevy
#import bevy_pbr::mesh_view_types::{DIRECTIONAL_LIGHT_FLAGS_CONTACT_SHADOWS_ENABLED_BIT, DIRECTIONAL_LIGHT_FLAGS_SHADOWS_ENABLED_BIT}
#import bevy_pbr::pbr_deferred_functions::pbr_input_from_deferred_gbuffer
#import bevy_pbr::{ambient, clustered_forward as clustering, lighting as bevy_lighting, pbr_functions, pbr_types, prepass_utils, shadows}
#import dolomite::deferred::bindings::{lighting, listed}
#import dolomite::deferred::gbuffer::{SHADOW_RECEIVER, UNLIT}
#import dolomite::deferred::local::{open_light, reaches, surface_at}
#import dolomite::deferred::models::shade
#import dolomite::deferred::types::{Incident, Surface}
#ifdef CASTERS
#import dolomite::deferred::local::shadowed_light
#endif
#ifdef SCREEN_SPACE_AMBIENT_OCCLUSION
#import bevy_pbr::mesh_view_bindings::screen_space_ambient_occlusion_texture
#endif
#ifdef OCCLUDED
#import bevy_pbr::ssao_utils::ssao_multibounce
#endif
#ifdef ENVIRONMENT_MAP
#import bevy_pbr::environment_map
#endif
#ifdef IRRADIANCE_VOLUME
#import bevy_pbr::irradiance_volume
#endif
#ifdef AMBIENT_OCCLUSION
#import dolomite::deferred::bindings::visible_share
#endif
#ifdef TILED
#import dolomite::deferred::bindings::tiles
#endif
#ifdef VOLUMES
#import dolomite::deferred::bindings::gathered
#endif

// Bevy's own id; others are models without its indirect specular light.
const STANDARD: u32 = 1u;

// One triangle over the whole target, at the depth that stands for the model's lighting id: it is drawn where a pixel
// has that id.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2(f32(index >> 1u), f32(index & 1u)) * 4.0 - 1.0;
    return vec4(corner, f32(#{MODEL}) / 255.0, 1.0);
}

#ifdef LISTS
// No light.
const NOBODY: u32 = 0xffffffffu;

// The lights that a pixel goes through: those that its tile lists, then those of the view that no tile lists. The
// ones that cast no shadows come first.
struct Candidates {
    // Of the tile's list.
    first: u32,
    own: u32,
    // Of the view's list.
    rest: u32,
    open: u32,
    all: u32,
}

fn candidates(pixels: vec2<f32>) -> Candidates {
#ifdef TILED
    let tile = vec2<u32>(pixels - bevy::view.viewport.xy) / 16u;
    let head = 1u + 3u * (tile.y * lighting.tiles.x + tile.x);
    let first = tiles[head];
    // Without a list of its own, a tile goes through all.
    if first != 0u {
        let open = tiles[head + 1u] + max(lighting.open, lighting.in_tiles) - lighting.in_tiles;
        let own = tiles[head + 2u];
        return Candidates(first, own, lighting.in_tiles, open, own + lighting.lights - lighting.in_tiles);
    }
#endif
    return Candidates(0u, 0u, 0u, lighting.open, lighting.lights);
}

fn candidate(list: Candidates, at: u32) -> u32 {
#ifdef TILED
    if at < list.own {
        return tiles[list.first + at];
    }
#endif
    return listed[list.rest + at - list.own];
}

// The next one before `end` that may add light; `at` is then behind it.
fn next(list: Candidates, at: ptr<function, u32>, end: u32, surface: Surface) -> u32 {
    var found = NOBODY;
    if *at < end {
        loop {
            let index = candidate(list, *at);
            *at += 1u;
            if reaches(index, surface) {
                found = index;
            }
            if found != NOBODY || *at >= end {
                break;
            }
        }
    }
    return found;
}

// Pixels that run together each seek their next light before any of them shades: so they shade as often as the one
// with the most lights, not as often as there are lights that reach one of them. The test stands at the end of
// loops, for a loop without lanes still runs once on some adapters.
fn local_lights(surface: Surface, pixels: vec2<f32>) -> vec3<f32> {
    let list = candidates(pixels);
    var sum = vec3(0.0);
    var at = 0u;
    var index = next(list, &at, list.open, surface);
    if index != NOBODY {
        loop {
            sum += open_light(index, surface);
            index = next(list, &at, list.open, surface);
            if index == NOBODY {
                break;
            }
        }
    }
#ifdef CASTERS
    at = list.open;
    index = next(list, &at, list.all, surface);
    if index != NOBODY {
        loop {
            sum += shadowed_light(index, surface, pixels);
            index = next(list, &at, list.all, surface);
            if index == NOBODY {
                break;
            }
        }
    }
#endif
    return sum;
}
#else
fn local_lights(surface: Surface, pixels: vec2<f32>) -> vec3<f32> {
#ifdef VOLUMES
    return textureLoad(gathered, vec2<i32>(pixels), 0).rgb;
#else
    return vec3(0.0);
#endif
}
#endif

fn directional_lights(surface: Surface, pixels: vec2<f32>) -> vec3<f32> {
    var sum = vec3(0.0);
#ifdef SUNS
    for (var i = 0u; i < bevy::lights.n_directional_lights; i++) {
        let light = &bevy::lights.directional_lights[i];
        let color = (*light).color.rgb;
        let to_light = (*light).direction_to_light;
        // A light of no strength, of a negative or none that is a number; from nowhere.
        if !(all(color >= vec3(0.0)) && all(color < vec3(1e30)) && max(color.r, max(color.g, color.b)) > 0.0 && dot(to_light, to_light) > 0.5) {
            continue;
        }
        var seen = 1.0;
#ifdef SUN_SHADOWS
        if (surface.flags & SHADOW_RECEIVER) != 0u {
            let place = vec4(surface.position + bevy::view.world_position, 1.0);
            if ((*light).flags & DIRECTIONAL_LIGHT_FLAGS_SHADOWS_ENABLED_BIT) != 0u {
                let depth = dot(bevy::view.world_from_view[2].xyz, surface.position);
                seen = shadows::fetch_directional_shadow(i, place, surface.normal, depth, pixels);
            }
#ifdef CONTACT_SHADOWS
            let steps = bevy::contact_shadows_settings.linear_steps;
            if steps > 0u && seen > 0.0 && ((*light).flags & DIRECTIONAL_LIGHT_FLAGS_CONTACT_SHADOWS_ENABLED_BIT) != 0u {
                seen *= pbr_functions::calculate_contact_shadow(place.xyz, pixels, to_light, steps);
            }
#endif
        }
#endif
        sum += shade(surface, Incident(to_light, 1.0, color, 0.0)) * seen;
    }
#endif
    return sum;
}

struct Occlusion {
    diffuse: vec3<f32>,
    specular: f32,
}

fn occlusion_at(surface: Surface, pixels: vec2<f32>) -> Occlusion {
    var occlusion = Occlusion(vec3(select(1.0, surface.occlusion, surface.model == STANDARD)), 1.0);
#ifdef OCCLUDED
    var visible = 1.0;
#ifdef SCREEN_SPACE_AMBIENT_OCCLUSION
    visible = textureLoad(screen_space_ambient_occlusion_texture, vec2<i32>(pixels), 0i).r;
#endif
#ifdef AMBIENT_OCCLUSION
    visible = min(visible, textureLoad(visible_share, vec2<i32>(pixels - bevy::view.viewport.xy), 0).r);
#endif
    occlusion.diffuse = min(occlusion.diffuse, ssao_multibounce(visible, surface.base_color));
    // Lagarde and de Rousiers 2014.
    let power = exp2(-16.0 * surface.roughness - 1.0);
    occlusion.specular = saturate(pow(surface.n_dot_v + visible, power) - 1.0 + visible);
#endif
    return occlusion;
}

// Light from everywhere: Bevy's environment maps, irradiance volumes and ambient light.
fn indirect_light(surface: Surface, pixels: vec2<f32>) -> vec3<f32> {
    let occlusion = occlusion_at(surface, pixels);
    let place = surface.position + bevy::view.world_position;
    if surface.model != STANDARD {
        return surface.base_color * bevy::lights.ambient_color.rgb * occlusion.diffuse;
    }
    var light = vec3(0.0);
#ifdef NEEDS_PROBES
    let orthographic = bevy::view.clip_from_view[3].w == 1.0;
    let depth = dot(bevy::view.world_from_view[2].xyz, surface.position);
    let cluster = clustering::view_fragment_cluster_index(pixels, depth, orthographic);
    var ranges = clustering::unpack_clusterable_object_index_ranges(cluster);
    var found = false;
#ifdef IRRADIANCE_VOLUME
    light += irradiance_volume::irradiance_volume_light(place, surface.normal, &ranges) * surface.diffuse * occlusion.diffuse;
    found = true;
#endif
#ifdef ENVIRONMENT_MAP
    var input: bevy_lighting::LightingInput;
    input.layers[0].NdotV = surface.n_dot_v;
    input.layers[0].N = surface.normal;
    input.layers[0].R = reflect(-surface.view, surface.normal);
    input.layers[0].perceptual_roughness = surface.perceptual_roughness;
    input.layers[0].roughness = surface.roughness;
    input.layers[1] = input.layers[0];
    let coat = sqrt(surface.clearcoat_roughness);
    input.layers[1].perceptual_roughness = coat;
    input.layers[1].roughness = surface.clearcoat_roughness;
    input.clearcoat_strength = surface.clearcoat;
    input.P = place;
    input.V = surface.view;
    input.diffuse_color = surface.diffuse;
    input.metallic = surface.metallic;
    let reflectance = f32((surface.words.z) & 255u) / 255.0;
    input.F0_dielectric = vec3(0.16 * reflectance * reflectance);
    input.F0_metallic = surface.base_color;
    input.F_ab = bevy_lighting::F_AB(surface.perceptual_roughness, surface.n_dot_v);
    let environment = environment_map::environment_map_light(&input, &ranges, found);
    light += environment.diffuse * occlusion.diffuse;
    var reflections = 1.0;
#ifdef SCREEN_SPACE_REFLECTIONS
    // Those add the specular part themselves.
    let settings = bevy::ssr_settings;
    if surface.perceptual_roughness <= settings.max_perceptual_roughness && surface.perceptual_roughness >= settings.min_perceptual_roughness {
        reflections = 0.0;
    }
#endif
    light += environment.specular * (occlusion.specular * reflections);
#endif
#endif
    light += ambient::ambient_light(vec4(place, 1.0), surface.normal, surface.view, surface.n_dot_v, surface.diffuse, surface.at_normal, surface.perceptual_roughness, occlusion.diffuse);
    return light;
}

// What the surface sends out itself, darkened by its clearcoat.
fn emitted(surface: Surface) -> vec3<f32> {
    if surface.model != STANDARD || surface.clearcoat <= 0.0 {
        return surface.emissive;
    }
    return surface.emissive * (1.0 - surface.clearcoat * bevy_lighting::F_Schlick(0.04, 1.0, surface.n_dot_v));
}

// 0 in place of what is no number, such as an environment map may hold; by its bits, for comparisons with NaN may be
// optimised away.
fn numbers(v: vec3<f32>) -> vec3<f32> {
    let bits = bitcast<vec3<u32>>(v) & vec3(0x7fffffffu);
    return select(v, vec3(0.0), bits > vec3(0x7f800000u));
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let words = textureLoad(bevy::deferred_prepass_texture, pixel, 0);
    let model = u32(#{MODEL});
    let depth = prepass_utils::prepass_depth(position, 0u);
    // For fog and tone mapping, which are Bevy's.
    let input = pbr_input_from_deferred_gbuffer(vec4(position.xy, depth, 0.0), words);
    let surface = surface_at(position.xy, depth, words, model);
    var radiance = surface.emissive;
    if (surface.flags & UNLIT) == 0u {
        let reflected = directional_lights(surface, position.xy) + local_lights(surface, position.xy) + indirect_light(surface, position.xy);
        radiance = reflected * bevy::view.exposure + emitted(surface);
    }
    // Beyond it there is no number that the passes to come could add to.
    radiance = min(numbers(radiance), vec3(lighting.brightest));
    return pbr_functions::main_pass_post_lighting_processing(input, vec4(radiance, 1.0));
}
