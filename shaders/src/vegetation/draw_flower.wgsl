// Flowers into the G-buffer: an instance a record, a list of triangles each, first the stem and then the head.

#import dolomite::vegetation::blade::{place_at, tangent_at, widened_edge, width_at}
#import dolomite::vegetation::blossom::{HeadPoint, head_frame}
#ifdef FLOWER_FAR
#import dolomite::vegetation::blossom::head_far
#else
#import dolomite::vegetation::blossom::head_near
#endif
#import dolomite::vegetation::colour::{blade_tint, calm_at}
#import dolomite::vegetation::draw_view::{records, view}
#import dolomite::vegetation::law::widened
#import dolomite::vegetation::noise::smooth_noise
#import dolomite::vegetation::shape::{own, shape_of}
#import dolomite::vegetation::stem::stem_curve
#import dolomite::vegetation::surface::{GBuffer, Varying, stored}
#import dolomite::vegetation::types::unpack_record
#ifdef RANK
#import dolomite::vegetation::rank::rank_of
#endif

// Segments of a stem: two triangles each, but one for the last.
#ifdef FLOWER_FAR
const SEGMENTS: u32 = 1u;
#else
const SEGMENTS: u32 = 3u;
#endif

@vertex
fn vertex(@builtin(vertex_index) number: u32, @builtin(instance_index) instance: u32) -> Varying {
    let record = unpack_record(records[instance]);
    let look = view.looks[record.layer];
    const STEM = 3u * (2u * SEGMENTS - 1u);
    let shape = shape_of(look, record.hash, record.clump, record.normal);
    let curve = stem_curve(shape, record, view.wind);
    let away = view.camera - record.position;
    let distance = max(length(away), 1e-3);
    let seen = away / distance;
    let across = vec3(shape.across.x, 0.0, shape.across.y);
    let calm = calm_at(look.reach.x, distance);
    let wider = widened(look.reach, distance, record.entered);
    let noise = vec2(
        smooth_noise(view.anchor, record.position.xz, 2u),
        smooth_noise(view.anchor, record.position.xz, 4u),
    );
    let is_stem = number < STEM;
    // Of a strip's triangles: k, k + 1, k + 2.
    let corner = number / 3u + number % 3u;
    let t = select(1.0, f32(corner >> 1u) / f32(SEGMENTS), is_stem);
    let tangent = tangent_at(curve, t);
    var off: vec3<f32>;
    var normal: vec3<f32>;
    var out: Varying;
    if is_stem {
        let side = select(select(-1.0, 1.0, (corner & 1u) == 1u), 0.0, corner == 2u * SEGMENTS);
        let along = normalize(tangent);
        // It ends in the head as wide as at its half.
        let width = shape.width * wider * width_at(0.7 * t, SEGMENTS);
        off = across * (0.5 * width * side);
        off += widened_edge(off, along, seen, 0.3 * width);
        normal = normalize(cross(along, across));
        normal = select(-normal, normal, dot(normal, seen) >= 0.0);
        normal = mix(normal, record.normal, 0.45 + 0.45 * calm);
        out.place = vec3(t, side, 0.0);
        out.given = vec4(0.0);
    } else {
        let petals = u32(look.middle.w);
#ifdef FLOWER_FAR
        let point = head_far(number - STEM, petals);
#else
        let point = head_near(number - STEM, petals);
#endif
        let frame = head_frame(tangent, shape.across);
        // Its area is what makes up for those that are not drawn.
        let radius = look.head.w * (0.8 + 0.4 * own(record.hash, 13u)) * sqrt(wider);
        let turn = 6.2831853 * own(record.hash, 14u);
        let turned = vec2(
            cos(turn) * point.at.x - sin(turn) * point.at.y,
            sin(turn) * point.at.x + cos(turn) * point.at.y,
        );
        let outward = frame.right * turned.x + frame.ahead * turned.y;
        off = radius * (outward + frame.axis * point.rise);
        normal = frame.axis;
        normal = select(-normal, normal, dot(normal, seen) >= 0.0) + 0.35 * point.petal * (1.0 - calm) * outward;
        normal = mix(normal, record.normal, 0.6 * calm);
        out.place = vec3(1.0, 0.0, 0.0);
        // Darker towards the middle, so that petals are told apart.
        let petal = look.head.xyz * mix(0.8, 1.05, clamp(length(point.at), 0.0, 1.0));
        let head = mix(look.middle.xyz, petal, point.petal) * mix(0.9 + 0.2 * own(record.hash, 12u), 1.0, calm);
        out.given = vec4(head, 1.0);
    }
    let place = record.position + place_at(curve, t) + off;
    out.clip = view.clip * vec4(place, 1.0);
#ifdef MOTION_VECTORS
    let before = stem_curve(shape, record, view.previous_wind);
    out.clip_now = out.clip;
    out.clip_before = view.previous_clip * vec4(record.position + place_at(before, t) + off, 1.0);
#endif
    out.normal = normalize(normal);
    out.tint = vec3(blade_tint(look, record.hash, record.clump, noise, calm), calm);
    out.across = vec4(across, look.size.w);
    out.layer = record.layer;
#ifdef RANK
    out.rank = rank_of(record);
#endif
    return out;
}

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
