#define_import_path dolomite::deferred::reach

#import dolomite::deferred::types::{Incident, Light}

// What of a light arrives at a place: 1 / d², windowed to be 0 at the range (Karis 2013), as in Bevy.
// At and beyond the range, and outside of the cone, it is exactly 0.

// Per candela, 1/m². Closer than a centimetre it does not grow any more.
fn attenuation(distance_squared: f32, range_squared: f32) -> f32 {
    if !(distance_squared < range_squared) {
        return 0.0;
    }
    let part = distance_squared / range_squared;
    // 1 - part², without its cancellation.
    let window = (1.0 - part) * (1.0 + part);
    return window * window / max(distance_squared, 1e-4);
}

// Share of a cone's light, by the cosine of the angle from its axis.
fn cone(cosine: f32, cos_outer: f32, cone_scale: f32) -> f32 {
    let share = saturate((cosine - cos_outer) * cone_scale);
    return share * share;
}

// `position` is the place relative to the camera, `camera` that of the camera.
fn arriving(light: Light, camera: vec3<f32>, position: vec3<f32>) -> Incident {
    let offset = (light.position - camera) - position;
    let distance_squared = dot(offset, offset);
    // At the light itself there is no direction; its cosines are then 0.
    let distance = sqrt(distance_squared);
    let to_light = offset / max(distance, 1e-20);
    let share = attenuation(distance_squared, light.range * light.range)
        * cone(-dot(light.direction, to_light), light.cos_outer, light.cone_scale);
    return Incident(to_light, distance, light.color * share, light.radius);
}

// Whether a place lies within the range; `offset` leads to the light. Exactly where `attenuation` is not 0.
fn within(offset: vec3<f32>, range: f32) -> bool {
    return dot(offset, offset) < range * range;
}

// Whether light of a sphere may arrive from the side that `normal` points to: where it does not, the cosine of
// every direction that a highlight takes is 0. The last term is more than the sums round by.
fn before(offset: vec3<f32>, normal: vec3<f32>, radius: f32, range: f32) -> bool {
    return dot(offset, normal) > -(radius * 1.0001 + range * 1e-6);
}

// Whether a place may lie in a spot light's cone; true for a point light.
fn in_cone(offset: vec3<f32>, direction: vec3<f32>, cos_outer: f32) -> bool {
    return -dot(direction, offset) >= (cos_outer - 1e-6) * length(offset);
}
