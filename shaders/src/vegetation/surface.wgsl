#define_import_path dolomite::vegetation::surface

// What the draws of all shapes give the rasteriser, and what is stored of it in the G-buffer.

#import bevy_pbr::utils::octahedral_encode
#import bevy_pbr::pbr_deferred_types::{pack_unorm4x8_, pack_24bit_normal_and_flags, DEFERRED_FLAGS_FOG_ENABLED_BIT, DEFERRED_MESH_FLAGS_SHADOW_RECEIVER_BIT}
#import dolomite::vegetation::colour::{blade_colour, lit_through, shade_at}
#import dolomite::vegetation::draw_types::Look
#import dolomite::vegetation::straight::straight_along

struct Varying {
    @builtin(position) clip: vec4<f32>,
#ifndef SHADOW
    @location(0) normal: vec3<f32>,
    // From the root to the tip, 0 to 1; across, -1 to 1; the bow of a strip of one segment.
    @location(1) place: vec3<f32>,
    // A colour that is not the blade's own; w: its share.
    @location(2) given: vec4<f32>,
    // Across the blade; w: how much of the light comes through.
    @location(3) across: vec4<f32>,
    // What differs from blade to blade, and how calm the shading is, for what is far.
    @location(4) tint: vec3<f32>,
    // Which kind it is.
    @location(7) @interpolate(flat) layer: u32,
#endif
#ifdef RANK
    // As `rank_of` has it.
    @location(8) @interpolate(flat) rank: vec2<f32>,
#endif
#ifdef MOTION_VECTORS
    @location(5) clip_now: vec4<f32>,
    @location(6) clip_before: vec4<f32>,
#endif
}

#ifndef SHADOW
struct GBuffer {
#ifdef NORMAL_PREPASS
    @location(0) normal: vec4<f32>,
#endif
#ifdef MOTION_VECTORS
    @location(1) motion: vec2<f32>,
#endif
    @location(2) deferred: vec4<u32>,
    @location(3) lighting_pass: u32,
}

fn stored(in: Varying, look: Look, sun: vec3<f32>) -> GBuffer {
    let calm = in.tint.z;
    let t = straight_along(in.place.x, in.place.z);
    // A blade is folded along its middle: its halves look to different sides.
    var normal = normalize(in.normal + in.across.xyz * (0.55 * (1.0 - calm) * in.place.y));
    var colour = mix(blade_colour(look, in.tint.xy, t) * shade_at(t), in.given.xyz, in.given.w);
    // Lit from behind: what comes through is yellower. The share is that of the sun's light and not of the colour, which the
    // sky lights from all around, in the shade too.
    let behind = smoothstep(0.0, 0.3, -dot(normal, sun));
    normal = lit_through(normal, sun, in.across.w * mix(0.6, 1.0, t));
    colour *= mix(vec3(1.0), vec3(1.25, 1.15, 0.55), behind);
    var out: GBuffer;
    out.deferred = vec4(
        pack_unorm4x8_(vec4(pow(max(colour, vec3(0.0)), vec3(1.0 / 2.2)), mix(0.72, 0.95, calm))),
        0u,
        pack_unorm4x8_(vec4(mix(0.2, 0.08, calm), 0.0, mix(mix(0.35, 1.0, t), 0.8, calm), 0.0)),
        pack_24bit_normal_and_flags(
            octahedral_encode(normal),
            DEFERRED_MESH_FLAGS_SHADOW_RECEIVER_BIT | DEFERRED_FLAGS_FOG_ENABLED_BIT,
        ),
    );
    // Bevy's default deferred lighting pass.
    out.lighting_pass = 1u;
#ifdef NORMAL_PREPASS
    out.normal = vec4(normal * 0.5 + 0.5, 1.0);
#endif
#ifdef MOTION_VECTORS
    let now = in.clip_now.xy / in.clip_now.w;
    let before = in.clip_before.xy / in.clip_before.w;
    out.motion = (now - before) * vec2(0.5, -0.5);
#endif
    return out;
}
#endif
