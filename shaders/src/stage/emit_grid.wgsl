// Pass 6, a thread some of a patch: joins its inner vertices; of isolines, all.

#import dolomite::stage::types::{TRIANGLES, ISOLINES}
#import dolomite::stage::api::stage
#import dolomite::stage::counts::{placed_shape, work}
#import dolomite::stage::divide::divide_small
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::shape::{Pair, cell_pair, grid_triangles, ring_pair}
#import dolomite::stage::triangle::{indices, store_triangle}
#import dolomite::geometry::head::PRIMITIVES
#import dolomite::stage::work::{COLUMNS, offset_word, thread_before, thread_word}

@compute @workgroup_size(256)
fn emit_grid(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = (group.x + group.y * COLUMNS) * 256u + thread;
    if number >= thread_before(stage, 1u, stage.patches, work[PRIMITIVES]) {
        return;
    }
    let rules = stage_rules();
    let id = work[thread_word(stage, 1u, number)];
    let at = offset_word(stage, stage.corners + stage.edges + id);
    let inner = work[at];
    let first = work[at + 1u];
    let end = work[at + 3u];
    let start = thread_before(stage, 1u, id, first);
    // The threads of a patch take turns, so that neighbours write beside each other.
    let turn = thread_before(stage, 1u, id + 1u, end) - start;
    let held = min(end, stage.max_primitives) - min(first, stage.max_primitives);
    let shape = placed_shape(id);
    if rules.domain == ISOLINES {
        for (var t = number - start; t < held; t += turn) {
            let vertex = inner + t + divide_small(t, shape.sides.y);
            indices[2u * (first + t)] = vertex;
            indices[2u * (first + t) + 1u] = vertex + 1u;
        }
        return;
    }
    let count = min(grid_triangles(rules.domain, shape.rows), held);
    for (var pair = number - start; 2u * pair < count; pair += turn) {
        var found: Pair;
        if rules.domain == TRIANGLES {
            found = ring_pair(shape.rows.x, pair);
        } else {
            found = cell_pair(shape.rows, pair);
        }
        let index = first + 2u * pair;
        store_triangle(index, found.first + vec3(inner));
        if 2u * pair + 1u < count {
            store_triangle(index + 1u, found.second + vec3(inner));
        }
    }
}
