// Pass 1, a thread an item: marks the patches in the frustum, sets the wanted segments of edges.

#import dolomite::terrain::fixed::{GroundPoint, ground_relative}
#import dolomite::terrain::height::terrain_height
#import dolomite::tessellation::types::{Corner, Edge, Patch, ViewParams, NONE, MAX_LEVEL}

@group(0) @binding(0) var<uniform> view: ViewParams;
@group(0) @binding(1) var<storage, read> corners: array<Corner>;
@group(0) @binding(2) var<storage, read_write> edges: array<Edge>;
@group(0) @binding(3) var<storage, read_write> patches: array<Patch>;

// Distance below which an edge is not treated as nearer, metres: Bevy's default near plane.
const NEAREST: f32 = 0.1;
// The bed of water deeper than this cannot be seen, metres: the surface above it is flat.
const OPAQUE_DEPTH: f32 = 12.0;

fn corner_ground(corner: u32) -> vec2<f32> {
    return ground_relative(GroundPoint(corners[corner].cell, corners[corner].frac), view.anchor);
}

fn corner_position(corner: u32) -> vec3<f32> {
    let at = corner_ground(corner);
    let height = terrain_height(GroundPoint(corners[corner].cell, corners[corner].frac)).x;
    return vec3(at.x, max(height, view.sea_level), at.y);
}

// 1 when the box meets the frustum, 2 when only the box swept along the light does, else 0.
fn visibility(low: vec3<f32>, high: vec3<f32>) -> u32 {
    var state = 1u;
    for (var i = 0u; i < 6u; i++) {
        let plane = view.planes[i];
        let farthest = select(low, high, plane.xyz >= vec3(0.0));
        let inside = dot(plane.xyz, farthest) + plane.w;
        if inside < 0.0 {
            state = 2u;
            if inside + max(dot(plane.xyz, view.sweep.xyz), 0.0) < 0.0 {
                return 0u;
            }
        }
    }
    return select(state, 0u, state == 2u && all(view.sweep.xyz == vec3(0.0)));
}

// Whether the ground of a patch lies too deep to be seen; absent patches do not matter.
fn deep(id: u32) -> bool {
    if id == NONE {
        return true;
    }
    return patches[id].max_height < view.sea_level - OPAQUE_DEPTH;
}

@compute @workgroup_size(64)
fn levels(@builtin(global_invocation_id) thread: vec3<u32>) {
    let item = thread.x;
    if item < view.patch_count {
        let least = max(patches[item].min_height, view.sea_level);
        let greatest = max(patches[item].max_height, view.sea_level);
        let low = corner_ground(patches[item].corners.x);
        let high = corner_ground(patches[item].corners.w);
        patches[item].visible = visibility(vec3(low.x, least, low.y), vec3(high.x, greatest, high.y));
    }
    if item < view.edge_count {
        var wanted = 1.0;
        if !(deep(edges[item].patches.x) && deep(edges[item].patches.y)) {
            let a = corner_position(edges[item].corners.x);
            let b = corner_position(edges[item].corners.y);
            let distance = max(length((a + b) * 0.5 - view.eye), NEAREST);
            wanted = length(b - a) * view.segments_per_radian / distance;
        }
        edges[item].wanted = clamp(wanted, 1.0, f32(MAX_LEVEL));
    }
}
