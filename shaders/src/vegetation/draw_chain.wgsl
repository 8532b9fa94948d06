// Kelp into the G-buffer: an instance a record, a ribbon each, which goes with the water.

#import dolomite::vegetation::chain::{chain_of, node_at_rest, node_moved, ribbon_across, ribbon_width}
#import dolomite::vegetation::colour::{blade_tint, calm_at}
#import dolomite::vegetation::draw_view::{records, view}
#import dolomite::vegetation::law::widened
#import dolomite::vegetation::noise::smooth_noise
#import dolomite::vegetation::surface::{GBuffer, Varying, stored}
#import dolomite::vegetation::types::unpack_record
#import dolomite::vegetation::wind::water_moved
#ifdef RANK
#import dolomite::vegetation::rank::rank_of
#endif

// Nodes from one row of vertices to the next.
#ifdef CHAIN_BY_4
const STEP: u32 = 4u;
#else
#ifdef CHAIN_BY_2
const STEP: u32 = 2u;
#else
const STEP: u32 = 1u;
#endif
#endif

@vertex
fn vertex(@builtin(vertex_index) number: u32, @builtin(instance_index) instance: u32) -> Varying {
    let record = unpack_record(records[instance]);
    let look = view.looks[record.layer];
    let chain = chain_of(look, record.hash, view.water - record.position.y, view.wind.mean);
    // Rows beyond the last node are that node.
    let row = min((number >> 1u) * STEP, chain.segments);
    let side = select(-1.0, 1.0, (number & 1u) == 1u);
    let rest = node_at_rest(chain, row);
    let at = record.position.xz + rest.place.xz;
    let below = chain.depth - rest.place.y;
    let node = node_moved(chain, row, rest, water_moved(view.wind, at, below));
    let away = view.camera - record.position;
    let distance = max(length(away), 1e-3);
    let across = ribbon_across(chain, row, rest);
    let width = ribbon_width(chain, row, rest.floats, STEP) * widened(look.reach, distance, record.entered);
    let off = across * (0.5 * width * side);
    var out: Varying;
    out.clip = view.clip * vec4(record.position + node + off, 1.0);
#ifdef MOTION_VECTORS
    let before = node_moved(chain, row, rest, water_moved(view.previous_wind, at, below));
    out.clip_now = out.clip;
    out.clip_before = view.previous_clip * vec4(record.position + before + off, 1.0);
#endif
    let normal = normalize(cross(rest.along, across));
    let calm = calm_at(look.reach.x, distance);
    out.normal = normalize(mix(select(-normal, normal, dot(normal, away) >= 0.0), vec3(0.0, 1.0, 0.0), 0.3));
    let t = f32(row) / f32(chain.segments);
    out.place = vec3(t, side, 0.0);
    let noise = vec2(
        smooth_noise(view.anchor, record.position.xz, 2u),
        smooth_noise(view.anchor, record.position.xz, 4u),
    );
    out.tint = vec3(blade_tint(look, record.hash, record.clump, noise, calm), calm);
    out.given = vec4(0.0);
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
