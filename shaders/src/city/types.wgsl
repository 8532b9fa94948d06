#define_import_path dolomite::city::types

// What the functions of a city read, and what covers its faces. The struct in Rust: `CityParams` of
// plugins/city/src/render/params.rs.

struct CityParams {
    // Tolerance in pixels; band in which displacement fades, metres; texels a metre; texels along a map.
    relief: vec4<f32>,
    // Greatest displacement of all, metres; greatest bend, 1/m; half of the longest side of a patch, metres; how
    // levels are chosen: a fixed level above 0, 0 by the bound, -1 by distance.
    bound: vec4<f32>,
    // Bend of each surface, 1/m.
    bend: array<vec4<f32>, 2>,
    // Greatest displacement of each surface, metres.
    heights: array<vec4<f32>, 2>,
    // By distance: greatest and least level, where ground ends. Height of the ground, metres.
    ground: vec4<f32>,
    // Nearest and farthest distance of walls, of roofs.
    faces: vec4<f32>,
    // Pitch, width of a street, height of a storey, distance between windows, metres.
    plan: vec4<f32>,
    // Exposed luminance of a lit window; illuminance that far lamps give the ground; distances, metres, between
    // which the light of lamps becomes that.
    night: vec4<f32>,
    // Colour of the lamps' light, mean; exposed luminance of a globe.
    lamps: vec4<f32>,
    // Post: reach, drop, radius of the tube, metres. Side of a building, metres.
    post: vec4<f32>,
    // Seed; number below which windows are lit; whole hour; 1 where only two lines are streets.
    place: vec4<u32>,
}

const ASPHALT: u32 = 0u;
const COBBLES: u32 = 1u;
const GRASS: u32 = 2u;
const BRICKS: u32 = 3u;
const PLASTER: u32 = 4u;
const TILES: u32 = 5u;
const LEAVES: u32 = 6u;
const FAR: u32 = 7u;
