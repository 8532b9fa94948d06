#define_import_path dolomite::classic::bounded

// The classic scene whose triangles the terrain LOD makes: the same colours and the same light, from
// place and normal of a vertex.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex}
#import dolomite::stage::draw_types::{Shaded, Surface, stage_draw}
#import dolomite::classic::look::{coloured, lit}

// No patch is tessellated.
fn control(input: Patch, view: StageView) -> PatchLevels {
    return PatchLevels(vec4(0.0), vec2(0.0));
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    var vertex: Vertex;
    vertex.normal = vec3(0.0, 1.0, 0.0);
    return vertex;
}

fn material(surface: Surface) -> Shaded {
    let seen = lit(surface.position + stage_draw.anchor, surface.normal);
    return coloured(surface.normal, seen.x, seen.y);
}
