#define_import_path dolomite::geometry::amplify_types

// A vertex as it comes out of the pool, for amplify functions, which stand in for geometry shaders.

struct StoredVertex {
    // Relative to the anchor, metres, axes of the world.
    position: vec3<f32>,
    // Of length 1.
    normal: vec3<f32>,
    uv: vec2<f32>,
    previous: vec3<f32>,
    material: u32,
}
