#define_import_path web::level

// Stands between the stage and the control function that is shown: where a level is set by hand, it is the level of
// every edge; patches that are out of view stay away.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex}
#import web::functions::{control as own_control, evaluate as own_evaluate}

// x: the level, 0 where the function decides.
@group(1) @binding(0) var<uniform> fixed_level: vec4<f32>;

fn control(input: Patch, view: StageView) -> PatchLevels {
    let own = own_control(input, view);
    let level = fixed_level.x;
    if level <= 0.0 || !(own.outer.x > 0.0) {
        return own;
    }
#ifdef STAGE_ISOLINES
    // The number of lines is the function's.
    return PatchLevels(vec4(own.outer.x, level, own.outer.zw), own.inner);
#else
    return PatchLevels(vec4(level), vec2(level));
#endif
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    return own_evaluate(input, at);
}
