#define_import_path dolomite::detail::view

// What an error on the ground is on the screen, at most. CPU reference:
// plugins/ground/src/detail/view.rs, where the formulas are derived.

#import dolomite::detail::bindings::detail

struct Sight {
    // Share of the detail: 1 in the frustum, less where only its shadow is, 0 where nothing is.
    share: f32,
    // The most pixels that a vertical metre in the box is, where it is seen.
    pixels_per_metre: f32,
    // From the eye to the box, metres.
    distance: f32,
}

fn box_share(low: vec3<f32>, high: vec3<f32>) -> f32 {
    var share = 1.0;
    for (var k = 0u; k < 6u; k++) {
        let plane = detail.view.planes[k];
        let farthest = select(low, high, plane.xyz >= vec3(0.0));
        let inside = dot(plane.xyz, farthest) + plane.w;
        if inside < 0.0 {
            share = select(detail.view.shadow_share, 0.0, all(detail.view.sweep == vec3(0.0)));
            if inside + max(dot(plane.xyz, detail.view.sweep), 0.0) < 0.0 {
                return 0.0;
            }
        }
    }
    return share;
}

// Largest |(u x P) . axis| over the box, u upwards.
fn across(axis: vec3<f32>, centre: vec3<f32>, half: vec3<f32>) -> f32 {
    return abs(centre.z * axis.x - centre.x * axis.z) + half.z * abs(axis.x) + half.x * abs(axis.z);
}

// `centre` relative to the eye.
fn box_pixels(centre: vec3<f32>, half: vec3<f32>, distance: f32) -> f32 {
    if detail.view.orthographic == 1.0 {
        return detail.view.scale * sqrt(detail.view.right.y * detail.view.right.y + detail.view.up.y * detail.view.up.y);
    }
    let least = max(dot(centre, detail.view.forward) - dot(half, abs(detail.view.forward)), detail.view.near);
    let seen = max(least, distance * detail.view.cos_corner);
    let moved = max(least, seen - 2.0 * half.y * abs(detail.view.forward.y));
    let far = length(vec2(across(detail.view.right, centre, half), across(detail.view.up, centre, half))) / (seen * moved);
    return detail.view.scale * min(far, 1.0 / (detail.view.cos_corner * moved));
}

fn box_sight(low: vec3<f32>, high: vec3<f32>) -> Sight {
    let centre = (low + high) * 0.5 - detail.view.eye;
    let half = (high - low) * 0.5;
    let distance = length(max(abs(centre) - half, vec3(0.0)));
    return Sight(box_share(low, high), box_pixels(centre, half, distance), distance);
}
