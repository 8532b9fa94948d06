// Terrain into the G-buffer, its shadow maps, and its lines.

#import dolomite::tessellation::draw_types::{DrawParams, FILL, LINES}

@group(0) @binding(0) var<uniform> draw: DrawParams;
@group(0) @binding(1) var<storage, read> vertices: array<vec4<f32>>;
#ifdef LINE_MODE
@group(0) @binding(2) var<storage, read> indices: array<u32>;
#endif

struct Varying {
    @builtin(position) clip: vec4<f32>,
    // Relative to the anchor, metres, on the drawn surface (the sea where the bed is below it).
    @location(0) position: vec3<f32>,
    // Height of the ground, which is the sea bed below the sea.
    @location(1) ground: f32,
    // dh/dx, dh/dz of the ground.
    @location(2) gradient: vec2<f32>,
#ifdef MOTION_VECTORS
    @location(3) clip_now: vec4<f32>,
    @location(4) clip_before: vec4<f32>,
#endif
#ifdef LINE_MODE
    @location(5) barycentric: vec3<f32>,
#endif
}

@vertex
fn vertex(@builtin(vertex_index) number: u32) -> Varying {
#ifdef LINE_MODE
    let v = vertices[indices[number]];
#else
    let v = vertices[number];
#endif
    var out: Varying;
    out.position = vec3(v.x, max(v.y, draw.sea_level), v.z);
    out.ground = v.y;
    out.gradient = unpack2x16float(bitcast<u32>(v.w));
    out.clip = draw.clip_from_anchor * vec4(out.position, 1.0);
#ifdef MOTION_VECTORS
    out.clip_now = out.clip;
    out.clip_before = draw.previous_clip_from_anchor * vec4(out.position, 1.0);
#endif
#ifdef LINE_MODE
    let corner = number % 3u;
    out.barycentric = vec3(f32(corner == 0u), f32(corner == 1u), f32(corner == 2u));
#endif
    return out;
}

#ifdef GBUFFER
#import bevy_pbr::utils::octahedral_encode
#import bevy_pbr::pbr_deferred_types::{pack_unorm4x8_, pack_24bit_normal_and_flags, DEFERRED_FLAGS_FOG_ENABLED_BIT, DEFERRED_MESH_FLAGS_SHADOW_RECEIVER_BIT}
#import dolomite::tessellation::material::{Shaded, shade}

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

@fragment
fn fragment(in: Varying) -> GBuffer {
    // Derivatives before any branch: WGSL wants them in uniform control flow.
    let dx = dpdx(in.position);
    let dy = dpdy(in.position);
    var line = 0.0;
#ifdef LINE_MODE
    // Distance to the nearest edge in pixels, from the barycentric coordinates' own slope.
    let distance = in.barycentric / max(fwidth(in.barycentric), vec3(1e-6));
    line = 1.0 - smoothstep(0.6, 1.4, min(distance.x, min(distance.y, distance.z)));
    if (draw.flags & FILL) == 0u && line < 0.5 {
        discard;
    }
#endif
    var surface = shade(draw, in.position, in.ground, in.gradient, dx, dy);
#ifdef LINE_MODE
    if (draw.flags & FILL) == 0u {
        surface.albedo = vec3(0.75, 0.85, 0.6);
        surface.roughness = 1.0;
    } else {
        surface.albedo = mix(surface.albedo, vec3(0.01, 0.012, 0.015), line * 0.85);
    }
#endif
    var out: GBuffer;
    out.deferred = vec4(
        // The G-buffer holds base colour with a gamma of 2.2.
        pack_unorm4x8_(vec4(pow(surface.albedo, vec3(1.0 / 2.2)), surface.roughness)),
        0u,
        pack_unorm4x8_(vec4(surface.reflectance, 0.0, surface.occlusion, 0.0)),
        pack_24bit_normal_and_flags(
            octahedral_encode(surface.normal),
            DEFERRED_FLAGS_FOG_ENABLED_BIT | DEFERRED_MESH_FLAGS_SHADOW_RECEIVER_BIT,
        ),
    );
    out.lighting_pass = 1u;
#ifdef NORMAL_PREPASS
    out.normal = vec4(surface.normal * 0.5 + 0.5, 1.0);
#endif
#ifdef MOTION_VECTORS
    let now = in.clip_now.xy / in.clip_now.w;
    let before = in.clip_before.xy / in.clip_before.w;
    // Half of the NDC difference, y down, as Bevy's prepass has it.
    out.motion = (now - before) * vec2(0.5, -0.5);
#endif
    return out;
}
#endif
