// What producers made into the G-buffer, into shadow maps and into plain pictures.

#import dolomite::geometry::draw_types::{Shaded, Surface, geometry_draw, FILL}
#import dolomite::geometry::vertex::{VERTEX_WORDS, unpack_material, unpack_normal}

struct Varying {
    @builtin(position) clip: vec4<f32>,
#ifdef GEOMETRY_VERTEX_SHADED
    // As the picture holds it.
    @location(0) colour: vec3<f32>,
#else
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) @interpolate(flat) row: u32,
#endif
#ifdef MOTION_VECTORS
    @location(4) clip_now: vec4<f32>,
    @location(5) clip_before: vec4<f32>,
#endif
#ifdef GEOMETRY_LINES
    @location(6) barycentric: vec3<f32>,
#endif
}

#ifndef GEOMETRY_SHADOW
#ifndef GEOMETRY_SURFACE
#import dolomite::geometry::user_material::material

// A linear colour as a picture without G-buffer holds it: as it is, or encoded (IEC 61966-2-1).
fn pictured(colour: vec3<f32>) -> vec3<f32> {
#ifdef GEOMETRY_ENCODED
    let curve = 1.055 * pow(max(colour, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;
    return select(curve, 12.92 * colour, colour <= vec3(0.0031308));
#else
    return colour;
#endif
}
#endif
#endif

#ifdef GEOMETRY_ONCE
// What the draws of the producers left of the surfaces that are seen, shaded once a pixel; see once.wgsl.
#import dolomite::geometry::once::{Rows, clip_rows, is_of, place_at, footprint, unpack_surface_normal}

@group(3) @binding(0) var surfaces: texture_2d<u32>;

struct Covering {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec2<f32>,
}

// A triangle over the whole picture, at the far end: where nothing was drawn it is not.
@vertex
fn vertex(@builtin(vertex_index) number: u32) -> Covering {
    let at = vec2(f32(number & 1u), f32(number >> 1u)) * 4.0 - 1.0;
    return Covering(vec4(at, 0.0, 1.0), at);
}
#else
// Of the corner of a triangle.
fn corner_weights(number: u32) -> vec3<f32> {
    let corner = number % 3u;
    return vec3(f32(corner == 0u), f32(corner == 1u), f32(corner == 2u));
}

fn rasterised(position: vec3<f32>, normal: vec3<f32>, uv: vec2<f32>, before: vec3<f32>, row: u32) -> Varying {
    var out: Varying;
    out.clip = geometry_draw.clip_from_anchor * vec4(position, 1.0);
#ifdef GEOMETRY_SHADOW
    // What stands between the light and its near plane casts a shadow too: parallel light has w = 1.
    out.clip.z = select(out.clip.z, min(out.clip.z, 1.0), out.clip.w == 1.0);
#endif
#ifdef GEOMETRY_VERTEX_SHADED
    out.colour = pictured(material(Surface(position, normal, uv, row, vec3(0.0), vec3(0.0))).base_color);
#else
    out.position = position;
    out.normal = normal;
    out.uv = uv;
    out.row = row;
#endif
#ifdef MOTION_VECTORS
    out.clip_now = out.clip;
    out.clip_before = geometry_draw.previous_clip_from_anchor * vec4(before, 1.0);
#endif
    return out;
}

#ifdef GEOMETRY_EVALUATED
#import dolomite::geometry::user_vertex::evaluated_vertex

fn evaluated(id: u32, place: vec2<u32>) -> Varying {
    let v = evaluated_vertex(id, place);
    return rasterised(v.position, v.normal, v.uv, v.previous, v.material);
}
#endif

#ifdef GEOMETRY_FETCH
// Draws that fetch their vertices by themselves: amplified ones, and those of lines.
@group(2) @binding(2) var<storage, read> pool: array<u32>;
@group(2) @binding(3) var<storage, read> indices: array<u32>;

#ifdef GEOMETRY_EVALUATED
@vertex
fn vertex(@builtin(vertex_index) number: u32) -> Varying {
    let at = 3u * indices[number];
    var out = evaluated(pool[at], vec2(pool[at + 1u], pool[at + 2u]));
#ifdef GEOMETRY_LINES
    out.barycentric = corner_weights(number);
#endif
    return out;
}
#else
#import dolomite::geometry::amplify_types::StoredVertex

#ifdef GEOMETRY_MOVES
@group(2) @binding(4) var<storage, read> previous: array<f32>;
#endif

fn stored(index: u32) -> StoredVertex {
    let at = index * VERTEX_WORDS;
    let position = bitcast<vec3<f32>>(vec3(pool[at], pool[at + 1u], pool[at + 2u]));
    var before = position;
#ifdef GEOMETRY_MOVES
    before = vec3(previous[3u * index], previous[3u * index + 1u], previous[3u * index + 2u]);
#endif
    let uv = unpack2x16snorm(pool[at + 4u]) * geometry_draw.uv_range;
    return StoredVertex(position, unpack_normal(pool[at + 3u]), uv, before, unpack_material(pool[at + 3u]));
}

fn rasterised_vertex(v: StoredVertex, number: u32) -> Varying {
    var out = rasterised(v.position, v.normal, v.uv, v.previous, v.material);
#ifdef GEOMETRY_LINES
    out.barycentric = corner_weights(number);
#endif
    return out;
}

#ifdef GEOMETRY_AMPLIFY
#import dolomite::geometry::user_amplify::amplify

@vertex
fn vertex(@builtin(vertex_index) number: u32, @builtin(instance_index) primitive: u32) -> Varying {
#ifdef GEOMETRY_SEGMENTS
    let a = stored(indices[2u * primitive]);
    let b = stored(indices[2u * primitive + 1u]);
    let c = b;
#else
    let a = stored(indices[3u * primitive]);
    let b = stored(indices[3u * primitive + 1u]);
    let c = stored(indices[3u * primitive + 2u]);
#endif
    return rasterised_vertex(amplify(a, b, c, number), number);
}
#else
@vertex
fn vertex(@builtin(vertex_index) number: u32) -> Varying {
    return rasterised_vertex(stored(indices[number]), number);
}
#endif
#endif
#else
#ifdef GEOMETRY_EVALUATED
@vertex
fn vertex(@location(0) id: u32, @location(1) place: vec2<u32>) -> Varying {
    return evaluated(id, place);
}
#else
@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) packed: u32,
    @location(2) uv: vec2<f32>,
#ifdef GEOMETRY_MOVES
    @location(3) before: vec3<f32>,
#endif
) -> Varying {
#ifndef GEOMETRY_MOVES
    let before = position;
#endif
    return rasterised(position, unpack_normal(packed), uv * geometry_draw.uv_range, before, unpack_material(packed));
}
#endif
#endif

#ifndef GEOMETRY_SHADOW
#ifndef GEOMETRY_SURFACE
// The colour of a line, where those of the vertices are as the picture holds them.
fn drawn_over(colour: vec3<f32>) -> vec3<f32> {
#ifdef GEOMETRY_VERTEX_SHADED
    return pictured(colour);
#else
    return colour;
#endif
}

// What the material gives, with the triangle's edges over it.
fn shade(in: Varying, front: bool) -> Shaded {
#ifdef GEOMETRY_VERTEX_SHADED
    var shaded = Shaded(in.colour, vec3(0.0), vec3(0.0, 1.0, 0.0), 1.0, 0.0, 0.0, 1.0, true, false);
#else
    let normal = normalize(select(-in.normal, in.normal, front));
    var shaded = material(Surface(in.position, normal, in.uv, in.row, dpdx(in.position), dpdy(in.position)));
#endif
#ifdef GEOMETRY_LINES
    // Distance to the nearest edge in pixels, from the barycentric coordinates' own slope.
    let away = in.barycentric / max(fwidth(in.barycentric), vec3(1e-6));
    let line = 1.0 - smoothstep(0.6, 1.4, min(away.x, min(away.y, away.z)));
    if (geometry_draw.flags & FILL) == 0u {
        if line < 0.5 {
            discard;
        }
        shaded.base_color = drawn_over(vec3(0.75, 0.85, 0.6));
        shaded.roughness = 1.0;
    } else {
        shaded.base_color = mix(shaded.base_color, drawn_over(vec3(0.01, 0.012, 0.015)), line * 0.85);
    }
#endif
    return shaded;
}
#endif
#endif
#endif

#ifdef GEOMETRY_SURFACE
#import dolomite::geometry::once::pack_surface

// What of the surface is kept until it is shaded.
@fragment
fn fragment(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4<u32> {
    let normal = select(-in.normal, in.normal, front);
    return pack_surface(in.clip.z, normal, in.uv / geometry_draw.uv_range, in.row, geometry_draw.producer);
}
#endif

#ifdef GBUFFER
#import bevy_pbr::rgb9e5::vec3_to_rgb9e5_
#import bevy_pbr::utils::octahedral_encode
#import bevy_pbr::pbr_deferred_types::{pack_unorm4x8_, pack_24bit_normal_and_flags, DEFERRED_FLAGS_FOG_ENABLED_BIT, DEFERRED_FLAGS_UNLIT_BIT, DEFERRED_MESH_FLAGS_SHADOW_RECEIVER_BIT}

struct GBuffer {
#ifdef NORMAL_PREPASS
    @location(0) normal: vec4<f32>,
#endif
#ifdef MOTION_VECTORS
    @location(1) motion: vec2<f32>,
#endif
    @location(2) deferred: vec4<u32>,
    // Bevy's default deferred lighting pass.
    @location(3) lighting_pass: u32,
}

// `now` and `before`: clip space of this frame and the last.
fn gbuffer(shaded: Shaded, now: vec4<f32>, before: vec4<f32>) -> GBuffer {
    let unlit = select(0u, DEFERRED_FLAGS_UNLIT_BIT, shaded.unlit);
    let fog = select(0u, DEFERRED_FLAGS_FOG_ENABLED_BIT, shaded.fog);
    var out: GBuffer;
    out.deferred = vec4(
        // The G-buffer holds base colour with a gamma of 2.2, and the colour of what is not lit in
        // place of what shines.
        pack_unorm4x8_(vec4(pow(select(shaded.base_color, vec3(0.0), shaded.unlit), vec3(1.0 / 2.2)), shaded.roughness)),
        vec3_to_rgb9e5_(select(shaded.emissive, shaded.base_color, shaded.unlit)),
        pack_unorm4x8_(vec4(shaded.reflectance, shaded.metallic, shaded.occlusion, 0.0)),
        pack_24bit_normal_and_flags(
            octahedral_encode(shaded.normal),
            DEFERRED_MESH_FLAGS_SHADOW_RECEIVER_BIT | unlit | fog,
        ),
    );
    out.lighting_pass = 1u;
#ifdef NORMAL_PREPASS
    out.normal = vec4(shaded.normal * 0.5 + 0.5, 1.0);
#endif
#ifdef MOTION_VECTORS
    // Half of the NDC difference, y down, as Bevy's prepass has it.
    out.motion = (now.xy / now.w - before.xy / before.w) * vec2(0.5, -0.5);
#endif
    return out;
}

#ifdef GEOMETRY_ONCE
@fragment
fn fragment(in: Covering) -> GBuffer {
    let kept = textureLoad(surfaces, vec2<i32>(in.clip.xy), 0);
    if !is_of(kept, geometry_draw.producer) {
        discard;
    }
    let rows = clip_rows(geometry_draw.clip_from_anchor, in.at, bitcast<f32>(kept.x));
    let position = place_at(rows);
    let normal = unpack_surface_normal(kept.y);
    let across = footprint(rows, position, normal, geometry_draw.viewport);
    let uv = unpack2x16snorm(kept.z) * geometry_draw.uv_range;
    let shaded = material(Surface(position, normal, uv, kept.w & 0xffu, across.dx, across.dy));
    let place = vec4(position, 1.0);
    return gbuffer(shaded, geometry_draw.clip_from_anchor * place, geometry_draw.previous_clip_from_anchor * place);
}
#else
@fragment
fn fragment(in: Varying, @builtin(front_facing) front: bool) -> GBuffer {
    let shaded = shade(in, front);
#ifdef MOTION_VECTORS
    return gbuffer(shaded, in.clip_now, in.clip_before);
#else
    return gbuffer(shaded, vec4(1.0), vec4(1.0));
#endif
}
#endif
#endif

#ifdef DIRECT
// Into a picture without G-buffer: the base colour, without light.
@fragment
fn fragment(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
#ifdef GEOMETRY_VERTEX_SHADED
    return vec4(shade(in, front).base_color, 1.0);
#else
    return vec4(pictured(shade(in, front).base_color), 1.0);
#endif
}
#endif
