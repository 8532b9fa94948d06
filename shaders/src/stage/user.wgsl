#define_import_path dolomite::stage::user

// What stands where a user's functions go: flat patches with levels from their size in pixels.
// Tests and the lab run the stage with it; it is also the pattern to start from.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, entity_params, patch_point, stage_position}

// Levels of the patch as this view sees it. Parameter 0 of the entity, where its x is above 0,
// gives the level of everything instead.
fn control(input: Patch, view: StageView) -> PatchLevels {
    let given = entity_params(input, 0u);
    if given.x > 0.0 {
        return PatchLevels(vec4(given.x), vec2(given.x));
    }
    let a = stage_position(input, patch_point(input, 0u, 0u).xyz);
    let b = stage_position(input, patch_point(input, 1u, 0u).xyz);
    let c = stage_position(input, patch_point(input, 2u, 0u).xyz);
    // A triangle's point 0 is at u = 1, its point 1 at v = 1, its point 2 at w = 1.
    let u = edge_level(view, b, c);
    let v = edge_level(view, c, a);
    let w = edge_level(view, a, b);
    return PatchLevels(vec4(u, v, w, v), vec2(max(u, max(v, w))));
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
    vertex.position = mix(mix(a, b, at.x), mix(d, c, at.x), at.y);
#else
    vertex.position = a * at.x + b * at.y + c * at.z;
#endif
    vertex.normal = cross(b - a, c - a);
    vertex.uv = at.xy;
    vertex.previous = vertex.position;
    vertex.material = 0u;
    return vertex;
}
