// Vertices and triangles of the blocks that are shown: a workgroup a block. What the camera sees goes to the front of the
// list, what shadows need of the others to its back.
//
// Only what is there is worked on: own vertices by the bits that look.wgsl left, cells and triangles by bits of the vertices. A
// load from workgroup memory or from a buffer is the dearest operation on software Vulkan, one for each lane.

#import dolomite::blocks::bindings::{OTHERS, TRIANGLES, VERTICES as VERTEX_COUNT, heads, lists, seen, shown_list}
#import dolomite::blocks::cells::{cell_count, clear_cells, list, list_cells, list_triangles, listed, note_there}
#import dolomite::blocks::looked::looked_vertex
#import dolomite::blocks::raised::{drawn_ground, drawn_height}
#import dolomite::blocks::ratio::place_in
#import dolomite::blocks::record::{CORNERS, CORNER_COUNT, number_at, vertex_at}
#import dolomite::blocks::way::{Block, block_at, coarsening_now, find_children, way_of}
#import dolomite::detail::bindings::{counts, detail}
#import dolomite::detail::cull::{CULL, KEEP_OTHERS, draw_at, is_hidden}
#import dolomite::detail::horizon::{OCCLUDED, is_behind, map_place}
#import dolomite::geometry::vertex::{VERTEX_WORDS, pack_normal}

@group(1) @binding(0) var<storage, read_write> vertices: array<u32>;
@group(1) @binding(1) var<storage, read_write> indices: array<u32>;

const GROUP: u32 = 32u;
// Corners that are older than a block.
const OLDER: u32 = 145u;
// Rows of corners and rows of centres.
const ROWS: u32 = 33u;
// Two bits above three numbers of ten bits: what a triangle is.
const SEEN: u32 = 0u;
const OTHER: u32 = 1u << 30u;
const DROPPED: u32 = 2u << 30u;

// The way of each vertex that is there to the ground, and the height of the drawn surface at it above the anchor.
var<workgroup> share: array<f32, 545>;
var<workgroup> heights: array<f32, 545>;
// Own vertices that appear where nothing is coarsened; later the vertices that are needed.
var<workgroup> order: array<u32, 545>;
// By rows: the vertices that triangles need.
var<workgroup> needed: array<atomic<u32>, 33>;
// Numbers of vertices that are needed.
var<workgroup> numbers: array<u32, 545>;
var<workgroup> own_count: atomic<u32>;
var<workgroup> vertex_count: atomic<u32>;
// Of triangles that are seen, and others.
var<workgroup> seen_count: atomic<u32>;
var<workgroup> other_count: atomic<u32>;
var<workgroup> first_vertex: u32;
var<workgroup> first_seen: u32;
var<workgroup> first_other: u32;

// Place of the k-th corner that is older than the block, in half cells.
fn older_corner(k: u32) -> vec2<u32> {
    let odd = k - 81u;
    return select(4u * vec2(odd & 7u, odd >> 3u) + vec2(2u), 4u * vec2(k % 9u, k / 9u), k < 81u);
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
    if (detail.flags & OCCLUDED) != 0u && !hidden {
        hidden = is_behind(map_place(pa), map_place(pb), map_place(pc));
    }
    return select(SEEN, select(DROPPED, OTHER, (detail.flags & KEEP_OTHERS) != 0u), hidden);
}

fn need(number: u32) {
    let centre = number - CORNER_COUNT;
    let row = select(17u + (centre >> 4u), number / CORNERS, number < CORNER_COUNT);
    let column = select(centre & 15u, number % CORNERS, number < CORNER_COUNT);
    atomicOr(&needed[row], 1u << column);
}

// Numbers the vertices of a row that are needed.
fn number_row(row: u32) {
    var bits = atomicLoad(&needed[row]);
    var number = atomicAdd(&vertex_count, countOneBits(bits));
    let first = select(CORNER_COUNT + (row - 17u) * 16u, row * CORNERS, row < 17u);
    while bits != 0u {
        let vertex = first + firstTrailingBit(bits);
        order[number] = vertex;
        numbers[vertex] = number;
        number++;
        bits &= bits - 1u;
    }
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
        indices[3u * place] = first_vertex + numbers[word & 1023u];
        indices[3u * place + 1u] = first_vertex + numbers[(word >> 10u) & 1023u];
        indices[3u * place + 2u] = first_vertex + numbers[(word >> 20u) & 1023u];
    }
}

@compute @workgroup_size(32)
fn emit_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let slot = lists[shown_list() + group.x];
    let block = block_at(slot);
    let coarsening = coarsening_now();
    clear_cells(thread);
    for (var k = thread; k < ROWS; k += GROUP) {
        atomicStore(&needed[k], 0u);
    }
    if thread == 0u {
        atomicStore(&own_count, 0u);
        atomicStore(&vertex_count, 0u);
        atomicStore(&seen_count, 0u);
        atomicStore(&other_count, 0u);
    }
    let children = find_children(heads[slot].children, coarsening);
    workgroupBarrier();
    var bits = seen[slot].there[thread];
    var at = atomicAdd(&own_count, countOneBits(bits));
    while bits != 0u {
        let place = looked_vertex(thread, firstTrailingBit(bits));
        order[at] = place.x | (place.y << 8u);
        at++;
        bits &= bits - 1u;
    }
    workgroupBarrier();
    let own = atomicLoad(&own_count);
    for (var k = thread; k < OLDER + own; k += GROUP) {
        var place = older_corner(k);
        if k >= OLDER {
            let word = order[k - OLDER];
            place = vec2(word & 255u, word >> 8u);
        }
        let number = number_at(place);
        let way = way_of(block, number, coarsening);
        if way > 0.0 {
            note_there(place);
            share[number] = way;
            heights[number] = drawn_height(block, number, way) - detail.anchor_height;
        }
    }
    workgroupBarrier();
    list_cells(thread, children);
    workgroupBarrier();
    let all_cells = atomicLoad(&cell_count);
    for (var k = thread; k < all_cells; k += GROUP) {
        list_triangles(k, block.quarter);
    }
    workgroupBarrier();
    let triangles = atomicLoad(&listed);
    var seen_here = 0u;
    var others_here = 0u;
    for (var k = thread; k < triangles; k += GROUP) {
        let word = list[k];
        let corners = vec3(word & 1023u, (word >> 10u) & 1023u, (word >> 20u) & 1023u);
        let kind = kind_of(block, corners.x, corners.y, corners.z);
        list[k] = word | kind;
        if kind != DROPPED {
            need(corners.x);
            need(corners.y);
            need(corners.z);
            seen_here += select(0u, 1u, kind == SEEN);
            others_here += select(0u, 1u, kind == OTHER);
        }
    }
    // Where this thread's triangles begin among those of the block.
    var next_seen = atomicAdd(&seen_count, seen_here);
    var next_other = atomicAdd(&other_count, others_here);
    workgroupBarrier();
    for (var row = thread; row < ROWS; row += GROUP) {
        number_row(row);
    }
    workgroupBarrier();
    let used = atomicLoad(&vertex_count);
    if thread == 0u {
        first_vertex = atomicAdd(&counts[VERTEX_COUNT], used);
        first_seen = atomicAdd(&counts[TRIANGLES], atomicLoad(&seen_count));
        // From the back; what is before the first wraps, and is not stored.
        first_other = detail.max_triangles - 1u - atomicAdd(&counts[OTHERS], atomicLoad(&other_count));
    }
    workgroupBarrier();
    for (var k = thread; k < used; k += GROUP) {
        put_vertex(block, first_vertex + k, order[k]);
    }
    next_seen += first_seen;
    next_other = first_other - next_other;
    for (var k = thread; k < triangles; k += GROUP) {
        let word = list[k];
        let kind = word & (3u << 30u);
        if kind == SEEN {
            put_triangle(next_seen, word);
            next_seen++;
        } else if kind == OTHER {
            put_triangle(next_other, word);
            next_other--;
        }
    }
}
