#define_import_path dolomite::deferred::types

// What shading models get. Lengths are metres, directions of length 1 in world space, colours linear sRGB.

// A pixel's surface. Bevy's standard material is decoded once for all lights; a model of your own finds what it
// wrote in `words` (`gbuffer.wgsl` says what all models share).
struct Surface {
    // As they lie in the G-buffer.
    words: vec4<u32>,
    // The lighting id that the material wrote.
    model: u32,
    // UNLIT, FOG, SHADOW_RECEIVER of `gbuffer.wgsl`.
    flags: u32,
    // World axes, from the camera.
    position: vec3<f32>,
    normal: vec3<f32>,
    // Towards the camera.
    view: vec3<f32>,
    // normal · view, at least 1e-4.
    n_dot_v: f32,
    base_color: vec3<f32>,
    emissive: vec3<f32>,
    // From here on: the standard material.
    diffuse: vec3<f32>,
    // Reflectance at normal incidence.
    at_normal: vec3<f32>,
    metallic: f32,
    perceptual_roughness: f32,
    // Squared and clamped, the α of GGX.
    roughness: f32,
    // By how much light scattered more than once between the microfacets adds to it.
    energy: f32,
    occlusion: f32,
    clearcoat: f32,
    clearcoat_roughness: f32,
}

// Light that arrives at a surface.
struct Incident {
    // Towards the light.
    to_light: vec3<f32>,
    // To the middle of the light; 1 for directional lights.
    distance: f32,
    // Illuminance of a surface that faces the light, lux.
    color: vec3<f32>,
    // Of the sphere that shines.
    radius: f32,
}

// Bits of a light's kind: it is a spot light; it has a shadow map; it casts contact shadows.
const SPOT: u32 = 1u;
const CASTS: u32 = 2u;
const CONTACT: u32 = 4u;

// A point or spot light: `LightRow` of `dolomite_deferred`.
struct Light {
    // In the world.
    position: vec3<f32>,
    // Where the light ends.
    range: f32,
    // Luminous intensity, candela.
    color: vec3<f32>,
    // Of the sphere that shines.
    radius: f32,
    // Of the cone's axis, away from the light.
    direction: vec3<f32>,
    // Cosine of the angle from the axis at which the cone ends; -2 for a point light.
    cos_outer: f32,
    // One over the difference of the cosines between which the cone fades.
    cone_scale: f32,
    // Sine of the outer angle.
    sin_outer: f32,
    // SPOT, CASTS, CONTACT.
    kind: u32,
    pad: u32,
}
