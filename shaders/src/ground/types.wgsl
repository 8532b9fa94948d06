#define_import_path dolomite::ground::types

// How the ground looks, byte for byte as GroundLook in plugins/ground/src/render/kind.rs.

struct GroundLook {
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
    // Side of a relief texel, metres; 0 without a relief map.
    relief_texel: f32,
    // Relief texture coordinates a metre.
    relief_scale: f32,
    pad_a: f32,
    pad_b: f32,
}

// Where in the view a fragment stands: what depends on the view.
struct GroundView {
    // Camera in stage space, metres.
    camera: vec3<f32>,
    // Seconds, wrapped at 3600: moves the waves.
    time: f32,
    // World position (x, z) of stage space's origin, metres.
    anchor: vec2<f32>,
    // Fraction of the near and the far texture tile there: keeps texture coordinates small, hence
    // exact, everywhere.
    near_offset: vec2<f32>,
    far_offset: vec2<f32>,
    // Relief texture coordinates there.
    relief_offset: vec2<f32>,
}

// Depth below the sea that a vertex can carry either way, metres.
const DEPTH_RANGE: f32 = 32.0;
