#define_import_path dolomite::terrain::cubic

// Catmull-Rom weights of the samples at -1, 0, 1, 2, and their derivatives.
fn cubic_weights(t: f32) -> vec4<f32> {
    let t2 = t * t;
    let t3 = t2 * t;
    return vec4(t2 - 0.5 * (t3 + t), 1.5 * t3 - 2.5 * t2 + 1.0, 2.0 * t2 - 1.5 * t3 + 0.5 * t, 0.5 * (t3 - t2));
}

fn cubic_slopes(t: f32) -> vec4<f32> {
    let t2 = t * t;
    return vec4(2.0 * t - 1.5 * t2 - 0.5, 4.5 * t2 - 5.0 * t, 4.0 * t - 4.5 * t2 + 0.5, 1.5 * t2 - t);
}
