#define_import_path dolomite::stage::evaluated

// Vertices that the draws evaluate: stands in the place of `geometry/user_vertex.wgsl` for kinds that say
// so. The pool holds patch and place, in units of 2^-24.

#import dolomite::geometry::amplify_types::StoredVertex
#import dolomite::stage::types::{TRIANGLES, UNIT}
#import dolomite::stage::api::{load_patch, previous_stage_position, stage_normal, stage_position}
#import dolomite::stage::coordinate::as_numbers
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::user::evaluate

fn evaluated_vertex(id: u32, place: vec2<u32>) -> StoredVertex {
    let input = load_patch(id);
    let w = select(0u, UNIT - place.x - place.y, stage_rules().domain == TRIANGLES);
    let v = evaluate(input, as_numbers(vec3(place, w)));
    let before = previous_stage_position(input, v.previous);
    return StoredVertex(stage_position(input, v.position), stage_normal(input, v.normal), v.uv, before, v.material);
}
