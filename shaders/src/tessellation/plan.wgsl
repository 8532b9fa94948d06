// Pass 2, one workgroup: rounds the levels (lowering all evenly until the pools hold the
// result), gives every vertex and triangle its place by prefix sums, writes the draw arguments.

#import dolomite::tessellation::types::{Corner, Edge, Patch, PlanResult, ViewParams, NONE, MAX_LEVEL}
#import dolomite::tessellation::pattern::{inner_levels, inner_vertices, triangle_count}

@group(0) @binding(0) var<uniform> view: ViewParams;
@group(0) @binding(1) var<storage, read_write> corners: array<Corner>;
@group(0) @binding(2) var<storage, read_write> edges: array<Edge>;
@group(0) @binding(3) var<storage, read_write> patches: array<Patch>;
@group(0) @binding(4) var<storage, read_write> result: PlanResult;

const THREADS: u32 = 256u;
// After so many steps of 0.8 the scale is below 1/64: every level is 1 already.
const LOWERINGS: u32 = 19u;
// Share of the segments that edges outside the frustum get.
const SHADOW_DETAIL: f32 = 0.25;

// Partial sums of the threads: vertices, triangles, drawn patches.
var<workgroup> sums: array<vec3<u32>, 256>;

fn visible(id: u32) -> bool {
    if id == NONE {
        return false;
    }
    return patches[id].visible != 0u;
}

fn corner_used(id: u32) -> bool {
    let around = corners[id].patches;
    return visible(around.x) || visible(around.y) || visible(around.z) || visible(around.w);
}

fn in_frustum(id: u32) -> bool {
    if id == NONE {
        return false;
    }
    return patches[id].visible == 1u;
}

fn edge_level(id: u32, scale: f32) -> u32 {
    let beside = edges[id].patches;
    if !(visible(beside.x) || visible(beside.y)) {
        return 0u;
    }
    // Ground that only casts shadows is seen through a shadow map alone.
    let share = select(SHADOW_DETAIL, 1.0, in_frustum(beside.x) || in_frustum(beside.y));
    return u32(clamp(ceil(edges[id].wanted * scale * share), 1.0, f32(MAX_LEVEL)));
}

fn piece_level(edge: u32, scale: f32) -> u32 {
    if edge == NONE {
        return 0u;
    }
    return edge_level(edge, scale);
}

fn patch_levels(id: u32, scale: f32) -> vec4<u32> {
    var levels = vec4(0u);
    for (var s = 0u; s < 4u; s++) {
        levels[s] = piece_level(patches[id].edges[2u * s], scale)
            + piece_level(patches[id].edges[2u * s + 1u], scale);
    }
    return levels;
}

// Vertices, triangles and drawn patches of item `id`: corners first, then edges, then patches.
fn item_counts(id: u32, scale: f32) -> vec3<u32> {
    if id < view.corner_count {
        return vec3(select(0u, 1u, corner_used(id)), 0u, 0u);
    }
    let edge = id - view.corner_count;
    if edge < view.edge_count {
        let level = edge_level(edge, scale);
        return vec3(max(level, 1u) - 1u, 0u, 0u);
    }
    let place = edge - view.edge_count;
    if patches[place].visible == 0u {
        return vec3(0u);
    }
    let levels = patch_levels(place, scale);
    let inner = inner_levels(levels);
    return vec3(inner_vertices(inner), triangle_count(levels, inner), 1u);
}

fn write_item(id: u32, scale: f32, before: vec3<u32>) {
    if id < view.corner_count {
        corners[id].vertex = select(NONE, before.x, corner_used(id));
        return;
    }
    let edge = id - view.corner_count;
    if edge < view.edge_count {
        edges[edge].level = edge_level(edge, scale);
        edges[edge].vertex = before.x;
        return;
    }
    let place = edge - view.edge_count;
    patches[place].vertex = before.x;
    patches[place].triangle = before.y;
    var inner = vec2(0u);
    if patches[place].visible != 0u {
        inner = inner_levels(patch_levels(place, scale));
    }
    patches[place].inner = inner.x | (inner.y << 16u);
}

@compute @workgroup_size(256)
fn plan(@builtin(local_invocation_index) thread: u32) {
    let items = view.corner_count + view.edge_count + view.patch_count;
    let chunk = (items + THREADS - 1u) / THREADS;
    let first = min(thread * chunk, items);
    let last = min(first + chunk, items);

    var scale = 1.0;
    var lowered = 0u;
    var fits = false;
    var total = vec3(0u);
    // Every thread sees the same totals, so that the loop is uniform.
    loop {
        var sum = vec3(0u);
        for (var id = first; id < last; id++) {
            sum += item_counts(id, scale);
        }
        workgroupBarrier();
        sums[thread] = sum;
        workgroupBarrier();
        // Inclusive prefix sums (Hillis and Steele, 1986).
        for (var stride = 1u; stride < THREADS; stride <<= 1u) {
            var other = vec3(0u);
            if thread >= stride {
                other = sums[thread - stride];
            }
            workgroupBarrier();
            sums[thread] += other;
            workgroupBarrier();
        }
        total = workgroupUniformLoad(&sums[THREADS - 1u]);
        fits = total.x <= view.max_vertices && total.y <= view.max_triangles;
        if fits || lowered == LOWERINGS {
            break;
        }
        scale *= 0.8;
        lowered += 1u;
    }

    var before = vec3(0u);
    if thread > 0u {
        before = sums[thread - 1u];
    }
    for (var id = first; id < last; id++) {
        write_item(id, scale, before);
        before += item_counts(id, scale);
    }
    if thread == 0u {
        // What does not fit even at level 1 is not drawn: nothing is written out of range.
        let count = select(0u, total.y * 3u, fits);
        result.indexed = array(count, 1u, 0u, 0u, 0u);
        result.plain = array(count, 1u, 0u, 0u);
        result.vertices = total.x;
        result.triangles = total.y;
        result.drawn = total.z;
        result.culled = view.patch_count - total.z;
        result.lowered = lowered;
    }
}
