#define_import_path dolomite::detail::roots

// Ground at the corners of the roots: height and gradient, row by row. Made by the CPU.

#import dolomite::detail::bindings::detail

@group(1) @binding(0) var<storage, read> root_corners: array<vec4<f32>>;

fn root_corner(vertex: vec2<u32>) -> vec3<f32> {
    let place = vertex >> vec2(detail.depth + 1u);
    return root_corners[place.y * (detail.roots.x + 1u) + place.x].xyz;
}
