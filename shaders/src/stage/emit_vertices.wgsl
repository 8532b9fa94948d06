// Pass 5, a thread up to VERTEX_RUN vertices of an item: evaluates them.

#import dolomite::stage::types::{Rules, UNIT}
#import dolomite::stage::api::{Patch, stage, load_patch, stage_normal, stage_position, previous_stage_position}
#import dolomite::stage::coordinate::as_numbers
#import dolomite::stage::counts::work
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::source::{Source, source_coordinate, source_of}
#import dolomite::geometry::vertex::{VERTEX_WORDS, pack_normal}
#import dolomite::geometry::head::VERTICES
#import dolomite::stage::work::{COLUMNS, item_count, offset_word, thread_before, thread_word}
#import dolomite::stage::user::evaluate

@group(0) @binding(4) var<storage, read_write> vertices: array<u32>;
#ifdef STAGE_MOVES
@group(0) @binding(6) var<storage, read_write> previous: array<f32>;
#endif

#ifdef STAGE_EVALUATED
// The draws evaluate: patch and place are enough.
struct Made {
    id: u32,
    at: vec2<u32>,
}

fn make(rules: Rules, source: Source, input: Patch, local: u32) -> Made {
    return Made(source.id, source_coordinate(rules, source, local).xy);
}

fn store(index: u32, made: Made) {
    vertices[3u * index] = made.id;
    vertices[3u * index + 1u] = made.at.x;
    vertices[3u * index + 2u] = made.at.y;
}
#else
struct Made {
    position: vec3<u32>,
    normal: u32,
    uv: u32,
#ifdef STAGE_MOVES
    before: vec3<f32>,
#endif
}

fn make(rules: Rules, source: Source, input: Patch, local: u32) -> Made {
    // Behind the item's last vertex nothing is kept; the user's function sees no such places.
    let at = min(source_coordinate(rules, source, local), vec3(UNIT));
    let vertex = evaluate(input, as_numbers(at));
    var made: Made;
    made.position = bitcast<vec3<u32>>(stage_position(input, vertex.position));
    made.normal = pack_normal(stage_normal(input, vertex.normal), vertex.material);
    made.uv = pack2x16snorm(vertex.uv / stage.uv_range);
#ifdef STAGE_MOVES
    made.before = previous_stage_position(input, vertex.previous);
#endif
    return made;
}

fn store(index: u32, made: Made) {
    let base = index * VERTEX_WORDS;
    vertices[base] = made.position.x;
    vertices[base + 1u] = made.position.y;
    vertices[base + 2u] = made.position.z;
    vertices[base + 3u] = made.normal;
    vertices[base + 4u] = made.uv;
#ifdef STAGE_MOVES
    previous[3u * index] = made.before.x;
    previous[3u * index + 1u] = made.before.y;
    previous[3u * index + 2u] = made.before.z;
#endif
}
#endif

@compute @workgroup_size(256)
fn emit_vertices(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = (group.x + group.y * COLUMNS) * 256u + thread;
    if number >= thread_before(stage, 0u, item_count(stage), work[VERTICES]) {
        return;
    }
    let rules = stage_rules();
    let item = work[thread_word(stage, 0u, number)];
    let at = offset_word(stage, item);
    let first = work[at];
    let end = work[at + 2u];
    let start = thread_before(stage, 0u, item, first);
    // The threads of an item take turns, so that neighbours write beside each other.
    let turn = thread_before(stage, 0u, item + 1u, end) - start;
    let local = number - start;
    let source = source_of(rules, item);
    let input = load_patch(source.id);
    // All before the first is stored, and no loop: what they load is then the same to a compiler.
    let a = make(rules, source, input, local);
    let b = make(rules, source, input, local + turn);
    let c = make(rules, source, input, local + 2u * turn);
    let d = make(rules, source, input, local + 3u * turn);
    let held = min(end, stage.max_vertices);
    var index = first + local;
    if index < held {
        store(index, a);
    }
    index += turn;
    if index < held {
        store(index, b);
    }
    index += turn;
    if index < held {
        store(index, c);
    }
    index += turn;
    if index < held {
        store(index, d);
    }
}
