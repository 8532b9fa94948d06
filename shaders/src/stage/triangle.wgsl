#define_import_path dolomite::stage::triangle

// How a triangle is stored, by the pool's vertices.

#import dolomite::stage::api::stage

@group(0) @binding(5) var<storage, read_write> indices: array<u32>;

fn store_triangle(index: u32, vertex: vec3<u32>) {
#ifdef STAGE_CLOCKWISE
    let turned = vertex.xzy;
#else
    let turned = vertex;
#endif
    // A patch that the vertex pool does not hold is drawn as points.
    let held = max(max(turned.x, turned.y), turned.z) < stage.max_vertices;
    indices[3u * index] = select(0u, turned.x, held);
    indices[3u * index + 1u] = select(0u, turned.y, held);
    indices[3u * index + 2u] = select(0u, turned.z, held);
}
