#define_import_path dolomite::blocks::others

// What becomes another of a record while it is written, by the quarters of the block that take it: bits 0 to 3 those that copy
// it, bits 4 to 7 those that cut by it. CPU reference: plugins/ground/src/blocks/others.rs.

#import dolomite::blocks::bindings::records
#import dolomite::blocks::record::{CELLS, HEIGHTS, RING_ERRORS, VERTICES, number_at}

// Of all that this thread has written.
var<private> taken_by: u32 = 0u;

fn quarters(north: bool, south: bool, west: bool, east: bool) -> u32 {
    return select(0u, 1u, north && west) | select(0u, 2u, north && east) | select(0u, 4u, south && east) | select(0u, 8u, south && west);
}

// Who copies the vertex that stands there, in half cells.
fn copiers(place: vec2<u32>) -> u32 {
    let first = place <= vec2(CELLS);
    let last = place >= vec2(CELLS);
    return quarters(first.y, last.y, first.x, last.x);
}

// Who cuts by a cell, -1 to CELLS each: those within one cell of it.
fn cutters(cell: vec2<i32>) -> u32 {
    let half = i32(CELLS / 2u);
    let first = cell <= vec2(half);
    let last = cell >= vec2(half - 1);
    return quarters(first.y, last.y, first.x, last.x) << 4u;
}

// Writes a word that these take.
fn put_bits(at: u32, bits: u32, whose: u32) {
    taken_by |= select(0u, whose, records[at] != bits);
    records[at] = bits;
}

// All that is known of a corner that is older than its block, from the parent's record; the block lies at this corner of the
// parent's.
fn copy_corner(record: u32, parent: u32, inside: vec2<u32>, corner: vec2<u32>) {
    let above = (corner >> vec2(1u)) + inside;
    let number = number_at(2u * corner);
    let from_number = number_at(2u * above + (corner & vec2(1u)));
    let whose = copiers(2u * corner);
    for (var field = HEIGHTS; field < RING_ERRORS; field += VERTICES) {
        put_bits(record + field + number, records[parent + field + from_number], whose);
    }
}
