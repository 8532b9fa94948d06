#define_import_path dolomite::ground::types

// How the ground looks, byte for byte as GroundLook in plugins/ground/src/render/look.rs.

// Where a layer lies, by one measure.
struct GroundBand {
    // What is measured: shares of height, height above the sea and slope; then what is added for each unit of
    // slope beyond STEEP.
    measure: vec4<f32>,
    // Ends of the smooth step; then the share of the layer below them, and what the step adds to it.
    edge: vec4<f32>,
    // How far the wide and the fine noise move the edge.
    noise: vec4<f32>,
}

// What a layer shows.
struct GroundLayer {
    // Of a layer without a texture: linear colour, and roughness.
    colour: vec4<f32>,
    // Layer of the texture arrays; NO_TEXTURE without.
    texture: u32,
    // Which size of tile.
    tile: u32,
    // 1 where the texture is laid on from the side of steep ground.
    cliff: u32,
    pad: u32,
}

// What grows, seen from afar.
struct CanopyLayer {
    // Heights of the world between which it grows, steepness of the edges; distance from which on the ground shows it.
    height: vec4<f32>,
    // The same of slopes; distance from which on all of it is the ground's: 0 where there is no such layer.
    slope: vec4<f32>,
    // Depth and colour at the sines 2^(k/2 - 8).
    entries: array<vec4<f32>, 17>,
}

struct GroundLook {
    // Metres; -1e30 without a sea.
    sea_level: f32,
    // Side of a relief texel, metres; 0 without a relief map.
    relief_texel: f32,
    // Relief texture coordinates a metre.
    relief_scale: f32,
    // Layers that there are.
    count: u32,
    // Sides of texture tiles, metres.
    tiles: vec4<f32>,
    // Extinction of the water, 1/m; then the greatest slope of a wave.
    water: vec4<f32>,
    // Colour of deep water; then by how much blends of the cheaper way are narrowed at either end, 0 to 0.45.
    deep: vec4<f32>,
    // From the uppermost layer to the lowest: which layer, and its bands from the first to before the last.
    order: array<vec4<u32>, 32>,
    layers: array<GroundLayer, 32>,
    bands: array<GroundBand, 64>,
    canopy: array<CanopyLayer, 4>,
}

const NO_TEXTURE: u32 = 0xffffffffu;

// Where in the view a fragment stands: what depends on the view.
struct GroundView {
    // Camera in stage space, metres.
    camera: vec3<f32>,
    // Seconds, wrapped at 3600: moves the waves.
    time: f32,
    // Width of a pixel of a picture of 1080 rows, a metre away and anywhere: the one of pinholes, the other of parallel
    // views.
    pixel: vec2<f32>,
    // World position (x, z) of stage space's origin, metres.
    anchor: vec2<f32>,
    // Relief texture coordinates there.
    relief_offset: vec2<f32>,
    // Fraction of the near (xy) and the far (zw) texture tile there, of each size of tile: keeps texture
    // coordinates small, hence exact, everywhere.
    offset_a: vec4<f32>,
    offset_b: vec4<f32>,
    offset_c: vec4<f32>,
}

// Depth below the sea that a vertex can carry either way, metres.
const DEPTH_RANGE: f32 = 32.0;
