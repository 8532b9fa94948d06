// Spheres from octahedra of triangle patches: stars, lamp globes, planets.
// Entity parameters: 0.x material, 0.y roughness of its surface in radii (0: smooth).

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, entity_params, in_view, patch_point, stage_position}

fn on_sphere(p: vec3<f32>) -> vec3<f32> {
    return normalize(p);
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let a = stage_position(input, on_sphere(patch_point(input, 0u, 0u).xyz));
    let b = stage_position(input, on_sphere(patch_point(input, 1u, 0u).xyz));
    let c = stage_position(input, on_sphere(patch_point(input, 2u, 0u).xyz));
    let centre = stage_position(input, vec3(0.0));
    let radius = distance(a, centre);
    if !in_view(view, centre, radius) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    // An eighth of a sphere bulges: its edges are an eleventh longer than their chords.
    let u = 1.11 * edge_level(view, b, c);
    let v = 1.11 * edge_level(view, c, a);
    let w = 1.11 * edge_level(view, a, b);
    return PatchLevels(vec4(u, v, w, 1.0), vec2(max(u, max(v, w))));
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let p = patch_point(input, 0u, 0u).xyz * at.x + patch_point(input, 1u, 0u).xyz * at.y + patch_point(input, 2u, 0u).xyz * at.z;
    let n = on_sphere(p);
    var vertex: Vertex;
    vertex.position = n;
    vertex.normal = n;
    vertex.uv = at.xy;
    vertex.previous = n;
    vertex.material = u32(entity_params(input, 0u).x);
    return vertex;
}
