#define_import_path dolomite::geometry::draw_types

// What the draws know, byte for byte as plugins/geometry/src/layout.rs, and what material functions are
// given and give.
//
// Space: positions are relative to an anchor near the camera, metres, axes of the world.

struct GeometryDraw {
    // From there to clip space, this frame and the last.
    clip_from_anchor: mat4x4<f32>,
    previous_clip_from_anchor: mat4x4<f32>,
    // Camera, metres.
    camera: vec3<f32>,
    // Seconds, wrapped at 3600.
    time: f32,
    // World position of the anchor.
    anchor: vec3<f32>,
    uv_range: f32,
    // Width and height of the picture, pixels.
    viewport: vec2<f32>,
    // FILL, LINES.
    flags: u32,
    // Number of the producer among those of the frame.
    producer: u32,
    // The producer's numbers of the view.
    numbers: array<vec4<f32>, 4>,
}

// Bits of the flags: triangles are filled, their edges are drawn.
const FILL: u32 = 1u;
const LINES: u32 = 2u;

// A row of the producer's table of materials.
struct MaterialRow {
    // Linear colour; w is 1 where the surface does not receive light.
    base_color: vec4<f32>,
    // Luminance in cd/m2; w is the reflectance.
    emissive: vec4<f32>,
    // Perceptual roughness, metallic, occlusion; w is 1 where no fog lies over the surface.
    surface: vec4<f32>,
}

// What the rasteriser gives.
struct Surface {
    // Relative to the anchor, metres.
    position: vec3<f32>,
    // Of length 1, on the side that is seen.
    normal: vec3<f32>,
    uv: vec2<f32>,
    // Row of the table.
    material: u32,
    // What a pixel spans along the picture's rows and down its columns, metres on the surface; 0 at vertices.
    dx: vec3<f32>,
    dy: vec3<f32>,
}

// What goes to the G-buffer.
struct Shaded {
    base_color: vec3<f32>,
    emissive: vec3<f32>,
    normal: vec3<f32>,
    roughness: f32,
    metallic: f32,
    reflectance: f32,
    occlusion: f32,
    unlit: bool,
    fog: bool,
}

struct Materials {
    rows: array<MaterialRow, 16>,
}

@group(2) @binding(0) var<uniform> geometry_draw: GeometryDraw;
@group(2) @binding(1) var<uniform> materials: Materials;

// The material that the surface's row of the table describes.
fn table_material(surface: Surface) -> Shaded {
    let row = materials.rows[min(surface.material, 15u)];
    return Shaded(row.base_color.xyz, row.emissive.xyz, surface.normal, row.surface.x, row.surface.y, row.emissive.w, row.surface.z, row.base_color.w == 1.0, row.surface.w == 0.0);
}
