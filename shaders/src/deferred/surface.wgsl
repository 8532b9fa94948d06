#define_import_path dolomite::deferred::surface

#import dolomite::deferred::gbuffer::{decode_color, unpack_bytes, unpack_emissive, unpack_flags, unpack_normal}
#import dolomite::deferred::standard::roughness_of
#import dolomite::deferred::types::Surface

// Decodes a pixel; `energy` is left 0.
fn decode(words: vec4<u32>, model: u32, position: vec3<f32>, view: vec3<f32>) -> Surface {
    var surface: Surface;
    surface.words = words;
    surface.model = model;
    surface.flags = unpack_flags(words.w);
    surface.position = position;
    surface.view = view;
    surface.normal = unpack_normal(words.w);
    surface.n_dot_v = max(dot(surface.normal, view), 1e-4);
    surface.emissive = unpack_emissive(words.y);
    let first = unpack_bytes(words.x);
    let third = unpack_bytes(words.z);
    surface.base_color = decode_color(first.xyz);
    surface.metallic = third.y;
    surface.perceptual_roughness = first.w;
    surface.roughness = roughness_of(first.w);
    surface.diffuse = surface.base_color * (1.0 - third.y);
    surface.at_normal = mix(vec3(0.16 * third.x * third.x), surface.base_color, third.y);
    surface.occlusion = third.z;
    let coat = words.z >> 24u;
    surface.clearcoat = f32(coat & 15u) / 15.0;
    surface.clearcoat_roughness = roughness_of(f32(coat >> 4u) / 30.0);
    return surface;
}

// The same with what light scattered more than once adds: `share` is what of white light from everywhere one
// reflection sends back.
fn with_energy(surface: Surface, share: f32) -> Surface {
    var brighter = surface;
    brighter.energy = 1.0 / share - 1.0;
    return brighter;
}
