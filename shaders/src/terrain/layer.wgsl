#define_import_path dolomite::terrain::layer

// Records of a terrain, byte for byte as plugins/terrain/src/gpu_layout.rs (a test compares them).

// Kinds of layers. The first four are fractals, by how their octaves are put together.
const FBM: u32 = 0u;
const RIDGED: u32 = 1u;
const BILLOW: u32 = 2u;
const ERODED: u32 = 3u;
const CLASSIC: u32 = 4u;
const BILINEAR: u32 = 5u;
const BICUBIC: u32 = 6u;
const HILL: u32 = 7u;
const EDITS_BILINEAR: u32 = 8u;
const EDITS_BICUBIC: u32 = 9u;

// One source of the terrain. What a kind does not use is 0.
struct Layer {
    kind: u32,
    // Fractal, permutation: number of octaves. Map that is read by tiles: levels, else 0.
    // Edits: entries of the table, as a power of two.
    octaves: u32,
    // Fractal, permutation: index in terrain_data of the octave table, OCTAVE_WORDS an octave; the
    // classic permutation (256 words) follows it. Map: index of the first sample, or of the first level's head.
    // Edits: index of the table, see edits.wgsl.
    data: u32,
    // Fractal: octaves of the warp, 0 for none. Map: levels of windows. Edits: level of the root.
    warp_octaves: u32,
    // Fractal: index of the warp's octave table for x; that for z follows it. Map: index of the first
    // window of level 1, see height_map/deviation.rs; those of the next levels follow.
    // Edits: index of the first sample of the first tile.
    warp_data: u32,
    // Fractal: strength of erosion. Map: from its lowest to its highest height, metres.
    erosion: f32,
    // Height where the mask is 0, metres.
    mask_low: f32,
    // 1 / (high - low) of the mask, 0 for no mask.
    mask_scale: f32,
    // Map: columns, rows. Edits: cells along x, z.
    size: vec2<u32>,
    // Map, edits: place of the first sample; hill: centre.
    origin_cell: vec2<i32>,
    origin_frac: vec2<u32>,
    // Map, edits: samples a metre along x, z, as mantissa * 2^-shift.
    mantissa: vec2<u32>,
    shift: vec2<u32>,
    // Map, edits: samples a metre. Hill: 1 / radius, and height in metres.
    scale: vec2<f32>,
}

// What holds for the whole terrain.
struct TerrainUniform {
    layer_count: u32,
    // Height before the first layer, metres.
    base: f32,
    // Height of the water, metres; -1e30 without any.
    sea_level: f32,
    pad: u32,
}

// Words of one octave in terrain_data.
const OCTAVE_WORDS: u32 = 12u;

// One octave, as it is read from terrain_data.
struct Octave {
    // Cells a metre: mantissa * 2^-shift.
    mantissa: u32,
    shift: u32,
    seed: u32,
    // Added to the coordinates, 32.32 cells: fraction, cell.
    offset_x: vec2<u32>,
    offset_z: vec2<u32>,
    // Metres.
    amplitude: f32,
    // Cells a metre.
    frequency: f32,
    // Amplitude times frequency.
    slope: f32,
    // Slope as a share of the first octave's.
    relative: f32,
}
