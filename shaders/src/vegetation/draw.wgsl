// Blades of grass into the G-buffer and into shadow maps: an instance a record, a strip of triangles each.

#import bevy_pbr::utils::octahedral_encode
#import bevy_pbr::pbr_deferred_types::{pack_unorm4x8_, pack_24bit_normal_and_flags, DEFERRED_FLAGS_FOG_ENABLED_BIT, DEFERRED_MESH_FLAGS_SHADOW_RECEIVER_BIT}
#import dolomite::terrain::hash::pcg
#import dolomite::vegetation::blade::{curve_of, place_at, pushed, tangent_at, widened_edge, width_at}
#import dolomite::vegetation::draw_types::BladeView
#import dolomite::vegetation::law::widened
#import dolomite::vegetation::noise::smooth_noise
#import dolomite::vegetation::press::pressed_by
#import dolomite::vegetation::types::{Record, unpack_record}
#import dolomite::vegetation::wind::{WindField, wind_on_blade}

@group(0) @binding(0) var<uniform> view: BladeView;
@group(0) @binding(1) var<storage, read> records: array<vec4<u32>>;

#ifdef SHADOW
// From the anchor to the clip space of a light.
struct ShadowView {
    clip: mat4x4<f32>,
}

@group(1) @binding(0) var<uniform> shadow: ShadowView;

// One of so many blades casts a shadow, and is so much wider: less than a texel of the map is not drawn. Together half of
// the shadow: what is far has none, and the shade within a meadow is part of the colours already.
const OF: u32 = 4u;
const WIDER: f32 = 2.0;
#endif

#ifdef BLADE_OF_3
const VERTICES: u32 = 3u;
#else
#ifdef BLADE_OF_7
const VERTICES: u32 = 7u;
#else
const VERTICES: u32 = 15u;
#endif
#endif

struct Varying {
    @builtin(position) clip: vec4<f32>,
#ifndef SHADOW
    @location(0) normal: vec3<f32>,
    // From the root to the tip, 0 to 1; across, -1 to 1.
    @location(1) place: vec2<f32>,
    @location(2) colour: vec3<f32>,
    // Across the blade; w: how much of the light comes through.
    @location(3) across: vec4<f32>,
    // How calm the shading is, for what is far.
    @location(4) calm: f32,
#endif
#ifdef MOTION_VECTORS
    @location(5) clip_now: vec4<f32>,
    @location(6) clip_before: vec4<f32>,
#endif
}

// A random number of a hash, 0 up to 1.
fn own(hash: u32, salt: u32) -> f32 {
    return f32(pcg(hash * 747796405u + salt) >> 8u) * 5.9604644775390625e-8;
}

// A blade at rest.
struct Shape {
    long: f32,
    width: f32,
    lean: vec2<f32>,
    droop: f32,
    across: vec2<f32>,
}

// Blades of a clump are as long and turned alike, as far as the clump is uneven.
fn shape_of(record: Record) -> Shape {
    let look = view.looks[record.layer];
    let uneven = look.sway.y;
    let clump = own(record.clump, 4u);
    let size = mix(own(record.hash, 4u), clump, 0.5 * uneven);
    let spread = 1.0 - 0.6 * uneven;
    let angle = 6.2831853 * (own(record.clump, 5u) + (own(record.hash, 5u) - 0.5) * spread);
    let ahead = vec2(cos(angle), sin(angle));
    let lean = look.root.w * sqrt(own(record.hash, 6u));
    return Shape(
        // What comes in grows.
        mix(look.size.x, look.size.y, size) * (0.5 + 0.5 * record.entered),
        look.size.z * (0.75 + 0.5 * own(record.hash, 7u)),
        // Up the slope's normal a little.
        ahead * lean + 0.35 * record.normal.xz,
        look.tip.w * (0.6 + 0.4 * own(record.hash, 8u)),
        vec2(-ahead.y, ahead.x),
    );
}

// Where its tip is in some wind.
fn lean_of(shape: Shape, record: Record, field: WindField) -> vec2<f32> {
    let look = view.looks[record.layer];
    let air = wind_on_blade(field, record.position.xz, own(record.hash, 9u), (record.hash & 1u) == 1u);
    // Tall ones give way more.
    let give = look.sway.x * (0.6 + 0.4 * shape.long / max(look.size.y, 1e-3));
    var lean = pushed(shape.lean, air * give);
    for (var k = 0u; k < view.press_count; k++) {
        lean = pressed_by(view.presses[k], lean, record.position, shape.long);
    }
    return lean;
}

@vertex
fn vertex(@builtin(vertex_index) number: u32, @builtin(instance_index) instance: u32) -> Varying {
    let record = unpack_record(records[instance]);
    let look = view.looks[record.layer];
    const SEGMENTS = VERTICES >> 1u;
    let t = f32(number >> 1u) / f32(SEGMENTS);
    let side = select(select(-1.0, 1.0, (number & 1u) == 1u), 0.0, number == VERTICES - 1u);
    let shape = shape_of(record);
    let curve = curve_of(shape.long, shape.droop, lean_of(shape, record, view.wind));
    let away = view.camera - record.position;
    let distance = max(length(away), 1e-3);
    let seen = away / distance;
    let along = normalize(tangent_at(curve, t));
    let across = vec3(shape.across.x, 0.0, shape.across.y);
    var width = shape.width * widened(look.reach, distance, record.entered) * width_at(t, SEGMENTS);
#ifdef SHADOW
    width *= WIDER;
    let place = record.position + place_at(curve, t) + across * (0.5 * width * side);
    var out: Varying;
    out.clip = shadow.clip * vec4(place, 1.0);
    // What stands between the light and its near plane casts a shadow too: parallel light has w = 1.
    out.clip.z = select(out.clip.z, min(out.clip.z, 1.0), out.clip.w == 1.0);
    if (record.hash & (OF - 1u)) != 0u {
        out.clip = vec4(2.0, 2.0, 0.5, 1.0);
    }
    return out;
#else
    var off = across * (0.5 * width * side);
    // Seen from its edge a blade is still a third as wide.
    off += widened_edge(off, along, seen, 0.17 * width);
    let place = record.position + place_at(curve, t) + off;
    var out: Varying;
    out.clip = view.clip * vec4(place, 1.0);
#ifdef MOTION_VECTORS
    let before = curve_of(shape.long, shape.droop, lean_of(shape, record, view.previous_wind));
    out.clip_now = out.clip;
    out.clip_before = view.previous_clip * vec4(record.position + place_at(before, t) + off, 1.0);
#endif
    var normal = normalize(cross(along, across));
    normal = select(-normal, normal, dot(normal, seen) >= 0.0);
    // What is less than a pixel has the light of the meadow, not its own.
    let calm = smoothstep(0.0, 1.0, clamp(distance / (5.0 * look.reach.x), 0.0, 1.0));
    out.normal = normalize(mix(normal, record.normal, 0.45 + 0.45 * calm));
    out.place = vec2(t, side);
    // Colour: of some metres, of the clump, of the blade.
    let near = smooth_noise(view.anchor, record.position.xz, 2u);
    let wide = smooth_noise(view.anchor, record.position.xz, 4u);
    let clump = own(record.clump, 10u) - 0.5;
    let dryness = clamp(0.5 * near + 0.8 * wide - 0.35 + 0.4 * clump, 0.0, 1.0);
    let is_dry = select(0.0, 1.0, own(record.hash, 11u) < look.dry.w);
    let dry = clamp(1.4 * dryness * sqrt(look.dry.w) + 0.7 * is_dry * (1.0 - calm) + 0.7 * look.dry.w * calm, 0.0, 1.0);
    let value = mix(0.75 + 0.5 * own(record.hash, 12u), 1.0, 0.8 * calm) * (0.9 + 0.25 * near + 0.2 * clump);
    let green = mix(look.root.xyz, look.tip.xyz, t * (1.6 - 0.6 * t));
    out.colour = value * mix(green, look.dry.xyz, dry * smoothstep(0.05, 0.9, t));
    out.across = vec4(across, look.size.w);
    out.calm = calm;
    return out;
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

@fragment
fn fragment(in: Varying) -> GBuffer {
    let calm = in.calm;
    let t = in.place.x;
    // A blade is folded along its middle: its halves look to different sides.
    var normal = normalize(in.normal + in.across.xyz * (0.55 * (1.0 - calm) * in.place.y));
    // Light stands above: what is below is in the shade of the others.
    let shade = mix(mix(0.48, 1.0, smoothstep(0.0, 0.8, t)), 0.72, 0.8 * calm);
    var colour = in.colour * shade;
    let from_sun = dot(normal, view.sun);
    if from_sun < 0.0 {
        // Lit from behind: what comes through is yellower, and has the sun's direction on the other side. The share is
        // that of the light, not of the colour, so that it is seen as a blade with its normal turned.
        let through = in.across.w * mix(0.6, 1.0, t);
        normal = normal - 2.0 * from_sun * view.sun;
        colour *= through * vec3(1.25, 1.15, 0.55);
    }
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
