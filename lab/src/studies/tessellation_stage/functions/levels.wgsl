
// Levels from two control points of the patch's own behind those that span it: outer, then inner.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, entity_params, patch_point}

#ifdef STAGE_FOUR_POINTS
const OWN: u32 = 4u;
#else
const OWN: u32 = 3u;
#endif

fn control(input: Patch, view: StageView) -> PatchLevels {
    return PatchLevels(patch_point(input, OWN, 0u), patch_point(input, OWN + 1u, 0u).xy);
}
