#define_import_path dolomite::tessellation::draw_types

// What the draws of terrain know, byte for byte as plugins/tessellation/src/render/layout.rs.

struct DrawParams {
    // From positions relative to the anchor to clip space, this frame and the last.
    clip_from_anchor: mat4x4<f32>,
    previous_clip_from_anchor: mat4x4<f32>,
    // Camera relative to the anchor, metres.
    camera: vec3<f32>,
    // Seconds, wrapped at 3600: moves the waves.
    time: f32,
    // World position of the anchor (x, z), metres.
    anchor: vec2<f32>,
    // Fraction of the near and the far texture tile at the anchor: keeps texture coordinates
    // small, hence exact, everywhere.
    near_offset: vec2<f32>,
    far_offset: vec2<f32>,
    viewport: vec2<f32>,
    // Metres; -1e30 without a sea.
    sea_level: f32,
    // Side of a texture tile, metres.
    tile: f32,
    // Material boundaries, see MaterialBands: metres and rise over run.
    sand_top: f32,
    tree_line: f32,
    snow_line: f32,
    blend: f32,
    rock_slope: f32,
    snow_slope: f32,
    // Bit 0: fill; bit 1: lines.
    flags: u32,
    // Side of a relief texel, metres; 0 without a relief map.
    relief_texel: f32,
    // Relief texture coordinates of the anchor, and their change a metre.
    relief_offset: vec2<f32>,
    relief_scale: vec2<f32>,
    pad: vec2<f32>,
}

const FILL: u32 = 1u;
const LINES: u32 = 2u;
