// Blades of grass into the G-buffer and into shadow maps: an instance a record, a strip of triangles each.

#import dolomite::vegetation::blade::{row_at, tangent_at, widened_edge, width_at}
#import dolomite::vegetation::colour::{blade_tint, calm_at, far_place}
#import dolomite::vegetation::draw_view::{records, view}
#import dolomite::vegetation::law::{evened, kept_share, settled_share, widened}
#import dolomite::vegetation::noise::smooth_noise
#import dolomite::vegetation::shape::shape_of
#import dolomite::vegetation::stem::stem_curve
#import dolomite::vegetation::straight::{straight_bow, straight_wider}
#import dolomite::vegetation::types::unpack_record
#ifdef RANK
#import dolomite::vegetation::rank::rank_of
#endif
#ifdef SHADOW
#import dolomite::vegetation::surface::Varying
#else
#import dolomite::vegetation::surface::{GBuffer, Varying, stored}
#endif

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

@vertex
fn vertex(@builtin(vertex_index) number: u32, @builtin(instance_index) instance: u32) -> Varying {
    let record = unpack_record(records[instance]);
    let look = view.looks[record.layer];
    const SEGMENTS = VERTICES >> 1u;
    let row = number >> 1u;
    let t = f32(row) / f32(SEGMENTS);
    let side = select(select(-1.0, 1.0, (number & 1u) == 1u), 0.0, number == VERTICES - 1u);
    let shape = shape_of(look, record.hash, record.clump, record.normal);
    let curve = stem_curve(shape, record, view.wind);
    let away = view.camera - record.position;
    let distance = max(length(away), 1e-3);
    let seen = away / distance;
    let along = normalize(tangent_at(curve, t));
    let across = vec3(shape.across.x, 0.0, shape.across.y);
    let even = evened(look.sway.z, kept_share(look.reach, distance));
    var width = shape.width * widened(look.reach, distance, record.entered) * even * width_at(t, SEGMENTS);
#ifdef SHADOW
    width *= WIDER;
    let place = record.position + row_at(curve, row, SEGMENTS) + across * (0.5 * width * side);
    var out: Varying;
    out.clip = shadow.clip * vec4(place, 1.0);
    // What stands between the light and its near plane casts a shadow too: parallel light has w = 1.
    out.clip.z = select(out.clip.z, min(out.clip.z, 1.0), out.clip.w == 1.0);
    if (record.hash & (OF - 1u)) != 0u {
        out.clip = vec4(2.0, 2.0, 0.5, 1.0);
    }
    return out;
#else
    let sine = clamp(dot(seen, record.normal), 0.00390625, 1.0);
    var bow = 0.0;
    if SEGMENTS == 1u {
        width *= straight_wider(shape.droop, sine);
        bow = straight_bow(shape.droop, sine, look.sway.w);
    }
    var off = across * (0.5 * width * side);
    // Seen from its edge a blade is still a third as wide.
    off += widened_edge(off, along, seen, 0.17 * width);
    let place = record.position + row_at(curve, row, SEGMENTS) + off;
    var out: Varying;
    out.clip = view.clip * vec4(place, 1.0);
#ifdef MOTION_VECTORS
    let before = stem_curve(shape, record, view.previous_wind);
    out.clip_now = out.clip;
    out.clip_before = view.previous_clip * vec4(record.position + row_at(before, row, SEGMENTS) + off, 1.0);
#endif
    var normal = normalize(cross(along, across));
    normal = select(-normal, normal, dot(normal, seen) >= 0.0);
    let calm = calm_at(look.reach.x, distance);
    out.normal = normalize(mix(normal, record.normal, 0.45 + 0.45 * calm));
    out.place = vec3(t, side, bow);
    let noise = vec2(
        smooth_noise(view.anchor, record.position.xz, 2u),
        smooth_noise(view.anchor, record.position.xz, 4u),
    );
    let tint = blade_tint(look, record.hash, record.clump, noise, calm);
    out.tint = vec3(tint, calm);
    // Where blades end they have the colour of the ground that shows them; as light or dark as they are here.
    let at = far_place(sine);
    let entry = min(u32(at), 15u);
    let far = mix(view.far[record.layer].entries[entry], view.far[record.layer].entries[entry + 1u], at - f32(entry));
    out.given = vec4(far.yzw, select(0.0, settled_share(look.reach, distance), far.x > 0.0));
    out.across = vec4(across, look.size.w);
    out.layer = record.layer;
#ifdef RANK
    out.rank = rank_of(record);
#endif
    return out;
#endif
}

#ifndef SHADOW
#ifdef RANK
@fragment
fn fragment(in: Varying) -> @location(0) vec2<f32> {
    return in.rank;
}
#else
@fragment
fn fragment(in: Varying) -> GBuffer {
    return stored(in, view.looks[in.layer], view.sun);
}
#endif
#endif
