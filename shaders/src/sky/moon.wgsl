#define_import_path dolomite::sky::moon

// The moon: a sphere of triangle patches. Its seas lie where they lie, their shores, the craters and
// their rays are made by hashes. Local space: radius 1, +z towards the eye, +y north, +x east.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, in_view, patch_point, stage, stage_position}
#import dolomite::geometry::draw_types::{Shaded, Surface, geometry_draw}

struct MoonLight {
    // Exposed luminance of the highlands; w: exposed luminance of 1 in the map of the sky.
    shine: vec4<f32>,
}

@group(1) @binding(0) var<uniform> moon_light: MoonLight;
@group(1) @binding(1) var sky_map: texture_cube<f32>;
@group(1) @binding(2) var sky_sampler: sampler;

// The sphere is this many pixels larger than the moon: its rim fades over the last one.
const MARGIN: f32 = 1.5;
// Edges are so much shorter than the camera's wish: the rim is seen against the sky.
const FINER: f32 = 2.5;

const SEAS: u32 = 14u;
const RAYED: u32 = 6u;

fn sphere_point(input: Patch, k: u32) -> vec3<f32> {
    return stage_position(input, normalize(patch_point(input, k, 0u).xyz));
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let a = sphere_point(input, 0u);
    let b = sphere_point(input, 1u);
    let c = sphere_point(input, 2u);
    let centre = stage_position(input, vec3(0.0));
    // The patches of the far side lie in one half of the octahedron.
    let back = max(max(patch_point(input, 0u, 0u).z, patch_point(input, 1u, 0u).z), patch_point(input, 2u, 0u).z) <= 0.0;
    if back || !in_view(view, centre, 1.5 * distance(a, centre)) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    let u = FINER * edge_level(view, b, c);
    let v = FINER * edge_level(view, c, a);
    let w = FINER * edge_level(view, a, b);
    return PatchLevels(vec4(u, v, w, 1.0), vec2(max(u, max(v, w))));
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let p = patch_point(input, 0u, 0u).xyz * at.x + patch_point(input, 1u, 0u).xyz * at.y + patch_point(input, 2u, 0u).xyz * at.z;
    let n = normalize(p);
    let centre = stage_position(input, vec3(0.0));
    let pixels = distance(stage_position(input, n), centre) / distance(centre, stage.view.eye) * stage.view.pixels_per_radian;
    let out = n * (1.0 + MARGIN / max(pixels, 2.0));
    var vertex: Vertex;
    vertex.position = out;
    vertex.normal = n;
    // Place on the disc, 1 at its rim.
    vertex.uv = out.xy;
    vertex.previous = out;
    vertex.material = 0u;
    return vertex;
}

fn pcg(input: u32) -> u32 {
    let state = input * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn cell_hash(cell: vec3<i32>) -> u32 {
    let c = vec3<u32>(cell);
    return pcg(pcg(pcg(c.x) + c.y) + c.z);
}

fn unit(hash: u32) -> f32 {
    return f32(hash >> 8u) / 16777216.0;
}

fn value_noise(p: vec3<f32>) -> f32 {
    let base = floor(p);
    let f = p - base;
    let w = f * f * (3.0 - 2.0 * f);
    let cell = vec3<i32>(base);
    var sum = 0.0;
    for (var k = 0u; k < 8u; k++) {
        let corner = vec3(f32(k & 1u), f32((k >> 1u) & 1u), f32(k >> 2u));
        let part = mix(1.0 - w, w, corner);
        sum += part.x * part.y * part.z * unit(cell_hash(cell + vec3<i32>(corner)));
    }
    return sum;
}

fn fbm(p: vec3<f32>) -> f32 {
    return (value_noise(p) + 0.5 * value_noise(p * 2.0 + 17.0) + 0.25 * value_noise(p * 4.0 + 34.0) + 0.125 * value_noise(p * 8.0 + 51.0)) / 1.875;
}

// How much of a sea there is: place and radius of each, on the unit sphere.
fn seas(n: vec3<f32>) -> f32 {
    var places = array<vec4<f32>, 14>(
        vec4(-0.231, 0.545, 0.806, 0.33), // Imbrium
        vec4(0.258, 0.469, 0.844, 0.20), // Serenitatis
        vec4(0.510, 0.139, 0.849, 0.24), // Tranquillitatis
        vec4(0.820, 0.292, 0.492, 0.14), // Crisium
        vec4(0.770, -0.139, 0.623, 0.20), // Fecunditatis
        vec4(0.554, -0.259, 0.791, 0.11), // Nectaris
        vec4(-0.798, 0.309, 0.518, 0.32), // Procellarum
        vec4(-0.707, 0.035, 0.707, 0.22),
        vec4(-0.259, -0.342, 0.903, 0.19), // Nubium
        vec4(-0.575, -0.407, 0.710, 0.12), // Humorum
        vec4(-0.019, 0.839, 0.544, 0.12), // Frigoris
        vec4(0.236, 0.829, 0.507, 0.09),
        vec4(0.068, 0.225, 0.972, 0.08), // Vaporum
        vec4(-0.466, 0.122, 0.876, 0.14), // Insularum
    );
    let shore = 0.9 * (fbm(n * 6.0) - 0.5);
    var sea = 0.0;
    for (var k = 0u; k < SEAS; k++) {
        let away = distance(n, places[k].xyz) / (1.2 * places[k].w) + shore;
        sea = max(sea, 1.0 - smoothstep(0.75, 1.1, away));
    }
    return sea;
}

// Bright young craters and their rays.
fn rays(n: vec3<f32>) -> f32 {
    var places = array<vec4<f32>, 6>(
        vec4(-0.140, -0.682, 0.718, 0.42), // Tycho
        vec4(-0.337, 0.174, 0.925, 0.16), // Copernicus
        vec4(-0.610, 0.139, 0.780, 0.10), // Kepler
        vec4(-0.668, 0.407, 0.624, 0.09), // Aristarchus
        vec4(0.703, 0.276, 0.656, 0.08), // Proclus
        vec4(0.864, -0.156, 0.480, 0.09), // Langrenus
    );
    var light = 0.0;
    for (var k = 0u; k < RAYED; k++) {
        let from_it = n - places[k].xyz;
        let away = length(from_it);
        let ray = value_noise(from_it / max(away, 1e-4) * 5.0 + f32(k) * 9.0);
        let core = exp(-away * away / (0.012 * places[k].w));
        light += core + exp(-away / places[k].w) * smoothstep(0.5, 0.85, ray);
    }
    return min(light, 1.0);
}

// Bowls with rims, one in every second cell of a grid; heights in their radii.
fn bowls(n: vec3<f32>, frequency: f32) -> f32 {
    let p = n * frequency;
    let base = vec3<i32>(floor(p));
    var height = 0.0;
    for (var k = 0; k < 27; k++) {
        let cell = base + vec3(k % 3 - 1, (k / 3) % 3 - 1, k / 9 - 1);
        let h = cell_hash(cell);
        let centre = vec3<f32>(cell) + vec3(unit(h), unit(pcg(h)), unit(pcg(h + 1u)));
        let radius = 0.15 + 0.35 * unit(pcg(h + 2u)) * unit(pcg(h + 3u));
        let away = distance(p, centre) / radius;
        let bowl = min(away * away, 1.6 - 0.6 * away) - 1.0;
        height += select(0.0, radius * select(bowl, max(1.0 - abs(away - 1.0) * 2.5, 0.0) * 0.4, away > 1.0), (h & 1u) == 0u && away < 1.4);
    }
    return height / frequency;
}

fn relief(n: vec3<f32>) -> f32 {
    return bowls(n, 7.0) + bowls(n, 17.0) + 0.02 * fbm(n * 24.0);
}

fn material(surface: Surface) -> Shaded {
    let disc = surface.uv;
    let away = length(disc);
    // One pixel of rim.
    let step_size = max(length(vec2(length(dpdx(disc)), length(dpdy(disc)))) * 0.7071, 1e-6);
    let covered = clamp((1.0 - away) / step_size + 0.5, 0.0, 1.0);
    let inside = disc * min(1.0, 0.999 / max(away, 1e-6));
    let n = vec3(inside, sqrt(max(1.0 - dot(inside, inside), 0.0)));
    let sea = seas(n);
    let ground = mix(0.95, 0.30, sea) * (0.86 + 0.28 * fbm(n * 18.0));
    let albedo = mix(ground, 1.05, 0.55 * rays(n));
    // Light from the west of its sky, as far from the eye as lets the craters throw no shadows: the
    // disc of a full moon is as bright at its rim as in its middle, slopes alone differ.
    let east = normalize(vec3(n.z, 0.0, -n.x) + vec3(1e-4, 0.0, 0.0));
    let small = 0.006;
    let slope = (relief(normalize(n + east * small)) - relief(normalize(n - east * small))) / (2.0 * small);
    let lit = clamp(1.0 + 0.5 * slope * (1.0 - 0.6 * sea), 0.6, 1.35) * mix(0.82, 1.0, n.z);
    let direction = normalize(surface.position - geometry_draw.camera);
    // Cube maps are left-handed.
    let sky = textureSampleLevel(sky_map, sky_sampler, direction * vec3(1.0, 1.0, -1.0), 0.0).xyz;
    let seen = sky * moon_light.shine.w + moon_light.shine.xyz * albedo * lit * covered;
    return Shaded(seen, vec3(0.0), surface.normal, 1.0, 0.0, 0.0, 1.0, true, false);
}
