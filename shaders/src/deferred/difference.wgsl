// How far two pictures of a view are apart in each pixel: of what was lit, and of what was lit once more by the reference.

@group(0) @binding(0) var lit: texture_2d<f32>;
@group(0) @binding(1) var reference: texture_2d<f32>;

// Below it a channel is as good as dark, and its difference is one of this: half floats have no finer step there.
const DARK: f32 = 6.103515625e-5;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    return vec4(corner, 0.0, 1.0);
}

// The greatest difference of a channel, as a share of the reference's greatest channel; -1 where nothing is lit.
@fragment
fn fragment(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(place.xy);
    let expected = textureLoad(reference, pixel, 0);
    if expected.a <= 0.0 {
        return vec4(-1.0, 0.0, 0.0, 0.0);
    }
    let off = abs(textureLoad(lit, pixel, 0).rgb - expected.rgb);
    let size = max(max(expected.r, max(expected.g, expected.b)), DARK);
    return vec4(max(off.r, max(off.g, off.b)) / size, 0.0, 0.0, 0.0);
}
