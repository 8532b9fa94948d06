#define_import_path dolomite::geometry::head

// How the work buffer of every producer begins, in words: arguments of the draws, and what is counted.
// The GPU version of GeometryHead in plugins/geometry/src/layout.rs.

// draw_indexed_indirect: index count, 1, 0, 0, 0.
const INDEXED: u32 = 0u;
// draw_indirect: vertices of an amplified primitive, primitives, 0, 0.
const AMPLIFIED: u32 = 5u;
// draw_indirect of the same primitives, their indices fetched by the shader: index count, 1, 0, 0.
const PLAIN: u32 = 9u;
// draw_indexed_indirect of what the camera does not see, for shadow maps.
const OTHERS: u32 = 13u;
// Counters.
const VERTICES: u32 = 18u;
const PRIMITIVES: u32 = 19u;
// What the pools would have to hold if nothing were left out.
const WANTED_VERTICES: u32 = 20u;
const WANTED_PRIMITIVES: u32 = 21u;
// What was looked at and emits nothing; steps by which detail was lowered to fit the pools.
const DISCARDED: u32 = 22u;
const LOWERED: u32 = 23u;
// The producer's own words, 16.
const OWN: u32 = 24u;
const HEAD_WORDS: u32 = 40u;
