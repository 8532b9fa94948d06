#define_import_path dolomite::vegetation::colour

// The colour of a blade before light. CPU reference: plugins/vegetation/src/colour.rs.

#import dolomite::vegetation::draw_types::Look
#import dolomite::vegetation::shape::own

// What differs from blade to blade: a factor of the colour, and how dry the tip is. `noise`: two smooth noises of the place,
// 0 to 1. `calm`: how much of what differs is drawn as its mean, 0 to 1.
fn blade_tint(look: Look, hash: u32, clump: u32, noise: vec2<f32>, calm: f32) -> vec2<f32> {
    let of_clump = own(clump, 10u) - 0.5;
    let dryness = clamp(0.5 * noise.x + 0.8 * noise.y - 0.35 + 0.4 * of_clump, 0.0, 1.0);
    let is_dry = select(0.0, 1.0, own(hash, 11u) < look.dry.w);
    let dry = clamp(1.4 * dryness * sqrt(look.dry.w) + 0.7 * mix(is_dry, look.dry.w, calm), 0.0, 1.0);
    let value = mix(0.75 + 0.5 * own(hash, 12u), 1.0, 0.8 * calm) * (0.9 + 0.25 * noise.x + 0.2 * of_clump);
    return vec2(value, dry);
}

// At a share `t` of the way from the root to the tip.
fn blade_colour(look: Look, tint: vec2<f32>, t: f32) -> vec3<f32> {
    let green = mix(look.root.xyz, look.tip.xyz, t * (1.6 - 0.6 * t));
    return tint.x * mix(green, look.dry.xyz, tint.y * smoothstep(0.05, 0.9, t));
}

// Where among the entries of a far field the sine of an elevation lies.
fn far_place(sine: f32) -> f32 {
    return clamp(2.0 * log2(max(sine, 0.00390625)) + 16.0, 0.0, 16.0);
}

// Light stands above: what is below is in the shade of the others.
fn shade_at(t: f32) -> f32 {
    return mix(0.48, 1.0, smoothstep(0.0, 0.8, t));
}

// How calm colours and normals are at a distance: what is less than a pixel has the light of the meadow, not its own.
fn calm_at(first: f32, distance: f32) -> f32 {
    return smoothstep(0.0, 1.0, clamp(distance / (5.0 * first), 0.0, 1.0));
}

// The normal by which a face reflects `share` of the light that comes from behind it, and all of what comes from the sky. As
// it is where the sun stands before it. `sun` points to the sun; both are unit vectors.
fn lit_through(normal: vec3<f32>, sun: vec3<f32>, share: f32) -> vec3<f32> {
    let from_sun = dot(normal, sun);
    if from_sun >= 0.0 {
        return normal;
    }
    let to_sun = -from_sun * share;
    // Straight from behind any direction is aside: one that is not near the sun's.
    let other = select(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), abs(sun.x) > 0.7);
    let beside = normal - from_sun * sun;
    let aside = select(cross(sun, other), beside, dot(beside, beside) > 1e-6);
    return to_sun * sun + sqrt(max(1.0 - to_sun * to_sun, 0.0)) * normalize(aside);
}
