#define_import_path dolomite::blocks::leaves

// Triangles of a block that nothing finer cuts. The aligned squares of 16, 8, 4, 2 and 1 cells are cells of the lattice: one
// is there if the middles of its parent's sides beside it are, and the block's whole square always. If its centre is not
// there it is two triangles; else there is one at each side whose middle is not there, and half of a quarter that has one of its
// middles but not the other.

#import dolomite::blocks::bindings::seen
#import dolomite::blocks::record::{CORNER_COUNT, NO_BLOCK, WINDOW, quarter_at}
#import dolomite::detail::bindings::detail

// The way of each vertex to the ground, 0 where it is not there.
var<workgroup> share: array<f32, 545>;
// Triangles: numbers of their corners, ten bits each.
var<workgroup> list: array<u32, 1024>;
var<workgroup> listed: atomic<u32>;

fn corner_number(at: vec2<u32>) -> u32 {
    return at.y * 17u + at.x;
}

// Bits of the quarters that are drawn as blocks of their own.
fn find_children(children: vec4<u32>, coarsening: f32) -> u32 {
    var bits = 0u;
    for (var k = 0u; k < 4u; k++) {
        let child = children[k];
        let known = child != NO_BLOCK && seen[child].stamp == detail.stamp;
        let mixed = select(0.0, bitcast<f32>(atomicLoad(&seen[child].mixed)), known);
        bits |= select(0u, 1u << k, mixed > WINDOW * coarsening);
    }
    return bits;
}

struct Corners {
    nw: u32,
    ne: u32,
    se: u32,
    sw: u32,
}

fn cell_corners(cell: vec2<u32>, size: u32) -> Corners {
    let first = corner_number(cell * size);
    return Corners(first, first + size, first + 18u * size, first + 17u * size);
}

fn is_there(number: u32) -> bool {
    return share[number] > 0.0;
}

// Whether a cell of a size below the block's is drawn as a cell, not by what holds it.
fn exists(cell: vec2<u32>, size: u32) -> bool {
    let odd = (cell | vec2(1u)) * size;
    let even = (cell + (cell & vec2(1u))) * size;
    return is_there(corner_number(vec2(odd.x, even.y))) && is_there(corner_number(vec2(even.x, odd.y)));
}

fn drawn_by_child(children: u32, cell: vec2<u32>, size: u32) -> bool {
    return ((children >> quarter_at((cell * size) >> vec2(3u))) & 1u) == 1u;
}

fn put(at: u32, a: u32, b: u32, c: u32) {
    list[at] = a | (b << 10u) | (c << 20u);
}

fn put_halves(at: u32, all: Corners, outer: u32) {
    if (outer & 1u) == 0u {
        put(at, all.se, all.ne, all.nw);
        put(at + 1u, all.nw, all.sw, all.se);
    } else {
        put(at, all.sw, all.se, all.ne);
        put(at + 1u, all.ne, all.nw, all.sw);
    }
}

// The cell of one cell's size that has number k: middles of its sides belong to finer blocks.
fn list_small_cell(k: u32, children: u32) {
    let cell = vec2(k & 15u, k >> 4u);
    if drawn_by_child(children, cell, 1u) || !exists(cell, 1u) {
        return;
    }
    let all = cell_corners(cell, 1u);
    let centre = CORNER_COUNT + k;
    if !is_there(centre) {
        put_halves(atomicAdd(&listed, 2u), all, quarter_at(cell));
        return;
    }
    let at = atomicAdd(&listed, 4u);
    put(at, centre, all.nw, all.sw);
    put(at + 1u, centre, all.ne, all.nw);
    put(at + 2u, centre, all.se, all.ne);
    put(at + 3u, centre, all.sw, all.se);
}

// What is drawn of a cell at one side: `before` and `after` are its ends, `last` and `next` say whether the middles of the
// sides before and after it are there. How many triangles; put where `at` is not beyond the list.
fn put_side(at: u32, centre: u32, before: u32, middle: u32, after: u32, halved: bool, last: bool, next: bool) -> u32 {
    if !halved {
        put(at, centre, after, before);
        return at + 1u;
    }
    var end = at;
    if !last {
        put(end, centre, middle, before);
        end++;
    }
    if !next {
        put(end, centre, after, middle);
        end++;
    }
    return end;
}

// The larger cells: 64 of two cells' size, 16 of four, 4 of eight, and the whole block.
fn list_cell(k: u32, children: u32, quarter: u32) {
    var level = 1u;
    var number = k;
    if k >= 84u {
        level = 4u;
        number = 0u;
    } else if k >= 80u {
        level = 3u;
        number = k - 80u;
    } else if k >= 64u {
        level = 2u;
        number = k - 64u;
    }
    let size = 1u << level;
    let row = 4u - level;
    let cell = vec2(number & ((1u << row) - 1u), number >> row);
    let whole = size == 16u;
    if !whole && (drawn_by_child(children, cell, size) || !exists(cell, size)) {
        return;
    }
    let all = cell_corners(cell, size);
    let half = size / 2u;
    let centre = all.nw + 18u * half;
    if !is_there(centre) {
        put_halves(atomicAdd(&listed, 2u), all, select(quarter_at(cell), quarter, whole));
        return;
    }
    let west = all.nw + 17u * half;
    let north = all.nw + half;
    let east = all.ne + 17u * half;
    let south = all.sw + half;
    let w = is_there(west);
    let n = is_there(north);
    let e = is_there(east);
    let s = is_there(south);
    // One at a whole side; at a halved one a half for each side beside it that is whole.
    var count = select(1u, select(1u, 0u, s) + select(1u, 0u, n), w);
    count += select(1u, select(1u, 0u, w) + select(1u, 0u, e), n);
    count += select(1u, select(1u, 0u, n) + select(1u, 0u, s), e);
    count += select(1u, select(1u, 0u, e) + select(1u, 0u, w), s);
    var at = atomicAdd(&listed, count);
    at = put_side(at, centre, all.sw, west, all.nw, w, s, n);
    at = put_side(at, centre, all.nw, north, all.ne, n, w, e);
    at = put_side(at, centre, all.ne, east, all.se, e, n, s);
    put_side(at, centre, all.se, south, all.sw, s, e, w);
}
