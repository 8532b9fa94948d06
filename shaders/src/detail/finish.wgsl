// Arguments of the draws and what is reported, one thread.

#import dolomite::detail::bindings::{counts, detail, COARSENING, LEFT, OTHERS, TRIANGLES, VERTICES}
#import dolomite::detail::room::corner_count
#import dolomite::detail::stock::cells_in_use
#import dolomite::geometry::head::{AMPLIFIED, INDEXED, OTHERS as HEAD_OTHERS, PLAIN, PRIMITIVES, VERTICES as HEAD_VERTICES, WANTED_PRIMITIVES, WANTED_VERTICES}

@group(1) @binding(0) var<storage, read_write> head: array<u32>;

// The level of detail's own words of the head.
const HEAD_COARSENING: u32 = 24u;
const HEAD_LEFT: u32 = 25u;
const HEAD_USED: u32 = 26u;

@compute @workgroup_size(1)
fn finish() {
    let vertices = min(corner_count() + atomicLoad(&counts[VERTICES]), detail.max_vertices);
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
    head[WANTED_VERTICES] = vertices;
    head[WANTED_PRIMITIVES] = triangles + others;
    head[HEAD_COARSENING] = atomicLoad(&counts[COARSENING]);
    head[HEAD_LEFT] = atomicLoad(&counts[LEFT]);
    head[HEAD_USED] = cells_in_use();
}
