#define_import_path dolomite::vegetation::seen

// Whether something may be seen.

#import dolomite::vegetation::bindings::params
#import dolomite::vegetation::types::CULL

// Pixels of room: what is drawn off its place by jitter and rounding, and the width of what is widened.
const MARGIN: f32 = 8.0;

// Of a box.
fn is_outside(middle: vec3<f32>, half: vec3<f32>) -> bool {
    if (params.flags & CULL) == 0u {
        return false;
    }
    let far = length(middle - params.eye) + length(half);
    let room = half + vec3(0.05 + MARGIN * far / params.pixels_per_radian);
    for (var k = 0u; k < 6u; k++) {
        let plane = params.planes[k];
        if dot(plane.xyz, middle) + plane.w + dot(abs(plane.xyz), room) < 0.0 {
            return true;
        }
    }
    return false;
}
