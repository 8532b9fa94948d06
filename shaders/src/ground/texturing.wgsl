#define_import_path dolomite::ground::texturing

// Ground textures without visible tiling. Pure but for the textures passed in.
// Method: two copies of the texture at offsets that change with a low-frequency index, blended
// where the index changes (Quilez, "texture repetition", technique 3), plus a larger scale that
// takes over with distance.

#import dolomite::terrain::hash::pcg

// A texel pair of one material: albedo and height, normal xy in -1..1, roughness, occlusion.
struct Texel {
    albedo: vec3<f32>,
    height: f32,
    normal: vec2<f32>,
    roughness: f32,
    occlusion: f32,
}

fn unit_hash(cell: vec2<i32>, seed: u32) -> f32 {
    let h = pcg(bitcast<u32>(cell.x) + pcg(bitcast<u32>(cell.y) + pcg(seed)));
    return f32(h >> 8u) * 5.9604645e-8; // 2^-24: the top 24 bits are exact in f32.
}

// Two numbers in 0..1 of a cell.
fn hash_pair(cell: vec2<i32>, seed: u32) -> vec2<f32> {
    let h = pcg(bitcast<u32>(cell.x) + pcg(bitcast<u32>(cell.y) + pcg(seed)));
    return vec2(f32(h >> 16u), f32(h & 0xffffu)) * 1.5259022e-5; // 1 / 65535.
}

// Two value noises in 0..1 for one, and the slope of the first, all with a smooth step between lattice values.
struct NoisePair {
    value: vec2<f32>,
    slope: vec2<f32>,
}

fn noise_pair(p: vec2<f32>, seed: u32) -> NoisePair {
    let cell = vec2<i32>(floor(p));
    let f = fract(p);
    let t = f * f * (3.0 - 2.0 * f);
    let a = hash_pair(cell, seed);
    let b = hash_pair(cell + vec2(1, 0), seed);
    let c = hash_pair(cell + vec2(0, 1), seed);
    let d = hash_pair(cell + vec2(1, 1), seed);
    let low = mix(a, b, t.x);
    let high = mix(c, d, t.x);
    let along = vec2(mix(b.x - a.x, d.x - c.x, t.y), high.x - low.x);
    return NoisePair(mix(low, high, t.y), along * 6.0 * f * (1.0 - f));
}

// Value noise in 0..1 with a smooth step between lattice values; for colour only.
fn value_noise(p: vec2<f32>, seed: u32) -> f32 {
    return noise_pair(p, seed).value.x;
}

fn sample_once(
    albedo_height: texture_2d_array<f32>,
    normal_roughness: texture_2d_array<f32>,
    textures: sampler,
    layer: u32,
    uv: vec2<f32>,
    dx: vec2<f32>,
    dy: vec2<f32>,
) -> Texel {
    let a = textureSampleGrad(albedo_height, textures, uv, layer, dx, dy);
    let n = textureSampleGrad(normal_roughness, textures, uv, layer, dx, dy);
    return Texel(a.rgb, a.a, n.xy * 2.0 - 1.0, n.z, n.w);
}

fn mix_texels(a: Texel, b: Texel, t: f32) -> Texel {
    return Texel(
        mix(a.albedo, b.albedo, t),
        mix(a.height, b.height, t),
        mix(a.normal, b.normal, t),
        mix(a.roughness, b.roughness, t),
        mix(a.occlusion, b.occlusion, t),
    );
}

// Where a copy of the textures lies, tiles.
fn copy_offset(copy: i32) -> vec2<f32> {
    return vec2(unit_hash(vec2(copy, 0), 11u), unit_hash(vec2(copy, 1), 11u));
}

// Two copies at offsets of `index`'s whole neighbours.
fn sample_varied(
    albedo_height: texture_2d_array<f32>,
    normal_roughness: texture_2d_array<f32>,
    textures: sampler,
    layer: u32,
    uv: vec2<f32>,
    dx: vec2<f32>,
    dy: vec2<f32>,
    index: f32,
) -> Texel {
    let whole = i32(floor(index));
    let t = smoothstep(0.25, 0.75, fract(index));
    let o0 = copy_offset(whole);
    let o1 = copy_offset(whole + 1);
    if t <= 0.0 {
        return sample_once(albedo_height, normal_roughness, textures, layer, uv + o0, dx, dy);
    }
    if t >= 1.0 {
        return sample_once(albedo_height, normal_roughness, textures, layer, uv + o1, dx, dy);
    }
    let a = sample_once(albedo_height, normal_roughness, textures, layer, uv + o0, dx, dy);
    let b = sample_once(albedo_height, normal_roughness, textures, layer, uv + o1, dx, dy);
    return mix_texels(a, b, t);
}
