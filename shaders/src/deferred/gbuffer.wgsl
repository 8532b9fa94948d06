#define_import_path dolomite::deferred::gbuffer

// A pixel of Bevy's deferred target (`Rgba32Uint`), as every material writes it and every light reads it:
//
//   x  base colour, gamma 2.2, 8 bits a channel; the highest byte is the shading model's own
//      (Bevy's standard material: perceptual roughness)
//   y  emitted radiance, RGB9E5: nine bits a channel and a shared exponent of five
//   z  four bytes of the shading model's own
//      (standard: reflectance, metallic, occlusion, clearcoat and its roughness in four bits each)
//   w  normal, octahedral (Meyer 2010), 12 bits a coordinate; the highest byte holds flags
//
// Colours are linear sRGB, the normal is of length 1 in world space. Rust: `gbuffer.rs` of `dolomite_deferred`.

const UNLIT: u32 = 1u;
const FOG: u32 = 2u;
const SHADOW_RECEIVER: u32 = 4u;
// Of the Blinn-Phong model: the highlight is Phong's.
const PHONG: u32 = 8u;

// Of the bytes of a word; values outside of [0, 1] are clamped.
fn pack_bytes(values: vec4<f32>) -> u32 {
    let bytes = vec4<u32>(saturate(values) * 255.0 + 0.5);
    return bytes.x | (bytes.y << 8u) | (bytes.z << 16u) | (bytes.w << 24u);
}

fn unpack_bytes(word: u32) -> vec4<f32> {
    return vec4<f32>((vec4(word) >> vec4(0u, 8u, 16u, 24u)) & vec4(255u)) / 255.0;
}

// The power of two with an exponent from -126 to 127: exact, which `exp2` need not be.
fn power_of_two(exponent: i32) -> f32 {
    return bitcast<f32>(u32(exponent + 127) << 23u);
}

// RGB9E5 as in EXT_texture_shared_exponent; channels are clamped to [0, 65408].
fn pack_emissive(radiance: vec3<f32>) -> u32 {
    let rgb = clamp(radiance, vec3(0.0), vec3(65408.0));
    let most = max(rgb.r, max(rgb.g, rgb.b));
    let floor_log2 = i32((bitcast<u32>(most) & 0x7f800000u) >> 23u) - 127;
    var shared_exponent = max(-16, floor_log2) + 16;
    var scale = power_of_two(24 - shared_exponent);
    if floor(most * scale + 0.5) == 512.0 {
        scale *= 0.5;
        shared_exponent += 1;
    }
    let mantissas = vec3<u32>(floor(rgb * scale + 0.5));
    return mantissas.r | (mantissas.g << 9u) | (mantissas.b << 18u) | (u32(shared_exponent) << 27u);
}

fn unpack_emissive(word: u32) -> vec3<f32> {
    let mantissas = vec3<f32>((vec3(word) >> vec3(0u, 9u, 18u)) & vec3(511u));
    return mantissas * power_of_two(i32(word >> 27u) - 24);
}

// Off by 0.059 degrees at most.
fn pack_normal(normal: vec3<f32>, flags: u32) -> u32 {
    let n = normal / (abs(normal.x) + abs(normal.y) + abs(normal.z));
    let folded = (1.0 - abs(n.yx)) * select(vec2(-1.0), vec2(1.0), n.xy > vec2(0.0));
    let octahedral = select(folded, n.xy, n.z >= 0.0) * 0.5 + 0.5;
    let bits = vec2<u32>(saturate(octahedral) * 4095.0 + 0.5);
    return bits.x | (bits.y << 12u) | (flags << 24u);
}

fn unpack_normal(word: u32) -> vec3<f32> {
    let octahedral = vec2<f32>(vec2(word, word >> 12u) & vec2(4095u)) / 4095.0 * 2.0 - 1.0;
    let z = 1.0 - abs(octahedral.x) - abs(octahedral.y);
    let t = saturate(-z);
    return normalize(vec3(octahedral + select(vec2(t), vec2(-t), octahedral >= vec2(0.0)), z));
}

fn unpack_flags(word: u32) -> u32 {
    return word >> 24u;
}

// The standard gamma of the base colour.
fn encode_color(linear: vec3<f32>) -> vec3<f32> {
    return pow(linear, vec3(1.0 / 2.2));
}

fn decode_color(encoded: vec3<f32>) -> vec3<f32> {
    return pow(encoded, vec3(2.2));
}
