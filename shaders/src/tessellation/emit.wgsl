// Pass 3: writes vertices and indices where `plan` placed them. A workgroup a patch (its inner
// vertices and its triangles), then a workgroup an edge (its inner vertices), then one for 64
// corners.

#import dolomite::terrain::fixed::{GroundPoint, ground_offset, ground_relative, ground_difference}
#import dolomite::terrain::height::terrain_height
#import dolomite::tessellation::types::{Corner, Edge, Patch, ViewParams, NONE}
#import dolomite::tessellation::pattern::{INNER, patch_triangle, triangle_count, side_level}

@group(0) @binding(0) var<uniform> view: ViewParams;
@group(0) @binding(1) var<storage, read> corners: array<Corner>;
@group(0) @binding(2) var<storage, read> edges: array<Edge>;
@group(0) @binding(3) var<storage, read> patches: array<Patch>;
// Position relative to the anchor, then the gradient as two f16.
@group(0) @binding(4) var<storage, read_write> vertices: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> indices: array<u32>;

const THREADS: u32 = 64u;

fn put(index: u32, at: GroundPoint) {
    if index >= view.max_vertices {
        return;
    }
    let height = terrain_height(at);
    let relative = ground_relative(at, view.anchor);
    // 65504: the greatest finite f16; the built-in is undefined beyond it.
    let gradient = pack2x16float(clamp(height.yz, vec2(-65504.0), vec2(65504.0)));
    vertices[index] = vec4(relative.x, height.x, relative.y, bitcast<f32>(gradient));
}

fn corner_point(id: u32) -> GroundPoint {
    return GroundPoint(corners[id].cell, corners[id].frac);
}

fn emit_corner(id: u32) {
    if id < view.corner_count && corners[id].vertex != NONE {
        put(corners[id].vertex, corner_point(id));
    }
}

fn emit_edge(id: u32, thread: u32) {
    let level = edges[id].level;
    let i = thread + 1u;
    if i >= level {
        return;
    }
    let a = corner_point(edges[id].corners.x);
    let length = ground_difference(corner_point(edges[id].corners.y), a);
    put(edges[id].vertex + thread, ground_offset(a, length * (f32(i) / f32(level))));
}

fn patch_side(id: u32, s: u32) -> vec2<u32> {
    let second = patches[id].edges[2u * s + 1u];
    var side = vec2(edges[patches[id].edges[2u * s]].level, 0u);
    if second != NONE {
        side.y = edges[second].level;
    }
    return side;
}

// Index in the pool of a vertex of patch `id`; `v` as in pattern.wgsl.
fn vertex_index(id: u32, inner: vec2<u32>, v: vec3<u32>) -> u32 {
    if v.x == INNER {
        return patches[id].vertex + (v.z - 1u) * (inner.x - 1u) + v.y - 1u;
    }
    var edge = patches[id].edges[2u * v.x];
    var i = v.y;
    if i > edges[edge].level {
        i -= edges[edge].level;
        edge = patches[id].edges[2u * v.x + 1u];
    }
    if i == 0u {
        return corners[edges[edge].corners.x].vertex;
    }
    if i == edges[edge].level {
        return corners[edges[edge].corners.y].vertex;
    }
    return edges[edge].vertex + i - 1u;
}

fn emit_patch(id: u32, thread: u32) {
    if patches[id].visible == 0u {
        return;
    }
    let inner = vec2(patches[id].inner & 0xffffu, patches[id].inner >> 16u);
    let a = corner_point(patches[id].corners.x);
    let size = ground_difference(corner_point(patches[id].corners.w), a);
    let columns = inner.x - 1u;
    let count = columns * (inner.y - 1u);
    for (var k = thread; k < count; k += THREADS) {
        let place = vec2(k % columns, k / columns) + 1u;
        put(patches[id].vertex + k, ground_offset(a, size * (vec2<f32>(place) / vec2<f32>(inner))));
    }
    let sides = array(patch_side(id, 0u), patch_side(id, 1u), patch_side(id, 2u), patch_side(id, 3u));
    let levels = vec4(side_level(sides[0]), side_level(sides[1]), side_level(sides[2]), side_level(sides[3]));
    let triangles = triangle_count(levels, inner);
    for (var t = thread; t < triangles; t += THREADS) {
        let place = patches[id].triangle + t;
        if place < view.max_triangles {
            let v = patch_triangle(sides, inner, t);
            indices[3u * place] = vertex_index(id, inner, v[0]);
            indices[3u * place + 1u] = vertex_index(id, inner, v[1]);
            indices[3u * place + 2u] = vertex_index(id, inner, v[2]);
        }
    }
}

@compute @workgroup_size(64)
fn emit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    // A grid of 32768 columns: a dispatch allows 65535 groups along one axis.
    let item = group.x + group.y * 32768u;
    if item < view.patch_count {
        emit_patch(item, thread);
        return;
    }
    let edge = item - view.patch_count;
    if edge < view.edge_count {
        emit_edge(edge, thread);
        return;
    }
    emit_corner((edge - view.edge_count) * THREADS + thread);
}
