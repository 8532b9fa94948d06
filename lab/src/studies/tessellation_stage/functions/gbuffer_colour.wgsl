#define_import_path bevy_pbr::rgb9e5

// Stands in for Bevy's module of this name, with the one function that the stage's draw takes from it.

// Three mantissas of 9 bits and an exponent of 5 (EXT_texture_shared_exponent).
fn vec3_to_rgb9e5_(colour: vec3<f32>) -> u32 {
    let rgb = clamp(colour, vec3(0.0), vec3(65408.0));
    let most = max(rgb.r, max(rgb.g, rgb.b));
    let power = i32((bitcast<u32>(most) & 0x7f800000u) >> 23u) - 127;
    var shared_power = max(-16, power) + 16;
    var unit = exp2(f32(shared_power - 24));
    if i32(floor(most / unit + 0.5)) == 512 {
        unit *= 2.0;
        shared_power += 1;
    }
    let n = vec3<u32>(floor(rgb / unit + 0.5));
    return (u32(shared_power) << 27u) | (n.b << 18u) | (n.g << 9u) | n.r;
}
