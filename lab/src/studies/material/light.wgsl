// Lights a G-buffer as a stand-in for the engine's lighting pass: one sun, a sky above, haze. A pixel of the picture is
// the mean of a block of pixels of the G-buffer, `samples` along a side.

struct Light {
    clip_to_anchor: mat4x4<f32>,
    // Relative to the anchor, metres.
    camera: vec3<f32>,
    // Samples along a side of a pixel of the picture.
    samples: u32,
    // Towards the sun or the moon.
    towards: vec3<f32>,
    // Of everything: how bright the picture is made.
    exposure: f32,
    // Light of the sun on a plane that faces it, and of the sky on one that faces up.
    sun: vec3<f32>,
    // Extinction of the air, 1/m.
    haze: f32,
    sky: vec3<f32>,
    pad: u32,
    // By how many samples the blocks are moved to the right.
    shift: u32,
    pad_b: u32,
    // Pixels of the picture.
    size: vec2<u32>,
}

@group(0) @binding(0) var<uniform> light: Light;
@group(0) @binding(1) var words: texture_2d<u32>;
@group(0) @binding(2) var depth: texture_depth_2d;
// Red, green, blue as a display shows them, linear, one pixel after the other.
@group(0) @binding(3) var<storage, read_write> picture: array<vec4<f32>>;

const PI: f32 = 3.1415927;

// As Bevy's G-buffer holds normals.
fn octahedral_decode(stored: vec2<f32>) -> vec3<f32> {
    let f = stored * 2.0 - 1.0;
    var n = vec3(f, 1.0 - abs(f.x) - abs(f.y));
    let t = saturate(-n.z);
    let w = select(vec2(t), vec2(-t), n.xy >= vec2(0.0));
    return normalize(vec3(n.xy + w, n.z));
}

fn ggx(n: vec3<f32>, v: vec3<f32>, l: vec3<f32>, roughness: f32, f0: f32) -> f32 {
    let h = normalize(v + l);
    let a = roughness * roughness;
    let nh = max(dot(n, h), 0.0);
    let d = nh * nh * (a * a - 1.0) + 1.0;
    let spread = a * a / (PI * d * d);
    let nv = max(dot(n, v), 1e-3);
    let nl = max(dot(n, l), 1e-3);
    let k = (roughness + 1.0) * (roughness + 1.0) / 8.0;
    let seen = 1.0 / ((nv * (1.0 - k) + k) * (nl * (1.0 - k) + k) * 4.0);
    let fresnel = f0 + (1.0 - f0) * pow(1.0 - max(dot(v, h), 0.0), 5.0);
    return spread * seen * fresnel;
}

// The curve that films have (K. Narkowicz, "ACES filmic tone mapping curve", 2016).
fn film(x: vec3<f32>) -> vec3<f32> {
    return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), vec3(0.0), vec3(1.0));
}

fn lit(at: vec2<u32>) -> vec3<f32> {
    let size = vec2<f32>(textureDimensions(words));
    let z = textureLoad(depth, at, 0);
    let ndc = (vec2<f32>(at) + 0.5) / size * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    let far = light.clip_to_anchor * vec4(ndc, 1e-4, 1.0);
    let ray = normalize(far.xyz / far.w - light.camera);
    let air = light.sky * mix(1.3, 0.7, clamp(ray.y * 2.0, 0.0, 1.0)) / PI;
    if z == 0.0 {
        return film(air * light.exposure);
    }
    let place = light.clip_to_anchor * vec4(ndc, z, 1.0);
    let position = place.xyz / place.w;
    let word = textureLoad(words, at, 0);
    let base = unpack4x8unorm(word.x);
    let albedo = pow(base.rgb, vec3(2.2));
    let roughness = max(base.a, 0.045);
    let third = unpack4x8unorm(word.z);
    let f0 = 0.16 * third.x * third.x;
    let n = octahedral_decode(vec2(f32(word.w & 0xfffu), f32((word.w >> 12u) & 0xfffu)) / 4095.0);
    let v = normalize(light.camera - position);
    let nl = max(dot(n, light.towards), 0.0);
    let up = 0.5 + 0.5 * n.y;
    var colour = light.sun * nl * (albedo / PI + ggx(n, v, light.towards, roughness, f0));
    let mirrored = f0 + (1.0 - f0) * pow(1.0 - max(dot(n, v), 0.0), 5.0) * (1.0 - roughness);
    colour += light.sky * third.z * (albedo * mix(0.35, 1.0, up) + mirrored) / PI;
    let clear = exp(-light.haze * distance(position, light.camera));
    return film(mix(air, colour, clear) * light.exposure);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= light.size) {
        return;
    }
    let last = textureDimensions(words) - 1u;
    let within = id.xy * light.samples + vec2(light.shift, 0u);
    var sum = vec3(0.0);
    for (var y = 0u; y < light.samples; y++) {
        for (var x = 0u; x < light.samples; x++) {
            sum += lit(min(within + vec2(x, y), last));
        }
    }
    picture[id.y * light.size.x + id.x] = vec4(sum / f32(light.samples * light.samples), 1.0);
}
