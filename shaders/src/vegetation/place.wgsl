#define_import_path dolomite::vegetation::place

// Where roots are: a function of the place, in integers. CPU reference: plugins/vegetation/src/place.rs, bit for bit.

#import dolomite::terrain::hash::pcg

const RANK_BITS: u32 = 24u;
const LEVELS: u32 = 8u;
const LEVEL_SALT: u32 = 0x9e3779b9u;
const CLUMP_BITS: u32 = 12u;

struct Root {
    cell: vec2<i32>,
    // Place in the cell in 2^-16 of its side: x in the high half, z in the low one.
    at: u32,
    // Below 2^24.
    rank: u32,
    hash: u32,
}

struct Clump {
    hash: u32,
    // Squared distance to the nearest middle, and to the next nearest, in (2^-12 of the clumps' cell)^2.
    near: u32,
    next: u32,
}

fn cell_hash(seed: u32, cell: vec2<i32>) -> u32 {
    return pcg(bitcast<u32>(cell.x) + pcg(bitcast<u32>(cell.y) + seed));
}

fn salted(hash: u32, salt: u32) -> u32 {
    return pcg(hash ^ pcg(salt));
}

// In 0 up to 1: the highest 24 bits.
fn unit(hash: u32) -> f32 {
    return f32(hash >> 8u) * 5.9604644775390625e-8;
}

// Of a share that is not a number 0.
fn threshold(share: f32) -> u32 {
    if share > 0.0 {
        if share < 1.0 {
            return u32(share * 16777216.0);
        }
        return 1u << RANK_BITS;
    }
    return 0u;
}

// How a cell of a level orders the four below it; level 1 is above the cells of the lattice.
fn order_of(seed: u32, parent: vec2<i32>, level: u32) -> u32 {
    return cell_hash(seed + LEVEL_SALT * level, parent);
}

// The digit of a rank that a child has by its parent's order.
fn digit_of(child: u32, order: u32) -> u32 {
    let from_first = child ^ (order >> 30u);
    let digit = (0x78u >> (2u * from_first)) & 3u;
    return digit ^ ((order >> 29u) & (digit >> 1u));
}

// The rank of a cell whose digits of the levels below `least` are 0.
fn rank_from(seed: u32, cell: vec2<i32>, hash: u32, least: u32) -> u32 {
    var at = cell >> vec2(least);
    var rank = 0u;
    for (var level = least; level < LEVELS; level++) {
        let child = bitcast<u32>(at.x & 1) | (bitcast<u32>(at.y & 1) << 1u);
        at = at >> vec2(1u);
        rank = (rank << 2u) | digit_of(child, order_of(seed, at, level + 1u));
    }
    return (rank << (RANK_BITS - 2u * LEVELS)) | (hash & ((1u << (RANK_BITS - 2u * LEVELS)) - 1u));
}

// The candidate of a cell.
fn root_of(seed: u32, cell: vec2<i32>) -> Root {
    let hash = cell_hash(seed, cell);
    return Root(cell, salted(hash, 1u), rank_from(seed, cell, hash, 0u), hash);
}

// Of the candidates in a square of 2^level cells a side that of the least rank; `square` counts such squares.
fn first_root(seed: u32, square: vec2<i32>, level: u32) -> Root {
    var cell = square;
    for (var k = level; k > 0u; k--) {
        let first = order_of(seed, cell, k) >> 30u;
        cell = vec2((cell.x << 1u) | bitcast<i32>(first & 1u), (cell.y << 1u) | bitcast<i32>(first >> 1u));
    }
    let hash = cell_hash(seed, cell);
    return Root(cell, salted(hash, 1u), rank_from(seed, cell, hash, level), hash);
}

// The nearest clump of a candidate: clumps are 2^size cells wide.
fn clump_of(root: Root, seed: u32, size: u32) -> Clump {
    let mask = (1u << size) - 1u;
    let cut = 16u + size - CLUMP_BITS;
    let at = vec2(
        bitcast<i32>((((bitcast<u32>(root.cell.x) & mask) << 16u) | (root.at >> 16u)) >> cut),
        bitcast<i32>((((bitcast<u32>(root.cell.y) & mask) << 16u) | (root.at & 0xffffu)) >> cut),
    );
    var found = Clump(0u, 0xffffffffu, 0xffffffffu);
    for (var k = 0; k < 9; k++) {
        let step = vec2(k % 3 - 1, k / 3 - 1);
        let hash = cell_hash(seed, (root.cell >> vec2(size)) + step);
        let word = salted(hash, 1u);
        // In the middle half of the cell.
        let middle = vec2(
            bitcast<i32>((1u << (CLUMP_BITS - 2u)) + (word >> (33u - CLUMP_BITS))),
            bitcast<i32>((1u << (CLUMP_BITS - 2u)) + ((word & 0xffffu) >> (17u - CLUMP_BITS))),
        );
        let away = step * (1 << CLUMP_BITS) + middle - at;
        let far = bitcast<u32>(away.x * away.x + away.y * away.y);
        if far < found.near {
            found = Clump(hash, far, found.near);
        } else if far < found.next {
            found.next = far;
        }
    }
    return found;
}

// Where a candidate is from an anchor, in 2^-12 m, rounded down; `anchor` in the same units. All wraps: right within
// 2^19 m of the anchor.
fn local_place(root: Root, pitch: i32, anchor: vec2<i32>) -> vec2<i32> {
    let cell = root.cell << vec2(u32(pitch + 12));
    let halves = vec2(root.at >> 16u, root.at & 0xffffu);
    let within = select(halves >> vec2(u32(max(4 - pitch, 0))), halves << vec2(u32(max(pitch - 4, 0))), pitch > 4);
    return cell - anchor + bitcast<vec2<i32>>(within);
}
