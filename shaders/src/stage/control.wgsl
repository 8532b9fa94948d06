// Pass 1, a thread a patch: asks the control function for levels; marks corners and edges of the
// patches that are not discarded, edges with the greater level of both sides.

#import dolomite::stage::types::ISOLINES
#import dolomite::stage::api::{stage, tables, load_patch, entity_seen, PATCH_WORDS, WHOLE_SIDE}
#import dolomite::stage::level::{clamp_inner, clamp_level, clamp_outer, discarded}
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::shape::corner_count
#import dolomite::geometry::head::DISCARDED
#import dolomite::stage::work::{COLUMNS, EDGE_NUMBER, corner_word, edge_word, inner_word}
#import dolomite::stage::user::control

@group(0) @binding(3) var<storage, read_write> work: array<atomic<u32>>;

@compute @workgroup_size(64)
fn control_patches(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let id = (group.x + group.y * COLUMNS) * 64u + thread;
    if id >= stage.patches {
        return;
    }
    let rules = stage_rules();
    let input = load_patch(id);
    var outer_bits = vec4(0u);
    var inner_bits = vec2(0u);
    if entity_seen(input) {
        let levels = control(input, stage.view);
        outer_bits = bitcast<vec4<u32>>(levels.outer);
        inner_bits = bitcast<vec2<u32>>(levels.inner);
    }
    let at = inner_word(stage, id);
    if discarded(rules, outer_bits) {
        atomicStore(&work[at], 0u);
        atomicStore(&work[at + 1u], 0u);
        atomicAdd(&work[DISCARDED], 1u);
        return;
    }
    let outer = clamp_outer(rules, outer_bits);
    if rules.domain == ISOLINES {
        atomicStore(&work[at], outer.x);
        atomicStore(&work[at + 1u], outer.y);
        return;
    }
    let inner = clamp_inner(rules, inner_bits);
    atomicStore(&work[at], inner.x);
    atomicStore(&work[at + 1u], inner.y);
    let own = stage.patch_table + id * PATCH_WORDS + 4u;
    for (var side = 0u; side < corner_count(rules.domain); side++) {
        atomicStore(&work[corner_word(tables[own + side])], 1u);
#ifdef STAGE_SPLIT
        let middle = tables[own + 8u + side];
        if middle != WHOLE_SIDE {
            // Each half gets half of the level.
            let halved = bitcast<u32>(bitcast<f32>(outer_bits[side]) * 0.5);
            let level = clamp_level(halved, rules.spacing, rules.mode);
            atomicStore(&work[corner_word(middle)], 1u);
            atomicMax(&work[edge_word(stage, tables[own + 4u + side] & EDGE_NUMBER)], level);
            atomicMax(&work[edge_word(stage, tables[own + 12u + side] & EDGE_NUMBER)], level);
            continue;
        }
#endif
        atomicMax(&work[edge_word(stage, tables[own + 4u + side] & EDGE_NUMBER)], outer[side]);
    }
}
