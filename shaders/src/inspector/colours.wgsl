#define_import_path dolomite::inspector::colours

// Numbers as colours. All are as a picture file keeps them (encoded by sRGB, 0 to 1), so that who reads a pixel of the
// picture reads the number. Rust: `picture/colours.rs` of `dolomite_inspector`.

// IEC 61966-2-1.
fn linear_of(encoded: vec3<f32>) -> vec3<f32> {
    let low = encoded / 12.92;
    let high = pow((encoded + 0.055) / 1.055, vec3(2.4));
    return select(high, low, encoded <= vec3(0.04045));
}

// The inverse.
fn encoded_of(linear: vec3<f32>) -> vec3<f32> {
    let low = linear * 12.92;
    let high = 1.055 * pow(max(linear, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3(0.0031308));
}

// White at `near`, black at `far` and beyond; every power of ten has as much room. Both are above 0 and differ.
fn distance_grey(distance: f32, near: f32, far: f32) -> f32 {
    return 1.0 - saturate(log2(max(distance, 1e-30) / near) / log2(far / near));
}

// Grey at rest; red to the right, green downwards, full at `fastest`.
fn motion_colour(pixels: vec2<f32>, fastest: f32) -> vec3<f32> {
    return saturate(vec3(0.5 + 0.5 * pixels / fastest, 0.5));
}

// 0 is black, then blue, green, yellow; 1 and more is red.
fn heat(share: f32) -> vec3<f32> {
    let x = saturate(share) * 4.0;
    let red = saturate(x - 2.0);
    let green = saturate(x - 1.0) - saturate(x - 3.0);
    let blue = saturate(x) - saturate(x - 1.0);
    return vec3(red, green, blue);
}

// A radiance without an end: 0.5 at 1.
fn bounded(radiance: vec3<f32>) -> vec3<f32> {
    return radiance / (1.0 + max(radiance.r, max(radiance.g, radiance.b)));
}

// No ground, or nothing else that is to be seen: a grey, which no ramp or level has.
const NOTHING: vec3<f32> = vec3(0.25, 0.25, 0.25);
// A map that was drawn in this frame, and one that holds what an earlier frame drew.
const DRAWN: vec3<f32> = vec3(0.902, 0.624, 0.0);
const KEPT: vec3<f32> = vec3(0.0, 0.447, 0.698);
// What is beyond a ramp.
const MORE: vec3<f32> = vec3(0.3, 0.65, 1.0);

// 0 is black, then indigo, orange, and pale yellow at 1: ever brighter, so that it is read without its hues. `MORE` above 1.
fn ramp(share: f32) -> vec3<f32> {
    if share > 1.0 {
        return MORE;
    }
    let x = saturate(share) * 3.0;
    let low = mix(vec3(0.0), vec3(0.35, 0.0, 0.55), saturate(x));
    let middle = mix(low, vec3(0.9, 0.35, 0.1), saturate(x - 1.0));
    return mix(middle, vec3(1.0, 1.0, 0.6), saturate(x - 2.0));
}

// Levels that have a colour of their own.
const LEVELS: u32 = 24u;

// A hue each of eight levels, chosen by Okabe and Ito (2008) for those who see colours otherwise, in the order in which
// neighbours differ most in brightness too; three brightnesses, the coarsest levels darkest. What is finer is as the last.
fn level_colour(level: u32) -> vec3<f32> {
    var hues = array<vec3<f32>, 8>(
        vec3(0.337, 0.706, 0.914),
        vec3(0.0, 0.447, 0.698),
        vec3(0.902, 0.624, 0.0),
        vec3(0.835, 0.369, 0.0),
        vec3(0.941, 0.894, 0.259),
        vec3(0.8, 0.475, 0.655),
        vec3(1.0, 1.0, 1.0),
        vec3(0.0, 0.62, 0.451),
    );
    let own = min(level, LEVELS - 1u);
    return hues[own % 8u] * (0.5 + 0.25 * f32(own / 8u));
}
