// Vertices and triangles of the blocks that are shown: a workgroup a block. What the camera sees goes to the front of the
// list, what shadows need of the others to its back.

#import dolomite::blocks::bindings::{OTHERS, TRIANGLES, VERTICES as VERTEX_COUNT, heads, lists, records, shown_list}
#import dolomite::blocks::leaves::{find_children, list, list_cell, list_small_cell, listed, share}
#import dolomite::blocks::ratio::place_in
#import dolomite::blocks::record::{GRADIENTS, HEIGHTS, VERTICES, number_at, quarter_at, unpack_gradient, vertex_at}
#import dolomite::blocks::way::{Block, block_at, coarsening_now, way_of}
#import dolomite::detail::bindings::{counts, detail}
#import dolomite::detail::cull::{CULL, KEEP_OTHERS, draw_at, is_hidden}
#import dolomite::detail::horizon::{OCCLUDED, is_behind, map_place}
#import dolomite::geometry::vertex::{VERTEX_WORDS, pack_normal}

@group(1) @binding(0) var<storage, read_write> vertices: array<u32>;
@group(1) @binding(1) var<storage, read_write> indices: array<u32>;

const GROUP: u32 = 64u;
// Two bits above three numbers of ten bits: what a triangle is.
const SEEN: u32 = 0u;
const OTHER: u32 = 1u << 30u;
const DROPPED: u32 = 2u << 30u;

// Height of the drawn surface at each vertex above the anchor.
var<workgroup> heights: array<f32, 545>;
// 1 where a triangle needs the vertex; then its number.
var<workgroup> needed: array<atomic<u32>, 545>;
// The vertices that are needed.
var<workgroup> order: array<u32, 545>;
var<workgroup> vertex_count: atomic<u32>;
// Of triangles that are seen, and others.
var<workgroup> seen_count: atomic<u32>;
var<workgroup> other_count: atomic<u32>;
var<workgroup> first_vertex: u32;
var<workgroup> first_seen: u32;
var<workgroup> first_other: u32;

// The ends of the edge that a vertex cuts, in half cells. Not of corners of the block.
fn ends_of(at: vec2<u32>, quarter: u32) -> array<vec2<u32>, 2> {
    let tx = countTrailingZeros(at.x | 32u);
    let tz = countTrailingZeros(at.y | 32u);
    let least = min(tx, tz);
    let half = 1u << least;
    let above = select(quarter_at(at >> vec2(least + 1u)), quarter, half == 16u);
    // As unsigned numbers that wrap.
    let across = select(0u - half, half, (above & 1u) == 0u);
    let step = select(select(vec2(0u, half), vec2(half, 0u), tx < tz), vec2(half, across), tx == tz);
    return array(at - step, at + step);
}

// Height of the bed and gradient as they are drawn.
fn drawn_ground(block: Block, number: u32, way: f32) -> vec4<f32> {
    let own = ground_at(block, number);
    if way >= 1.0 {
        return own;
    }
    let ends = ends_of(vertex_at(number), block.quarter);
    let before = 0.5 * (ground_at(block, number_at(ends[0])) + ground_at(block, number_at(ends[1])));
    return mix(before, own, way);
}

// Height of the drawn surface, of the bed, and gradient.
fn ground_at(block: Block, number: u32) -> vec4<f32> {
    let bed = bitcast<f32>(records[block.record + HEIGHTS + number]);
    return vec4(max(bed, detail.sea), bed, unpack_gradient(records[block.record + GRADIENTS + number]));
}

fn place_of(block: Block, number: u32) -> vec3<f32> {
    let place = place_in(block.frame, vertex_at(number));
    return vec3(place.x, heights[number], place.y);
}

fn kind_of(block: Block, a: u32, b: u32, c: u32) -> u32 {
    if (detail.flags & CULL) == 0u {
        return SEEN;
    }
    let pa = place_of(block, a);
    let pb = place_of(block, b);
    let pc = place_of(block, c);
    var hidden = is_hidden(draw_at(pa), draw_at(pb), draw_at(pc));
    if (detail.flags & OCCLUDED) != 0u {
        hidden = hidden || is_behind(map_place(pa), map_place(pb), map_place(pc));
    }
    return select(SEEN, select(DROPPED, OTHER, (detail.flags & KEEP_OTHERS) != 0u), hidden);
}

fn put_vertex(block: Block, place: u32, number: u32) {
    if place >= detail.max_vertices {
        return;
    }
    let ground = drawn_ground(block, number, share[number]);
    let at = place_in(block.frame, vertex_at(number));
    let depth = clamp(detail.sea - ground.y, -detail.depth_range, detail.depth_range);
    let base = place * VERTEX_WORDS;
    vertices[base] = bitcast<u32>(at.x);
    vertices[base + 1u] = bitcast<u32>(heights[number]);
    vertices[base + 2u] = bitcast<u32>(at.y);
    vertices[base + 3u] = pack_normal(normalize(vec3(-ground.z, 1.0, -ground.w)), 0u);
    vertices[base + 4u] = pack2x16snorm(vec2(depth / detail.depth_range, 0.0));
}

fn put_triangle(place: u32, word: u32) {
    if place < detail.max_triangles {
        indices[3u * place] = first_vertex + atomicLoad(&needed[word & 1023u]);
        indices[3u * place + 1u] = first_vertex + atomicLoad(&needed[(word >> 10u) & 1023u]);
        indices[3u * place + 2u] = first_vertex + atomicLoad(&needed[(word >> 20u) & 1023u]);
    }
}

@compute @workgroup_size(64)
fn emit_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let slot = lists[shown_list() + group.x];
    let block = block_at(slot);
    let coarsening = coarsening_now();
    for (var k = thread; k < VERTICES; k += GROUP) {
        let way = way_of(block, k, coarsening);
        share[k] = way;
        if way > 0.0 {
            heights[k] = drawn_ground(block, k, way).x - detail.anchor_height;
        }
    }
    let children = find_children(heads[slot].children, coarsening);
    workgroupBarrier();
    for (var k = thread; k < 256u; k += GROUP) {
        list_small_cell(k, children);
    }
    for (var k = thread; k < 85u; k += GROUP) {
        list_cell(k, children, block.quarter);
    }
    workgroupBarrier();
    let triangles = atomicLoad(&listed);
    for (var k = thread; k < triangles; k += GROUP) {
        let word = list[k];
        let corners = vec3(word & 1023u, (word >> 10u) & 1023u, (word >> 20u) & 1023u);
        let kind = kind_of(block, corners.x, corners.y, corners.z);
        list[k] = word | kind;
        if kind != DROPPED {
            atomicStore(&needed[corners.x], 1u);
            atomicStore(&needed[corners.y], 1u);
            atomicStore(&needed[corners.z], 1u);
            if kind == SEEN {
                atomicAdd(&seen_count, 1u);
            } else {
                atomicAdd(&other_count, 1u);
            }
        }
    }
    workgroupBarrier();
    for (var k = thread; k < VERTICES; k += GROUP) {
        if atomicLoad(&needed[k]) == 1u {
            let number = atomicAdd(&vertex_count, 1u);
            atomicStore(&needed[k], number);
            order[number] = k;
        }
    }
    workgroupBarrier();
    let used = atomicLoad(&vertex_count);
    if thread == 0u {
        first_vertex = atomicAdd(&counts[VERTEX_COUNT], used);
        first_seen = atomicAdd(&counts[TRIANGLES], atomicLoad(&seen_count));
        // From the back; what is before the first wraps, and is not stored.
        first_other = detail.max_triangles - 1u - atomicAdd(&counts[OTHERS], atomicLoad(&other_count));
        atomicStore(&seen_count, 0u);
        atomicStore(&other_count, 0u);
    }
    workgroupBarrier();
    for (var k = thread; k < used; k += GROUP) {
        put_vertex(block, first_vertex + k, order[k]);
    }
    for (var k = thread; k < triangles; k += GROUP) {
        let word = list[k];
        let kind = word & (3u << 30u);
        if kind == SEEN {
            put_triangle(first_seen + atomicAdd(&seen_count, 1u), word);
        } else if kind == OTHER {
            put_triangle(first_other - atomicAdd(&other_count, 1u), word);
        }
    }
}
