// Gradients at the vertices that are new in the blocks that are made. A thread a vertex, a row of workgroups a block.

#import dolomite::detail::bindings::{counts, detail}
#import dolomite::blocks::bindings::{SLOPES, heads, lists, made_list, record_at, records}
#import dolomite::blocks::border::border_point
#import dolomite::blocks::others::copiers
#import dolomite::blocks::record::{GRADIENTS, NO_BLOCK, OWN, VERTICES, number_at, own_vertex, pack_gradient, vertex_at}
#import dolomite::terrain::height::terrain_height
#ifdef TERRAIN_TILED
#import dolomite::terrain::clip::{clip_near, ON_SAMPLES}
#endif

@compute @workgroup_size(64)
fn slope_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let k = group.x * 64u + thread;
    let slot = lists[made_list() + group.y];
    let centre = heads[slot].centre;
    let half = heads[slot].half;
    // All vertices of a root are new.
    let is_root = heads[slot].parent == NO_BLOCK;
    if k >= select(OWN, VERTICES, is_root) {
        return;
    }
    let place = select(own_vertex(k), vertex_at(k), is_root);
#ifdef TERRAIN_TILED
    clip_near = ON_SAMPLES;
#endif
    let gradient = terrain_height(border_point(centre - vec2(half) + place * (half / 16u))).yz;
    let at = record_at(slot) + GRADIENTS + number_at(place);
    let packed = pack_gradient(gradient);
    if records[at] != packed {
        atomicOr(&counts[SLOPES + group.y], copiers(place));
    }
    records[at] = packed;
}
