#define_import_path dolomite::stage::user

// What stands where a user's functions go: flat patches with levels from their size in pixels.
// Tests and the lab run the stage with it; it is also the pattern to start from.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, entity_params, patch_point, stage_position}

// Level of an edge between two control points.
fn level_between(input: Patch, view: StageView, rule: f32, a: u32, b: u32) -> f32 {
    let p = patch_point(input, a, 0u);
    let q = patch_point(input, b, 0u);
    if rule < 0.0 {
        return p.w + q.w;
    }
    return edge_level(view, stage_position(input, p.xyz), stage_position(input, q.xyz));
}

// Levels of the patch as this view sees it. Parameter 0.x of the entity gives the level of
// everything instead where it is above 0; where it is below, an edge's level is the sum of the fourth
// numbers of its ends.
fn control(input: Patch, view: StageView) -> PatchLevels {
    let rule = entity_params(input, 0u).x;
    if rule > 0.0 {
        return PatchLevels(vec4(rule), vec2(rule));
    }
#ifdef STAGE_FOUR_POINTS
    let u_low = level_between(input, view, rule, 3u, 0u);
    let v_low = level_between(input, view, rule, 0u, 1u);
    let u_high = level_between(input, view, rule, 1u, 2u);
    let v_high = level_between(input, view, rule, 2u, 3u);
    return PatchLevels(vec4(u_low, v_low, u_high, v_high), vec2(max(v_low, v_high), max(u_low, u_high)));
#else
    // Point 0 stands at u = 1, point 1 at v = 1, point 2 at w = 1.
    let u = level_between(input, view, rule, 1u, 2u);
    let v = level_between(input, view, rule, 2u, 0u);
    let w = level_between(input, view, rule, 0u, 1u);
    return PatchLevels(vec4(u, v, w, 1.0), vec2(max(u, max(v, w))));
#endif
}

// The vertex of the patch at a place (u, v, w) of its domain: linear in the points of a triangle
// (u = 1, v = 1, w = 1), bilinear in those of others ((0,0), (1,0), (1,1), (0,1)).
fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let a = patch_point(input, 0u, 0u).xyz;
    let b = patch_point(input, 1u, 0u).xyz;
    let c = patch_point(input, 2u, 0u).xyz;
    var vertex: Vertex;
#ifdef STAGE_FOUR_POINTS
    let d = patch_point(input, 3u, 0u).xyz;
    // Exact where the patch is a parallelogram along the axes, unlike three mixes.
    vertex.position = a + (b - a) * at.x + (d - a) * at.y + (a - b + c - d) * (at.x * at.y);
#else
    vertex.position = a * at.x + b * at.y + c * at.z;
#endif
    vertex.normal = cross(b - a, c - a);
    vertex.uv = at.xy;
    vertex.previous = vertex.position;
    vertex.material = 0u;
    return vertex;
}
