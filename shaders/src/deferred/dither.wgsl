#define_import_path dolomite::deferred::dither

// What is added to four numbers before they become bytes, so that the mean over neighbouring pixels is what it was and not
// the nearest byte (Roberts, "Picture coding using pseudo-random noise", 1962, with the ordered pattern of Bayer 1973).
// Without DITHERED it is nothing.

#ifdef DITHERED
// Each of 0 to 63 once in 8 × 8 pixels, neighbours far apart.
fn order(x: u32, y: u32) -> u32 {
    var value = 0u;
    for (var k = 0u; k < 3u; k++) {
        let a = (x >> k) & 1u;
        let b = (y >> k) & 1u;
        value = (value << 2u) | ((a ^ b) << 1u) | b;
    }
    return value;
}
#endif

// In steps of a byte, from -63/128 to 63/128: a number that is a byte stays it. `word` tells apart words of the pixel, so
// that their errors are not alike.
fn dither(pixel: vec2<f32>, word: u32) -> vec4<f32> {
#ifdef DITHERED
    let x = u32(pixel.x) + 3u * word;
    let y = u32(pixel.y) + 5u * word;
    let orders = vec4(order(x, y), order(x ^ 1u, y ^ 2u), order(x ^ 4u, y ^ 1u), order(x ^ 5u, y ^ 3u));
    return ((vec4<f32>(orders) + 0.5) / 64.0 - 0.5) / 255.0;
#else
    return vec4(0.0);
#endif
}
