#define_import_path dolomite::vegetation::draw_types

// What the draws are told, byte for byte as plugins/vegetation/src/render/layout.rs.

#import dolomite::vegetation::press::Press
#import dolomite::vegetation::wind::WindField

// What a kind looks like; colours are linear.
struct Look {
    // w: greatest lean, as the sine of an angle.
    root: vec4<f32>,
    // w: how far the tip hangs over.
    tip: vec4<f32>,
    // w: share of dry ones.
    dry: vec4<f32>,
    // Least and greatest length, width at the root, metres; share of the light that comes through.
    size: vec4<f32>,
    // How far the tip moves in 1 m/s as a share of the length; how much clumps differ; width in mean distances of roots;
    // optical depth of all from the side.
    sway: vec4<f32>,
    // As Layer.reach.
    reach: vec4<f32>,
    // A flower's: colour of its petals, and radius. A chain's: length of a segment, how many at most, greatest angle
    // between two; of its size the first two are the least and greatest share of the depth.
    head: vec4<f32>,
    // A flower's: colour of its middle, and number of petals.
    middle: vec4<f32>,
}

// What the ground shows of a kind where it ends: depth and colour at the sines 2^(k/2 - 8); 0 where that is not known.
struct Far {
    entries: array<vec4<f32>, 17>,
}

struct BladeView {
    // From the anchor to clip space, this frame and the last.
    clip: mat4x4<f32>,
    previous_clip: mat4x4<f32>,
    camera: vec3<f32>,
    pixels_per_radian: f32,
    // Towards the sun, of length 1; 0 without one.
    sun: vec3<f32>,
    press_count: u32,
    // World position of the anchor, metres.
    anchor: vec2<i32>,
    // Height of the water above the anchor, metres.
    water: f32,
    pad: u32,
    // This frame and the last.
    wind: WindField,
    previous_wind: WindField,
    looks: array<Look, 8>,
    far: array<Far, 8>,
    presses: array<Press, 64>,
}
