// A sphere displaced by noise: triangle patches of an octahedron.
// Entity parameters: 0.y displacement in radii, 0.z waves around it.

#import dolomite::geometry::draw_types::{Shaded, Surface}
#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, entity_params, in_view, patch_point, stage_position}

// Integer hash (Jarzynski and Olano 2020, pcg3d), one gradient of length about 1 for a lattice point.
fn gradient(cell: vec3<i32>) -> vec3<f32> {
    var v = vec3<u32>(cell) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return vec3<f32>(v >> vec3(8u)) * (2.0 / 16777215.0) - 1.0;
}

// Gradient noise and its slope (Perlin 1985, with the quintic of 2002): (slope, value).
fn noise(p: vec3<f32>) -> vec4<f32> {
    let cell = floor(p);
    let f = p - cell;
    let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let dw = 30.0 * f * f * (f * (f - 2.0) + 1.0);
    var value = 0.0;
    var slope = vec3(0.0);
    for (var k = 0u; k < 8u; k++) {
        let corner = vec3(f32(k & 1u), f32((k >> 1u) & 1u), f32(k >> 2u));
        let g = gradient(vec3<i32>(cell + corner));
        let d = dot(g, f - corner);
        let s = select(1.0 - w, w, corner == vec3(1.0));
        let ds = select(-dw, dw, corner == vec3(1.0));
        value += s.x * s.y * s.z * d;
        slope += s.x * s.y * s.z * g + d * vec3(ds.x * s.y * s.z, s.x * ds.y * s.z, s.x * s.y * ds.z);
    }
    return vec4(slope, value);
}

// Eight octaves; each is as steep as the one before is rough.
fn relief(n: vec3<f32>, waves: f32) -> vec4<f32> {
    var sum = vec4(0.0);
    var amplitude = 1.0;
    var frequency = waves;
    for (var k = 0u; k < 8u; k++) {
        let layer = noise(n * frequency + f32(k) * 17.0);
        sum += amplitude * vec4(layer.xyz * frequency, layer.w);
        frequency *= 2.03;
        amplitude *= 0.47;
    }
    return sum;
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let a = normalize(patch_point(input, 0u, 0u).xyz);
    let b = normalize(patch_point(input, 1u, 0u).xyz);
    let c = normalize(patch_point(input, 2u, 0u).xyz);
    let centre = stage_position(input, vec3(0.0));
    let reach = distance(stage_position(input, a), centre) * (1.0 + 1.5 * entity_params(input, 0u).y);
    if !in_view(view, centre, reach) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    let pa = stage_position(input, a);
    let pb = stage_position(input, b);
    let pc = stage_position(input, c);
    let u = 1.4 * edge_level(view, pb, pc);
    let v = 1.4 * edge_level(view, pc, pa);
    let w = 1.4 * edge_level(view, pa, pb);
    return PatchLevels(vec4(u, v, w, 1.0), vec2(max(u, max(v, w))));
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let p = patch_point(input, 0u, 0u).xyz * at.x + patch_point(input, 1u, 0u).xyz * at.y + patch_point(input, 2u, 0u).xyz * at.z;
    let n = normalize(p);
    let given = entity_params(input, 0u);
    let height = relief(n, given.z);
    var vertex: Vertex;
    let radius = 1.0 + given.y * height.w;
    vertex.position = n * radius;
    // The part of the slope along the sphere tilts the normal.
    let tangent = height.xyz - n * dot(height.xyz, n);
    vertex.normal = n * radius - given.y * tangent;
    // For the material: height and steepness.
    vertex.uv = vec2(height.w, given.y * length(tangent));
    vertex.previous = vertex.position;
    vertex.material = 0u;
    return vertex;
}

// Dark rock where it is steep or low, sand between, ice on the heights.
fn material(surface: Surface) -> Shaded {
    let steep = smoothstep(0.25, 0.6, surface.uv.y);
    let ice = smoothstep(0.22, 0.3, surface.uv.x) * (1.0 - 0.8 * steep);
    let ground = mix(vec3(0.20, 0.13, 0.08), vec3(0.075, 0.06, 0.055), max(steep, smoothstep(0.1, -0.4, surface.uv.x)));
    let colour = mix(ground, vec3(0.72, 0.76, 0.8), ice);
    return Shaded(colour, vec3(0.0), surface.normal, mix(0.95, 0.45, ice), 0.0, 0.5, 1.0, false, true);
}
