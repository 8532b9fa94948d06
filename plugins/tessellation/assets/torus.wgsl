// A torus with bumps. Control point 0 of a patch holds where it begins, in turns round the ring and round
// the tube; all patches are 1/12 by 1/6 of a turn.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, patch_point, stage_position}

fn torus(turns: vec2<f32>) -> vec3<f32> {
    let a = turns * 6.2831853;
    let tube = 0.42 + 0.05 * sin(12.0 * a.x) * sin(6.0 * a.y);
    let ring = 1.0 + tube * cos(a.y);
    return vec3(ring * cos(a.x), tube * sin(a.y), -ring * sin(a.x));
}

fn place(input: Patch, at: vec2<f32>) -> vec2<f32> {
    return patch_point(input, 0u, 0u).xy + at / vec2(12.0, 6.0);
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let a = stage_position(input, torus(place(input, vec2(0.0, 0.0))));
    let b = stage_position(input, torus(place(input, vec2(1.0, 0.0))));
    let c = stage_position(input, torus(place(input, vec2(1.0, 1.0))));
    let d = stage_position(input, torus(place(input, vec2(0.0, 1.0))));
    let u = vec2(edge_level(view, a, b), edge_level(view, c, d));
    let v = vec2(edge_level(view, d, a), edge_level(view, b, c));
    return PatchLevels(vec4(v.x, u.x, v.y, u.y), vec2(max(u.x, u.y), max(v.x, v.y)));
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let turns = place(input, at.xy);
    var vertex: Vertex;
    vertex.position = torus(turns);
    // Differences over a thousandth of a turn.
    let along = torus(turns + vec2(0.001, 0.0)) - vertex.position;
    let around = torus(turns + vec2(0.0, 0.001)) - vertex.position;
    vertex.normal = cross(along, around);
    vertex.uv = at.xy;
    vertex.previous = vertex.position;
    vertex.material = 0u;
    return vertex;
}
