// Arguments of the draws and what is reported, one thread.

#import dolomite::blocks::bindings::{CANDIDATES, COARSENING, CURVE, DRAWN, LEFT, MADE, OTHERS, TRIANGLES, VERTICES, WISHES}
#import dolomite::blocks::stock::stock
#import dolomite::detail::bindings::{counts, detail}
#import dolomite::geometry::head::{AMPLIFIED, INDEXED, OTHERS as HEAD_OTHERS, PLAIN, PRIMITIVES, VERTICES as HEAD_VERTICES, WANTED_PRIMITIVES, WANTED_VERTICES}

@group(1) @binding(0) var<storage, read_write> head: array<u32>;

// Own words of the head: see layout.rs.
const HEAD_COARSENING: u32 = 24u;
const HEAD_LEFT: u32 = 25u;
const HEAD_USED: u32 = 26u;
const HEAD_WISHES: u32 = 27u;
const HEAD_MADE: u32 = 28u;
const HEAD_CANDIDATES: u32 = 29u;
const HEAD_DRAWN: u32 = 30u;
const HEAD_STAMP: u32 = 31u;
const HEAD_CURVE: u32 = 32u;
const HEAD_CURVE_COUNT: u32 = 8u;

@compute @workgroup_size(1)
fn finish() {
    let vertices = min(atomicLoad(&counts[VERTICES]), detail.max_vertices);
    let triangles = min(atomicLoad(&counts[TRIANGLES]), detail.max_triangles);
    let others = min(atomicLoad(&counts[OTHERS]), detail.max_triangles - triangles);
    head[HEAD_OTHERS] = 3u * others;
    head[HEAD_OTHERS + 1u] = 1u;
    head[HEAD_OTHERS + 2u] = 3u * (detail.max_triangles - others);
    head[INDEXED] = 3u * triangles;
    head[INDEXED + 1u] = 1u;
    head[AMPLIFIED] = 3u;
    head[AMPLIFIED + 1u] = triangles;
    head[PLAIN] = 3u * triangles;
    head[PLAIN + 1u] = 1u;
    head[HEAD_VERTICES] = vertices;
    head[PRIMITIVES] = triangles;
    head[WANTED_VERTICES] = atomicLoad(&counts[VERTICES]);
    head[WANTED_PRIMITIVES] = atomicLoad(&counts[TRIANGLES]) + atomicLoad(&counts[OTHERS]);
    head[HEAD_COARSENING] = atomicLoad(&counts[COARSENING]);
    head[HEAD_LEFT] = atomicLoad(&counts[LEFT]);
    // The first slot is no block.
    head[HEAD_USED] = stock.used - 1u - atomicLoad(&stock.free);
    head[HEAD_WISHES] = atomicLoad(&counts[WISHES]);
    head[HEAD_MADE] = atomicLoad(&counts[MADE]);
    head[HEAD_CANDIDATES] = atomicLoad(&counts[CANDIDATES]);
    head[HEAD_DRAWN] = atomicLoad(&counts[DRAWN]);
    head[HEAD_STAMP] = detail.stamp;
    for (var k = 0u; k < HEAD_CURVE_COUNT; k++) {
        head[HEAD_CURVE + k] = atomicLoad(&counts[CURVE + k]);
    }
}
