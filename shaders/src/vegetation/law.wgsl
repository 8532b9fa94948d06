#define_import_path dolomite::vegetation::law

// How many of those that stand are drawn at a distance, and how wide. Of these functions `kept_share` stands in Rust too:
// plugins/vegetation/src/render/law.rs.

// The share that is drawn at a distance, of which each is wider for it.
fn kept_share(reach: vec4<f32>, distance: f32) -> f32 {
    let d = max(distance, 1e-3);
    return min(1.0, reach.x / d) * min(1.0, reach.y / d);
}

// What is left of it towards the end.
fn left_share(reach: vec4<f32>, distance: f32) -> f32 {
    let t = clamp((distance - reach.z) / max(reach.w - reach.z, 1e-3), 0.0, 1.0);
    return 1.0 - t * t * (3.0 - 2.0 * t);
}

// Ranks between this share of the threshold and all of it are on their way in.
const BAND: f32 = 0.25;

// How far a rank has come in, of which `part` is the ratio to the threshold.
fn entered(part: f32) -> f32 {
    return clamp((1.0 - part) / BAND, 0.0, 1.0);
}

// Width that makes up for those which are missing and for those on their way in.
fn widened(reach: vec4<f32>, distance: f32, come: f32) -> f32 {
    return come / ((1.0 - 0.5 * BAND) * kept_share(reach, distance));
}
