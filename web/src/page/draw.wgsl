// Draws what the stage made: fetched by the vertex shader, lit by a sun and a sky, with the triangles' edges over it.

#import dolomite::geometry::draw_types::{Shaded, Surface, geometry_draw, FILL, LINES}
#import dolomite::geometry::vertex::{VERTEX_WORDS, unpack_material, unpack_normal}
#import dolomite::geometry::amplify_types::{StoredVertex}
#import dolomite::geometry::user_material::{material}
#ifdef AMPLIFY
#import dolomite::geometry::user_amplify::{amplify}
#endif

@group(2) @binding(2) var<storage, read> pool: array<u32>;
@group(2) @binding(3) var<storage, read> indices: array<u32>;

struct Varying {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) @interpolate(flat) row: u32,
    @location(4) barycentric: vec3<f32>,
}

fn stored(index: u32) -> StoredVertex {
    let at = index * VERTEX_WORDS;
    let position = bitcast<vec3<f32>>(vec3(pool[at], pool[at + 1u], pool[at + 2u]));
    let uv = unpack2x16snorm(pool[at + 4u]) * geometry_draw.uv_range;
    return StoredVertex(position, unpack_normal(pool[at + 3u]), uv, position, unpack_material(pool[at + 3u]));
}

@vertex
fn vertex(@builtin(vertex_index) number: u32, @builtin(instance_index) primitive: u32) -> Varying {
#ifdef AMPLIFY
    let a = stored(indices[2u * primitive]);
    let b = stored(indices[2u * primitive + 1u]);
    let v = amplify(a, b, b, number);
#else
    let v = stored(indices[number]);
#endif
    let corner = number % 3u;
    var out: Varying;
    out.clip = geometry_draw.clip_from_anchor * vec4(v.position, 1.0);
    out.position = v.position;
    out.normal = v.normal;
    out.uv = v.uv;
    out.row = v.material;
    out.barycentric = vec3(f32(corner == 0u), f32(corner == 1u), f32(corner == 2u));
    return out;
}

// What a light of this direction and colour leaves towards the eye (Burley's roughness; the highlight is that of
// Blinn and Phong, scaled to keep its energy).
fn lit(shaded: Shaded, towards: vec3<f32>, light: vec3<f32>, colour: vec3<f32>) -> vec3<f32> {
    let facing = max(dot(shaded.normal, light), 0.0);
    let half_way = normalize(light + towards);
    let alpha = max(shaded.roughness * shaded.roughness, 0.01);
    let power = 2.0 / (alpha * alpha);
    let highlight = 0.04 * (power + 8.0) / 8.0 * pow(max(dot(shaded.normal, half_way), 0.0), power);
    return (shaded.base_color + vec3(highlight)) * facing * colour;
}

@fragment
fn fragment(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    // Before any branch: slopes need all four pixels.
    let away = in.barycentric / max(fwidth(in.barycentric), vec3(1e-6));
    let near = min(away.x, min(away.y, away.z));
    let line = select(0.0, 1.0 - smoothstep(0.35, 1.1, near), (geometry_draw.flags & LINES) != 0u);
    let facing = normalize(select(-in.normal, in.normal, front));
    let shaded = material(Surface(in.position, facing, in.uv, in.row, dpdx(in.position), dpdy(in.position)));
    let towards = normalize(geometry_draw.camera - in.position);
    let sun = geometry_draw.numbers[0];
    let sky = mix(geometry_draw.numbers[2].xyz, geometry_draw.numbers[1].xyz, shaded.normal.y * 0.5 + 0.5);
    var colour = shaded.base_color * sky * shaded.occlusion + lit(shaded, towards, sun.xyz, vec3(1.0, 0.95, 0.87) * sun.w);
    colour += shaded.emissive * (0.35 + 0.65 * max(dot(shaded.normal, towards), 0.0));
    // The filmic curve of Narkowicz (2016), then the encoding of sRGB.
    colour = clamp(colour * (2.51 * colour + 0.03) / (colour * (2.43 * colour + 0.59) + 0.14), vec3(0.0), vec3(1.0));
    colour = select(1.055 * pow(max(colour, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055, 12.92 * colour, colour <= vec3(0.0031308));
    if (geometry_draw.flags & FILL) == 0u {
        if line < 0.35 {
            discard;
        }
        return vec4(geometry_draw.numbers[3].xyz, 1.0);
    }
    return vec4(mix(colour, geometry_draw.numbers[3].xyz, line * geometry_draw.numbers[3].w), 1.0);
}
