// After emission, a workgroup a shadow view, a thread a group of consecutive patches: from the first to
// the last primitive of the group that may be seen there, as the arguments of a draw.

#import dolomite::stage::types::ISOLINES
#import dolomite::stage::api::{stage, load_patch}
#import dolomite::stage::counts::{placed_shape, work}
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::work::offset_word
#import dolomite::stage::user_bounds::bounds

const GROUPS: u32 = 64u;
// Inward half-spaces of a shadow view, as those of StageView; without the near one, for what stands
// before it casts its shadow too.
const PLANES: u32 = 5u;

// draw_indexed_indirect for each group of each shadow view: index count, 1, first index, 0, 0.
@group(0) @binding(4) var<storage, read_write> ranges: array<u32>;
@group(0) @binding(5) var<storage, read> shadow_planes: array<vec4<f32>>;

fn meets(shadow_view: u32, sphere: vec4<f32>) -> bool {
    var inside = true;
    for (var k = 0u; k < PLANES; k++) {
        let plane = shadow_planes[shadow_view * PLANES + k];
        inside = inside && dot(plane.xyz, sphere.xyz) + plane.w >= -sphere.w;
    }
    return inside;
}

@compute @workgroup_size(64)
fn shadow_ranges(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) group: u32) {
    let size = (stage.patches + GROUPS - 1u) / GROUPS;
    let first = min(group * size, stage.patches);
    let last = min(first + size, stage.patches);
    var low = 0xffffffffu;
    var high = 0u;
    for (var number = first; number < last; number++) {
        // Discarded patches have no segments.
        if placed_shape(number).rows.x == 0u || !meets(id.x, bounds(load_patch(number), stage.view)) {
            continue;
        }
        let at = offset_word(stage, stage.corners + stage.edges + number);
        low = min(low, work[at + 1u]);
        high = max(high, work[at + 3u]);
    }
    high = min(high, stage.max_primitives);
    low = min(low, high);
    let corners = select(3u, 2u, stage_rules().domain == ISOLINES);
    let at = (id.x * GROUPS + group) * 5u;
    ranges[at] = (high - low) * corners;
    ranges[at + 1u] = 1u;
    ranges[at + 2u] = low * corners;
    ranges[at + 3u] = 0u;
    ranges[at + 4u] = 0u;
}
