#define_import_path dolomite::classic::look

// Colours of the classic scene: not part of what is compared.

#import dolomite::geometry::draw_types::Shaded

// Where the light stands, metres.
const LIGHT: vec3<f32> = vec3(300.0, 500.0, 200.0);

// How much of the light falls on a place of the world, and its height between the lowest and the highest
// ground, both 0 to 1.
fn lit(place: vec3<f32>, normal: vec3<f32>) -> vec2<f32> {
    return vec2(max(dot(normalize(LIGHT - place), normal), 0.0), (place.y + 90.0) / 200.0);
}

// A colour that is not lit again.
fn coloured(normal: vec3<f32>, light: f32, height: f32) -> Shaded {
    let grass = mix(vec3(0.06, 0.16, 0.22), vec3(0.14, 0.30, 0.07), clamp(height * 4.0, 0.0, 1.0));
    let rock = mix(grass, vec3(0.36, 0.28, 0.20), clamp(height * 4.0 - 1.6, 0.0, 1.0));
    let colour = mix(rock, vec3(0.9), clamp(height * 5.0 - 3.4, 0.0, 1.0));
    return Shaded(colour * (0.12 + 0.88 * light), vec3(0.0), normal, 1.0, 0.0, 0.0, 1.0, true, false);
}
