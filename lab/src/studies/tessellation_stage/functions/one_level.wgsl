
// Parameter 0.x of the entity is the level of everything.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, entity_params, patch_point}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let level = entity_params(input, 0u).x;
    return PatchLevels(vec4(level), vec2(level));
}
