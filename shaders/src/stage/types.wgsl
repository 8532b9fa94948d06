#define_import_path dolomite::stage::types

// What a patch is while it is tessellated. CPU reference: plugins/tessellation/src/shape.rs.

// Domains.
const TRIANGLES: u32 = 0u;
const QUADS: u32 = 1u;
const ISOLINES: u32 = 2u;

// Spacings.
const EQUAL: u32 = 0u;
const FRACTIONAL_EVEN: u32 = 1u;
const FRACTIONAL_ODD: u32 = 2u;

// Modes.
const EXACT: u32 = 0u;
const D3D: u32 = 1u;

// 1.0 in the units of places and coordinates, 2^-24.
const UNIT: u32 = 0x1000000u;
// Level 1 in the units of levels, 2^-23.
const ONE: u32 = 0x800000u;

// What does not change within a dispatch.
struct Rules {
    domain: u32,
    spacing: u32,
    mode: u32,
}

// Levels as a control function writes them.
struct Levels {
    // Of u = 0, v = 0, u = 1 (triangles: w = 0), v = 1. Isolines: lines, segments of each.
    outer: vec4<f32>,
    // Along u and v.
    inner: vec2<f32>,
}

struct Shape {
    // Levels, clamped and rounded, in units of 2^-23.
    outer: vec4<u32>,
    inner: vec2<u32>,
    // Segments of the sides; isolines: lines, segments of each.
    sides: vec4<u32>,
    // Segments of the first halves of sides that lie along two edges; 0 for those that do not.
    first: vec4<u32>,
    // Segments along u and v; (1, 1) only where every side has one segment.
    rows: vec2<u32>,
}

// A vertex of a patch: (side 0 to 3, vertex 1 to n - 1), (INNER, index) or (CORNER, corner).
const INNER: u32 = 4u;
const CORNER: u32 = 5u;
