#define_import_path dolomite::blocks::record

// What is kept of a block, word by word as plugins/ground/src/blocks/record.rs and place.rs have it. Vertices: 17 x 17
// corners row by row, then 16 x 16 centres row by row. Places in a block are half cells: even ones are corners, odd ones
// centres.

const CELLS: u32 = 16u;
const CORNERS: u32 = 17u;
const CORNER_COUNT: u32 = 289u;
const VERTICES: u32 = 545u;
// New in a block: the corners of mixed parity, then the centres.
const MIXED: u32 = 144u;
const CENTRES: u32 = 256u;
const OWN: u32 = 400u;
// Cells along a side with a ring of one around.
const RINGED: u32 = 18u;
const RINGED_COUNT: u32 = 324u;

// Words of a record.
const HEIGHTS: u32 = 0u;
const GRADIENTS: u32 = 545u;
const ERRORS: u32 = 1090u;
const LOWS: u32 = 1635u;
const HIGHS: u32 = 2180u;
const RING_ERRORS: u32 = 2725u;
const CELL_LOWS: u32 = 2793u;
const CELL_HIGHS: u32 = 3117u;
const RECORD_WORDS: u32 = 3441u;

// Slot of a block that has not been made.
const NO_BLOCK: u32 = 0u;
// The error of what is always there.
const ALWAYS: f32 = 3e38;
// Share of the tolerance from which on a vertex is there, and share of its parents' error that it has at most.
const WINDOW: f32 = 0.82;
const NEST: f32 = 0.819;
// Growth of errors a bisection.
const GROWTH: f32 = 1.22161;
// Least half side of a block, lattice steps.
const LEAST_HALF: u32 = 32u;

// 64 bytes.
struct BlockHead {
    // Centre of its square, lattice coordinates; 0 where the slot is free.
    centre: vec2<u32>,
    half: u32,
    parent: u32,
    children: vec4<u32>,
    // Number of the last choice that looked at it.
    looked: u32,
    // Largest error of its mixed corners, metres.
    mixed_error: f32,
    // Of the intervals of its vertices.
    low: f32,
    high: f32,
    // Which quarters take what has become another when it was last made or refreshed, see others.wgsl.
    others: u32,
    pad_a: u32,
    pad_b: u32,
    pad_c: u32,
}

// The k-th corner of mixed parity, by rows.
fn mixed_corner(k: u32) -> vec2<u32> {
    let pair = k / 17u;
    let rest = k % 17u;
    let even_row = rest < 8u;
    return vec2(select(2u * (rest - 8u), 2u * rest + 1u, even_row), 2u * pair + select(1u, 0u, even_row));
}

// The k-th vertex that is new in a block, in half cells.
fn own_vertex(k: u32) -> vec2<u32> {
    let centre = k - MIXED;
    return select(2u * vec2(centre % CELLS, centre / CELLS) + vec2(1u), 2u * mixed_corner(k), k < MIXED);
}

fn vertex_at(number: u32) -> vec2<u32> {
    let centre = number - CORNER_COUNT;
    return select(
        2u * vec2(centre % CELLS, centre / CELLS) + vec2(1u),
        2u * vec2(number % CORNERS, number / CORNERS),
        number < CORNER_COUNT,
    );
}

// Number of the vertex that stands there: both coordinates even or both odd.
fn number_at(place: vec2<u32>) -> u32 {
    let at = place >> vec2(1u);
    return select(at.y * CORNERS + at.x, CORNER_COUNT + at.y * CELLS + at.x, (place.x & 1u) == 1u);
}

// Number of cell (i, j) in the ring of one around the block, -1 to CELLS each; see ring_number in record.rs.
fn ring_number(at: vec2<i32>) -> u32 {
    let along = u32(at.x + 1);
    if at.y < 0 {
        return along;
    }
    if at.y >= i32(CELLS) {
        return RINGED + along;
    }
    return 2u * RINGED + 2u * u32(at.y) + select(0u, 1u, at.x >= 0);
}

fn ringed_number(at: vec2<i32>) -> u32 {
    return u32(at.y + 1) * RINGED + u32(at.x + 1);
}

// At which corner of its parent a cell lies whose coordinates are these.
fn quarter_at(at: vec2<u32>) -> u32 {
    let east = (at.x & 1u) == 1u;
    return select(select(0u, 1u, east), select(3u, 2u, east), (at.y & 1u) == 1u);
}

// At which corner of its parent a block lies.
fn block_quarter(centre: vec2<u32>, half: u32) -> u32 {
    return quarter_at((centre / half) >> vec2(1u));
}

// North-western corner of a quarter among its parent's corners.
fn quarter_corner(quarter: u32) -> vec2<u32> {
    return vec2(select(0u, 8u, quarter == 1u || quarter == 2u), select(0u, 8u, quarter >= 2u));
}

fn pack_gradient(gradient: vec2<f32>) -> u32 {
    let share = -gradient / (1.0 + abs(gradient.x) + abs(gradient.y));
    return pack2x16snorm(share);
}

fn unpack_gradient(bits: u32) -> vec2<f32> {
    let share = unpack2x16snorm(bits);
    let up = max(1.0 - abs(share.x) - abs(share.y), 1.0 / 32767.0);
    return -share / up;
}
