// Real elevation as a uniform bicubic B-spline through a grid of control heights, with relief of a few metres that
// the grid is too coarse for. Patches of 16 control points.
// Entity parameters: 0.x height of the relief in metres, 0.y length of its longest wave in metres.

#import dolomite::geometry::draw_types::{Shaded, Surface}
#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, entity_params, in_view, patch_point, stage_position}

fn point(input: Patch, k: u32) -> vec3<f32> {
    return stage_position(input, patch_point(input, k, 0u).xyz);
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    // The surface lies within its control points.
    var low = vec3(1e30);
    var high = vec3(-1e30);
    for (var k = 0u; k < 16u; k++) {
        let p = point(input, k);
        low = min(low, p);
        high = max(high, p);
    }
    if !in_view(view, (low + high) * 0.5, distance(low, high) * 0.5) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    let a = point(input, 5u);
    let b = point(input, 6u);
    let c = point(input, 10u);
    let d = point(input, 9u);
    let outer = vec4(edge_level(view, d, a), edge_level(view, a, b), edge_level(view, b, c), edge_level(view, c, d));
    return PatchLevels(max(outer, vec4(1.0)), vec2(max(outer.y, outer.w), max(outer.x, outer.z)));
}

// Weights of four points of a uniform cubic B-spline, and of their slope.
fn weights(t: f32) -> vec4<f32> {
    let s = 1.0 - t;
    return vec4(s * s * s, 4.0 + 3.0 * t * t * (t - 2.0), 4.0 + 3.0 * s * s * (s - 2.0), t * t * t) / 6.0;
}

fn slopes(t: f32) -> vec4<f32> {
    let s = 1.0 - t;
    return vec4(-s * s, t * (3.0 * t - 4.0), s * (4.0 - 3.0 * s), t * t) * 0.5;
}

fn sum(input: Patch, u: vec4<f32>, v: vec4<f32>) -> vec3<f32> {
    var total = vec3(0.0);
    for (var row = 0u; row < 4u; row++) {
        let first = 4u * row;
        let along = patch_point(input, first, 0u).xyz * u.x + patch_point(input, first + 1u, 0u).xyz * u.y
            + patch_point(input, first + 2u, 0u).xyz * u.z + patch_point(input, first + 3u, 0u).xyz * u.w;
        total += along * v[row];
    }
    return total;
}

// Integer hash (Jarzynski and Olano 2020, pcg2d) of a lattice point, from -1 to 1.
fn lattice(cell: vec2<i32>) -> f32 {
    var v = vec2<u32>(cell) * 1664525u + 1013904223u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v ^= v >> vec2(16u);
    v.x += v.y * 1664525u;
    return f32(v.x >> 8u) * (2.0 / 16777215.0) - 1.0;
}

// Value noise and its slope: (slope, value).
fn noise(p: vec2<f32>) -> vec3<f32> {
    let cell = floor(p);
    let f = p - cell;
    let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let dw = 30.0 * f * f * (f * (f - 2.0) + 1.0);
    let at = vec2<i32>(cell);
    let a = lattice(at);
    let b = lattice(at + vec2(1, 0));
    let c = lattice(at + vec2(0, 1));
    let d = lattice(at + vec2(1, 1));
    let value = mix(mix(a, b, w.x), mix(c, d, w.x), w.y);
    return vec3(dw.x * mix(b - a, d - c, w.y), dw.y * mix(c - a, d - b, w.x), value);
}

fn relief(p: vec2<f32>, wave: f32) -> vec3<f32> {
    var total = vec3(0.0);
    var frequency = 1.0 / wave;
    var amplitude = 1.0;
    for (var k = 0u; k < 5u; k++) {
        let layer = noise(p * frequency + f32(k) * 31.0);
        total += amplitude * vec3(layer.xy * frequency, layer.z);
        frequency *= 2.03;
        amplitude *= 0.48;
    }
    return total;
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let base = sum(input, weights(at.x), weights(at.y));
    let along_u = sum(input, slopes(at.x), weights(at.y));
    let along_v = sum(input, weights(at.x), slopes(at.y));
    let given = entity_params(input, 0u);
    let rough = given.x * relief(base.xz, given.y);
    let normal = cross(along_v, along_u);
    var vertex: Vertex;
    vertex.position = base + vec3(0.0, rough.z, 0.0);
    vertex.normal = normal / max(normal.y, 1e-6) - vec3(rough.x, 0.0, rough.y);
    // For the material: height in km, and steepness.
    vertex.uv = vec2(vertex.position.y / 1000.0, length(vertex.normal.xz));
    vertex.previous = vertex.position;
    vertex.material = 0u;
    return vertex;
}

// Forest on what is flat, rock where it is steep, grass above.
fn material(surface: Surface) -> Shaded {
    let height = surface.uv.x;
    let steep = smoothstep(0.6, 1.1, surface.uv.y);
    let forest = mix(vec3(0.045, 0.075, 0.028), vec3(0.10, 0.115, 0.045), smoothstep(0.55, 0.85, height));
    let meadow = vec3(0.19, 0.185, 0.085);
    let green = mix(meadow, forest, smoothstep(0.28, 0.42, height + 0.25 * surface.uv.y));
    let rock = vec3(0.15, 0.13, 0.11);
    return Shaded(mix(green, rock, steep), vec3(0.0), surface.normal, 0.9, 0.0, 0.5, 1.0, false, true);
}
