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
