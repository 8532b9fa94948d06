// Pass 1, a thread a patch: asks the control function for levels; marks corners and edges of the
// patches that are not discarded, edges with the greater level of both sides.

#import dolomite::stage::types::ISOLINES
#import dolomite::stage::api::{stage, tables, load_patch, PATCH_WORDS}
#import dolomite::stage::level::{clamp_inner, clamp_outer, discarded}
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::shape::corner_count
#import dolomite::stage::work::{COLUMNS, DISCARDED, EDGE_NUMBER, corner_word, edge_word, inner_word}
#import dolomite::stage::user::control

@group(0) @binding(3) var<storage, read_write> work: array<atomic<u32>>;

@compute @workgroup_size(64)
fn control_patches(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let id = (group.x + group.y * COLUMNS) * 64u + thread;
    if id >= stage.patches {
        return;
    }
    let rules = stage_rules();
    let levels = control(load_patch(id), stage.view);
    let outer_bits = bitcast<vec4<u32>>(levels.outer);
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
    let inner = clamp_inner(rules, bitcast<vec2<u32>>(levels.inner));
    atomicStore(&work[at], inner.x);
    atomicStore(&work[at + 1u], inner.y);
    let own = stage.patch_table + id * PATCH_WORDS + 4u;
    for (var side = 0u; side < corner_count(rules.domain); side++) {
        atomicStore(&work[corner_word(tables[own + side])], 1u);
        atomicMax(&work[edge_word(stage, tables[own + 4u + side] & EDGE_NUMBER)], outer[side]);
    }
}
