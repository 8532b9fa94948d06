#define_import_path dolomite::character::skin

// Skinning from the palette. CPU reference: `dolomite_character::crowd::skin`.

#import dolomite::character::bindings::{crowd, palette}
#import dolomite::character::types::{Figure, Rows}

// The matrix of one joint: between two frames of the palette.
fn joint_rows(figure: Figure, joint: u32) -> Rows {
    let at = ((figure.pose >> 16u) * crowd.joints + joint) * 3u;
    let next = at + crowd.joints * 3u;
    let part = f32((figure.pose >> 8u) & 255u) * 0.00390625;
    let rest = 1.0 - part;
    return Rows(
        palette[at] * rest + palette[next] * part,
        palette[at + 1u] * rest + palette[next + 1u] * part,
        palette[at + 2u] * rest + palette[next + 2u] * part,
    );
}

// The matrix of a vertex: the mean of its joints'.
fn vertex_rows(figure: Figure, joints: vec4<u32>, weights: vec4<f32>) -> Rows {
    var sum = Rows(vec4(0.0), vec4(0.0), vec4(0.0));
    for (var i = 0u; i < 4u; i += 1u) {
        if weights[i] > 0.0 {
            let rows = joint_rows(figure, joints[i]);
            sum.x += rows.x * weights[i];
            sum.y += rows.y * weights[i];
            sum.z += rows.z * weights[i];
        }
    }
    return sum;
}

fn skinned_position(rows: Rows, position: vec3<f32>) -> vec3<f32> {
    let p = vec4(position, 1.0);
    return vec3(dot(rows.x, p), dot(rows.y, p), dot(rows.z, p));
}

// Of unit length; exact where joints are scaled evenly.
fn skinned_normal(rows: Rows, normal: vec3<f32>) -> vec3<f32> {
    let n = vec3(dot(rows.x.xyz, normal), dot(rows.y.xyz, normal), dot(rows.z.xyz, normal));
    return n * inverseSqrt(max(dot(n, n), 1e-30));
}
