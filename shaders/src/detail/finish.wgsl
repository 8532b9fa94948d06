// Arguments of the draws and what is reported, one thread; the words are those of the stage's head.

#import dolomite::detail::bindings::{counts, detail, COARSENING, LEFT, OTHERS, TRIANGLES, USED, VERTICES}
#import dolomite::detail::room::corner_count
#import dolomite::stage::work::{AMPLIFIED, INDEXED, OTHERS as HEAD_OTHERS, PLAIN, PRIMITIVES, SHARE, WANTED_PRIMITIVES, WANTED_VERTICES, WHOLE}

@group(1) @binding(0) var<storage, read_write> head: array<u32>;

// Words of the head that the stage leaves free.
const HEAD_COARSENING: u32 = 26u;
const HEAD_LEFT: u32 = 27u;
const HEAD_USED: u32 = 28u;

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
    head[12u] = vertices;
    head[PRIMITIVES] = triangles;
    head[WANTED_VERTICES] = vertices;
    head[WANTED_PRIMITIVES] = triangles + others;
    head[SHARE] = WHOLE;
    head[HEAD_COARSENING] = atomicLoad(&counts[COARSENING]);
    head[HEAD_LEFT] = atomicLoad(&counts[LEFT]);
    head[HEAD_USED] = atomicLoad(&counts[USED]);
}
