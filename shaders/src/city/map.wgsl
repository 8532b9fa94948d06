#define_import_path dolomite::city::map

// Displacement maps: a biquadratic B-spline over periodic texels, four of which lie in a word. The CPU reference:
// plugins/city/src/map.rs.

struct MapSample {
    height: f32,
    // By a texel.
    slope: vec2<f32>,
}

// Weights of three texels at a fraction behind the edge of the middle one, and their derivatives.
fn spline_weights(f: f32) -> vec3<f32> {
    let g = 1.0 - f;
    return vec3(0.5 * g * g, 0.5 + f * g, 0.5 * f * f);
}

fn spline_slopes(f: f32) -> vec3<f32> {
    return vec3(f - 1.0, 1.0 - 2.0 * f, f);
}

// Texel of three by three at a place, from the words of them.
fn texel_at(x: i32, y: i32, number: u32, side: i32) -> u32 {
    let mask = side - 1;
    return u32((y & mask) * side + (x & mask)) + number * u32(side * side);
}

// A place in texels as the texel before it, and what lies behind.
fn texel_place(at: vec2<f32>) -> vec4<f32> {
    let whole = floor(at);
    return vec4(whole, at - whole);
}

// From rows of three texels of 0 to 255.
fn spline(rows: mat3x3<f32>, f: vec2<f32>) -> MapSample {
    let wx = spline_weights(f.x);
    let wy = spline_weights(f.y);
    let dx = spline_slopes(f.x);
    let dy = spline_slopes(f.y);
    let values = vec3(dot(wx, rows[0]), dot(wx, rows[1]), dot(wx, rows[2]));
    let slopes = vec3(dot(dx, rows[0]), dot(dx, rows[1]), dot(dx, rows[2]));
    return MapSample(dot(wy, values) / 255.0, vec2(dot(wy, slopes), dot(dy, values)) / 255.0);
}
