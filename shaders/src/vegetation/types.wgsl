#define_import_path dolomite::vegetation::types

// What passes and draws are told, byte for byte as plugins/vegetation/src/render/layout.rs.
//
// Space: positions are relative to the anchor of the ground's view, metres, axes of the world; steps are 2^-12 m.

const MOST_LAYERS: u32 = 8u;
const MOST_RINGS: u32 = 8u;
// Lists of records: blades of three levels of detail, flowers of two, chains of three.
const LISTS: u32 = 8u;

// Squares of cells about the eye, of one level of ranks.
struct Ring {
    // Least corner, steps.
    least: vec2<i32>,
    // The same in squares of 2^level cells a side, counted from the world's origin.
    square: vec2<i32>,
    // Tiles of 8 x 8 squares within it that belong to finer rings: first and behind the last.
    inner_from: vec2<i32>,
    inner_to: vec2<i32>,
    // Tiles a side.
    tiles: i32,
    level: u32,
    pad: vec2<u32>,
}

// A kind as it is placed: first where it grows, as plugins/vegetation/src/density.rs has it.
struct Layer {
    seed: u32,
    pitch: i32,
    // Density where it grows best, as a share of the lattice's own.
    full: f32,
    // How much clumps differ.
    uneven: f32,
    // Heights above the sea: from, to, steepness of the edges; slopes.
    height_from: f32,
    height_to: f32,
    height_steep: f32,
    slope_from: f32,
    slope_to: f32,
    slope_steep: f32,
    clump_seed: u32,
    // 2 to this power cells; NO_CLUMPS.
    clump_size: u32,
    clump_from: f32,
    clump_to: f32,
    pad: vec2<u32>,
    // Height of the tallest, metres.
    tallest: f32,
    // Height of the anchor above the sea, metres.
    above: f32,
    ring_count: u32,
    // The list of its finest level of detail.
    list: u32,
    // As the functions of law.wgsl have it.
    reach: vec4<f32>,
    // Heights in pixels of the tallest below which the next level of detail is taken, and the one after that.
    lods: vec2<f32>,
    more: vec2<u32>,
    rings: array<Ring, 8>,
}

const NO_CLUMPS: u32 = 0xffffffffu;

struct GrowParams {
    // Inward half-spaces of what is seen.
    planes: array<vec4<f32>, 6>,
    eye: vec3<f32>,
    pixels_per_radian: f32,
    // World position of the anchor, steps; wraps.
    anchor: vec2<i32>,
    layer_count: u32,
    // CULL.
    flags: u32,
    // Of each list: room for records, where its records begin, vertices of what is drawn of one.
    rooms: array<vec4<u32>, 2>,
    bases: array<vec4<u32>, 2>,
    vertices: array<vec4<u32>, 2>,
    // Room for pieces.
    piece_room: u32,
    // What the first texture coordinate of the ground's vertices is multiplied by: under water it is the depth.
    depth_range: f32,
    pad_b: u32,
    pad_c: u32,
    layers: array<Layer, 8>,
}

const CULL: u32 = 1u;

// Words of the counts.
const PIECES: u32 = 0u;
// Of each list.
const RECORDS: u32 = 1u;
// Candidates that were looked at; those that stand, whether they are seen or not.
const LOOKED: u32 = 9u;
const STANDING: u32 = 10u;
// Bits of the f32 that the ranks' shares are cut at.
const CUT: u32 = 11u;
// Records that were wanted, pieces that were.
const WANTED: u32 = 12u;
const WANTED_PIECES: u32 = 13u;

// Words of the arguments: dispatches of what divides, of what grows, of what grows once more; draws of four words, one
// each list; those of the first lists into shadow maps.
const DIVIDES: u32 = 0u;
const GROWS: u32 = 4u;
const GROWS_AGAIN: u32 = 8u;
const DRAWS: u32 = 12u;
const SHADOWS: u32 = 44u;
const SHADOW_LISTS: u32 = 2u;

// A root that stands and may be seen: 16 bytes.
struct Record {
    position: vec3<f32>,
    // Of the ground.
    normal: vec3<f32>,
    // 16 bits.
    hash: u32,
    layer: u32,
    // Of its clump, 5 bits.
    clump: u32,
    // How far it has come in, 0 to 1.
    entered: f32,
}

fn pack_record(steps: vec2<i32>, height: f32, normal: vec3<f32>, hash: u32, layer: u32, clump: u32, entered: f32) -> vec4<u32> {
    let x = bitcast<u32>(steps.x) & 0xffffffu;
    let z = bitcast<u32>(steps.y) & 0xffffffu;
    let tilt = vec2<u32>(round((clamp(normal.xz, vec2(-1.0), vec2(1.0)) * 0.5 + 0.5) * 511.0));
    let come = u32(round(clamp(entered, 0.0, 1.0) * 63.0));
    return vec4(
        x | (z << 24u),
        (z >> 8u) | (hash << 16u),
        bitcast<u32>(height),
        come | ((layer & 7u) << 6u) | ((clump & 31u) << 9u) | (tilt.x << 14u) | (tilt.y << 23u),
    );
}

fn unpack_record(word: vec4<u32>) -> Record {
    let x = bitcast<i32>(word.x << 8u) >> 8u;
    let z = bitcast<i32>(((word.x >> 24u) << 8u) | (word.y << 16u)) >> 8u;
    let tilt = vec2(f32((word.w >> 14u) & 511u), f32(word.w >> 23u)) / 511.0 * 2.0 - 1.0;
    let up = sqrt(max(1.0 - dot(tilt, tilt), 0.0));
    return Record(
        vec3(f32(x) * 0.000244140625, bitcast<f32>(word.z), f32(z) * 0.000244140625),
        normalize(vec3(tilt.x, max(up, 1e-3), tilt.y)),
        word.y >> 16u,
        (word.w >> 6u) & 7u,
        (word.w >> 9u) & 31u,
        f32(word.w & 63u) / 63.0,
    );
}
