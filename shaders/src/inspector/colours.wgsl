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
