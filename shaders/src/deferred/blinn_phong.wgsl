#define_import_path dolomite::deferred::blinn_phong

#import dolomite::deferred::gbuffer::{PHONG, decode_color, unpack_bytes}
#import dolomite::deferred::types::{Incident, Surface}

// Blinn (1977), normalised so that an eye on the normal sees of light from everywhere the specular colour itself:
// the lobe is (n·h)^s (s + 2)(s + 4) / 8π(s + 2^(-s/2)). The G-buffer holds the specular colour, gamma 2.2, in the
// third word, and the exponent as its logarithm in 16 bits: the highest bytes of the first word and of the third.
// By the flag PHONG it is Phong's (1975) lobe, with the mirrored light r: (r·v)^s (s + 2) / 2π (Lafortune and Willems
// 1994).

// Exponents from 1 to 65536 in steps of 0.017 %.
fn unpack_exponent(words: vec4<u32>) -> f32 {
    return exp2(f32(((words.x >> 24u) << 8u) | (words.z >> 24u)) / 65535.0 * 16.0);
}

// The two bytes, highest first.
fn exponent_bytes(exponent: f32) -> vec2<f32> {
    let steps = u32(log2(clamp(exponent, 1.0, 65536.0)) / 16.0 * 65535.0 + 0.5);
    return vec2(f32(steps >> 8u), f32(steps & 255u)) / 255.0;
}

// Reflected radiance, cd/m².
fn blinn_phong(surface: Surface, light: Incident) -> vec3<f32> {
    let n_dot_l = saturate(dot(surface.normal, light.to_light));
    let sum = light.to_light + surface.view;
    let h = sum * inverseSqrt(max(dot(sum, sum), 1e-20));
    let is_phong = (surface.flags & PHONG) != 0u;
    let one = select(surface.normal, reflect(-light.to_light, surface.normal), is_phong);
    let other = select(h, surface.view, is_phong);
    // cos² from the sine, which keeps its digits where a highlight is small: ln cos = ½ ln(1 - sin²).
    let across = cross(one, other);
    let exponent = unpack_exponent(surface.words);
    // It belongs to the side of the surface that the eye is on.
    let facing = dot(one, other) > 0.0 && dot(surface.normal, surface.view) > 0.0;
    let lobe = select(0.0, power_of_cosine(dot(across, across), exponent), facing);
    let specular = decode_color(unpack_bytes(surface.words.z).xyz);
    let blinns = (exponent + 2.0) * (exponent + 4.0) / (8.0 * (exponent + exp2(-0.5 * exponent)));
    let normalisation = select(blinns, 0.5 * (exponent + 2.0), is_phong);
    return (surface.base_color + specular * (lobe * normalisation)) * (n_dot_l * 0.318309886) * light.color;
}

// cos^s by sin².
fn power_of_cosine(sine_squared: f32, exponent: f32) -> f32 {
    let y = min(sine_squared, 1.0);
    // ln(1 - y), by its series where the difference would round.
    let series = -y * (1.0 + y * (0.5 + y * (0.33333333 + y * 0.25)));
    let logarithm = select(log(max(1.0 - y, 1e-38)), series, y < 0.01);
    return exp(0.5 * exponent * logarithm);
}
