// Pass 5, a thread a vertex, then a thread a primitive: evaluates the vertices and joins them.

#import dolomite::stage::types::{Rules, Shape, INNER, CORNER, MIDDLE, ISOLINES, EQUAL}
#import dolomite::stage::api::{Patch, stage, tables, load_patch, stage_normal, stage_position, previous_stage_position, PATCH_WORDS}
#import dolomite::stage::coordinate::{as_numbers, corner_coordinate, inner_coordinate, side_coordinate}
#import dolomite::stage::counts::{placed_levels, placed_shape, work}
#import dolomite::stage::level::segments
#import dolomite::stage::place::{place, stage_edge}
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::shape::primitive
#import dolomite::stage::vertex::{VERTEX_WORDS, pack_normal}
#import dolomite::stage::work::{CHUNK, COLUMNS, EDGE_NUMBER, PRIMITIVES, REVERSED, SHARE, VERTICES, chunk_word, edge_word, item_count, lower, offset_word}
#import dolomite::stage::user::evaluate

@group(0) @binding(4) var<storage, read_write> vertices: array<u32>;
@group(0) @binding(5) var<storage, read_write> indices: array<u32>;
#ifdef STAGE_MOVES
@group(0) @binding(6) var<storage, read_write> previous: array<f32>;
#endif

// The last item of which at most `count` vertices (column 0) or primitives (column 1) come before.
fn find_item(first: u32, last: u32, column: u32, count: u32) -> u32 {
    var low = first;
    var high = last;
    while low < high {
        let middle = (low + high + 1u) / 2u;
        if work[offset_word(stage, middle) + column] <= count {
            low = middle;
        } else {
            high = middle - 1u;
        }
    }
    return low;
}

// The patch that owns a corner or an edge, and which of its own it is.
fn owner(word: u32) -> vec2<u32> {
    return vec2(word >> 2u, word & 3u);
}

fn emit_vertex(index: u32, item: u32) {
    let rules = stage_rules();
    let share = work[SHARE];
    let local = index - work[offset_word(stage, item)];
    var id = 0u;
    var at = vec3(0u);
    if item < stage.corners {
        let found = owner(tables[stage.corner_table + item]);
        id = found.x;
        at = corner_coordinate(rules.domain, found.y);
    } else if item < stage.corners + stage.edges {
        let edge = item - stage.corners;
        let found = owner(tables[stage.edge_table + edge]);
        id = found.x;
        let level = lower(rules, work[edge_word(stage, edge)], share);
        let along = place(stage_edge(level, rules.spacing), local + 1u, rules.mode);
        at = side_coordinate(rules.domain, found.y, along);
    } else {
        id = item - stage.corners - stage.edges;
        var shape = placed_shape(id);
        let levels = placed_levels(id);
        shape.inner = levels;
        shape.outer = vec4(levels, levels);
        at = inner_coordinate(rules, shape, local);
    }
#ifdef STAGE_EVALUATED
    // The draws evaluate: patch and place are enough.
    vertices[3u * index] = id;
    vertices[3u * index + 1u] = at.x;
    vertices[3u * index + 2u] = at.y;
#else
    let input = load_patch(id);
    let vertex = evaluate(input, as_numbers(at));
    let position = stage_position(input, vertex.position);
    let base = index * VERTEX_WORDS;
    vertices[base] = bitcast<u32>(position.x);
    vertices[base + 1u] = bitcast<u32>(position.y);
    vertices[base + 2u] = bitcast<u32>(position.z);
    vertices[base + 3u] = pack_normal(stage_normal(input, vertex.normal), vertex.material);
    vertices[base + 4u] = pack2x16snorm(vertex.uv / stage.uv_range);
#ifdef STAGE_MOVES
    let before = previous_stage_position(input, vertex.previous);
    previous[3u * index] = before.x;
    previous[3u * index + 1u] = before.y;
    previous[3u * index + 2u] = before.z;
#endif
#endif
}

// Index in the pool of a vertex of patch `id`.
fn pool_index(id: u32, shape: Shape, vertex: vec2<u32>) -> u32 {
    if vertex.x == INNER {
        return work[offset_word(stage, stage.corners + stage.edges + id)] + vertex.y;
    }
    let own = stage.patch_table + id * PATCH_WORDS + 4u;
    if vertex.x == CORNER {
        return work[offset_word(stage, tables[own + vertex.y])];
    }
    var word = tables[own + 4u + vertex.x];
    var i = vertex.y;
    var count = shape.sides[vertex.x];
#ifdef STAGE_SPLIT
    if vertex.x == MIDDLE {
        return work[offset_word(stage, tables[own + 8u + vertex.y])];
    }
    let half = shape.first[vertex.x];
    if half > 0u {
        if i > half {
            word = tables[own + 12u + vertex.x];
            i -= half;
            count -= half;
        } else {
            count = half;
        }
    }
#endif
    let first = work[offset_word(stage, stage.corners + (word & EDGE_NUMBER))];
    let reversed = (word & REVERSED) != 0u;
    return first + select(i, count - i, reversed) - 1u;
}

fn emit_primitive(index: u32, item: u32) {
    let rules = stage_rules();
    let id = item - stage.corners - stage.edges;
    let shape = placed_shape(id);
    let local = index - work[offset_word(stage, item) + 1u];
    let found = primitive(rules.domain, shape, local);
    let a = pool_index(id, shape, found[0]);
    let b = pool_index(id, shape, found[1]);
    if rules.domain == ISOLINES {
        indices[2u * index] = a;
        indices[2u * index + 1u] = b;
        return;
    }
    let c = pool_index(id, shape, found[2]);
#ifdef STAGE_CLOCKWISE
    let turned = vec3(a, c, b);
#else
    let turned = vec3(a, b, c);
#endif
    // A patch that the vertex pool does not hold is drawn as points.
    let held = all(turned < vec3(stage.max_vertices));
    indices[3u * index] = select(0u, turned.x, held);
    indices[3u * index + 1u] = select(0u, turned.y, held);
    indices[3u * index + 2u] = select(0u, turned.z, held);
}

@compute @workgroup_size(256)
fn emit(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let vertex_chunks = (work[VERTICES] + CHUNK - 1u) / CHUNK;
    let number = group.x + group.y * COLUMNS;
    let primitives = number >= vertex_chunks;
    let column = select(0u, 1u, primitives);
    let chunk = number - select(0u, vertex_chunks, primitives);
    let index = chunk * CHUNK + thread;
    let count = work[select(VERTICES, PRIMITIVES, primitives)];
    if index >= count {
        return;
    }
    // The item lies between those of this chunk's first and the next chunk's.
    let first = work[chunk_word(stage, column, chunk)];
    var last = item_count(stage) - 1u;
    if (chunk + 1u) * CHUNK < count {
        last = work[chunk_word(stage, column, chunk + 1u)];
    }
    let item = find_item(first, last, column, index);
    if primitives {
        emit_primitive(index, item);
    } else {
        emit_vertex(index, item);
    }
}
