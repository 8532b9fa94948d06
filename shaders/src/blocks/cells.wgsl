#define_import_path dolomite::blocks::cells

// Triangles of a block that nothing finer cuts, from bits. The aligned squares of 16, 8, 4, 2 and 1 cells are cells of the
// lattice: one is there if the middles of its parent's sides beside it are, and the block's whole square always. If its centre
// is not there it is two triangles; else there is one at each side whose middle is not there, and half of a quarter that has one
// of its middles but not the other. CPU reference: plugins/ground/src/blocks/leaves.rs.

#import dolomite::blocks::record::{CORNERS, CORNER_COUNT, quarter_at}

// Which vertices are there: corners by rows, and centres by rows.
var<workgroup> corner_bits: array<atomic<u32>, 17>;
var<workgroup> centre_bits: array<atomic<u32>, 16>;
// Triangles: numbers of their corners, ten bits each.
var<workgroup> list: array<u32, 1024>;
var<workgroup> listed: atomic<u32>;
// Cells that are drawn: first column, row among those of their level, and level, eight bits each; 341 at most.
var<workgroup> cells: array<u32, 341>;
var<workgroup> cell_count: atomic<u32>;

// Rows of cells of all levels: 16 of one cell's size, 8 of two, 4, 2 and the whole block.
const CELL_ROWS: u32 = 31u;

fn clear_cells(thread: u32) {
    if thread < 17u {
        atomicStore(&corner_bits[thread], 0u);
    }
    if thread < 16u {
        atomicStore(&centre_bits[thread], 0u);
    }
    if thread == 0u {
        atomicStore(&listed, 0u);
        atomicStore(&cell_count, 0u);
    }
}

fn note_there(at: vec2<u32>) {
    let place = at >> vec2(1u);
    if (at.x & 1u) == 0u {
        atomicOr(&corner_bits[place.y], 1u << place.x);
    } else {
        atomicOr(&centre_bits[place.y], 1u << place.x);
    }
}

fn corners_of_row(row: u32) -> u32 {
    return atomicLoad(&corner_bits[row]);
}

// Bits 0, n, 2n and so on up to 16.
fn every(size: u32) -> u32 {
    var bits = 0x1ffffu;
    bits = select(bits, 0x15555u, size == 2u);
    bits = select(bits, 0x11111u, size == 4u);
    bits = select(bits, 0x10101u, size == 8u);
    return select(bits, 0x10001u, size == 16u);
}

fn level_of_row(k: u32) -> u32 {
    return select(0u, 1u, k >= 16u) + select(0u, 1u, k >= 24u) + select(0u, 1u, k >= 28u) + select(0u, 1u, k >= 30u);
}

// The cells of one row that are drawn as cells, not by what holds them or by a finer block, as bits of their first columns.
fn cells_of_row(row: u32, level: u32, children: u32) -> u32 {
    let size = 1u << level;
    let even_row = corners_of_row((row + (row & 1u)) << level);
    let odd_row = corners_of_row(min((row | 1u) << level, 16u));
    let odd = even_row & (every(size) & ~every(2u * size));
    let even = odd_row & every(2u * size);
    // quarter_at: north-west 0, north-east 1, south-east 2, south-west 3.
    let south = (row << level) >= 8u;
    let west = (children >> select(0u, 3u, south)) & 1u;
    let east = (children >> select(1u, 2u, south)) & 1u;
    let finer = select(0u, 0xffu, west == 1u) | select(0u, 0xff00u, east == 1u);
    let there = (odd | (odd >> size)) & (even | (even >> size)) & every(size) & 0xffffu & ~finer;
    return select(there, 1u, level == 4u);
}

fn list_cells(thread: u32, children: u32) {
    if thread >= CELL_ROWS {
        return;
    }
    let level = level_of_row(thread);
    let row = thread - 32u + (32u >> level);
    var bits = cells_of_row(row, level, children);
    var at = atomicAdd(&cell_count, countOneBits(bits));
    while bits != 0u {
        cells[at] = firstTrailingBit(bits) | (row << 8u) | (level << 16u);
        at++;
        bits &= bits - 1u;
    }
}

fn put(at: u32, a: u32, b: u32, c: u32) {
    list[at] = a | (b << 10u) | (c << 20u);
}

// Triangles of the k-th cell; `quarter` is that of the block.
fn list_triangles(k: u32, quarter: u32) {
    let cell = cells[k];
    let x = cell & 255u;
    let level = cell >> 16u;
    let row = (cell >> 8u) & 255u;
    let size = 1u << level;
    let half = size >> 1u;
    let z = row << level;
    let nw = z * CORNERS + x;
    let ne = nw + size;
    let sw = nw + CORNERS * size;
    let se = sw + size;
    let small = level == 0u;
    let middle_row = corners_of_row(z + half);
    let has_centre = select((middle_row >> (x + half)) & 1u, (atomicLoad(&centre_bits[min(z, 15u)]) >> x) & 1u, small) == 1u;
    if !has_centre {
        let outer = select(quarter_at(vec2(x >> level, row)), quarter, level == 4u);
        let at = atomicAdd(&listed, 2u);
        let turned = (outer & 1u) == 1u;
        put(at, select(se, sw, turned), select(ne, se, turned), select(nw, ne, turned));
        put(at + 1u, select(nw, ne, turned), select(sw, nw, turned), select(se, sw, turned));
        return;
    }
    let centre = select(nw + 18u * half, CORNER_COUNT + z * 16u + x, small);
    let west = nw + CORNERS * half;
    let north = nw + half;
    let east = ne + CORNERS * half;
    let south = sw + half;
    // Middles of the sides of cells of one cell's size belong to finer blocks.
    let has = select(15u, 0u, small) & (((middle_row >> x) & 1u) | (((corners_of_row(z) >> (x + half)) & 1u) << 1u)
        | (((middle_row >> (x + size)) & 1u) << 2u) | (((corners_of_row(z + size) >> (x + half)) & 1u) << 3u));
    // Sides that are whole, and corners at which one of the two sides is halved.
    let whole = ~has & 15u;
    let alone = has ^ ((has >> 1u) | ((has & 1u) << 3u));
    var at = atomicAdd(&listed, countOneBits(whole) + countOneBits(alone));
    if (whole & 1u) == 1u {
        put(at, centre, nw, sw);
        at++;
    }
    if (whole & 2u) == 2u {
        put(at, centre, ne, nw);
        at++;
    }
    if (whole & 4u) == 4u {
        put(at, centre, se, ne);
        at++;
    }
    if (whole & 8u) == 8u {
        put(at, centre, sw, se);
        at++;
    }
    if (alone & 1u) == 1u {
        let first = (has & 1u) == 1u;
        put(at, centre, select(north, nw, first), select(nw, west, first));
        at++;
    }
    if (alone & 2u) == 2u {
        let first = (has & 2u) == 2u;
        put(at, centre, select(east, ne, first), select(ne, north, first));
        at++;
    }
    if (alone & 4u) == 4u {
        let first = (has & 4u) == 4u;
        put(at, centre, select(south, se, first), select(se, east, first));
        at++;
    }
    if (alone & 8u) == 8u {
        let first = (has & 8u) == 8u;
        put(at, centre, select(west, sw, first), select(sw, south, first));
    }
}
