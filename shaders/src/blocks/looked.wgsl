#define_import_path dolomite::blocks::looked

// The own vertices of a block in 32 words of up to 13 bits, half a row of cells each: from the least bit on eight centres, the
// four mixed corners in the row of corners before them, and of odd rows one more, of the last column or the last row.

const WORDS: u32 = 32u;
const CENTRE_BITS: u32 = 8u;
const MIXED_BITS: u32 = 4u;
const LAST_BIT: u32 = 12u;

// The first mixed corner of a word along its row.
fn first_mixed(word: u32) -> u32 {
    return 8u * (word & 1u) + 1u - ((word >> 1u) & 1u);
}

// The mixed corner of the last column or row, of odd rows.
fn last_mixed(word: u32) -> vec2<u32> {
    let row = word >> 1u;
    return select(vec2(row, 16u), vec2(16u, row), (word & 1u) == 1u);
}

// Place of a vertex in half cells.
fn looked_vertex(word: u32, bit: u32) -> vec2<u32> {
    let row = word >> 1u;
    let centre = vec2(16u * (word & 1u) + 2u * bit + 1u, 2u * row + 1u);
    let mixed = vec2(2u * first_mixed(word) + 4u * (bit - CENTRE_BITS), 2u * row);
    return select(select(2u * last_mixed(word), mixed, bit < LAST_BIT), centre, bit < CENTRE_BITS);
}
