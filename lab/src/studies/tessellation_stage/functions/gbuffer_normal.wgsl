#define_import_path bevy_pbr::utils

// Stands in for Bevy's module of this name, with the one function that the stage's draw takes from it.

// A direction as octahedral coordinates in [0, 1] (Cigolle et al. 2014).
fn octahedral_encode(v: vec3<f32>) -> vec2<f32> {
    let n = v / (abs(v.x) + abs(v.y) + abs(v.z));
    let folded = (1.0 - abs(n.yx)) * select(vec2(-1.0), vec2(1.0), n.xy > vec2(0.0));
    return select(folded, n.xy, n.z >= 0.0) * 0.5 + 0.5;
}
