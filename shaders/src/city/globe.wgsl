#define_import_path dolomite::city::globe

// Globes of lamps: spheres from octahedra of eight triangles. Control point: centre; the number of the octahedron's
// corner (twice the axis, plus one on its negative side) plus eight times the radius in millimetres. The CPU
// reference of the level: plugins/city/src/tube.rs.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, in_view, patch_point, stage_position}
#import dolomite::geometry::draw_types::{Shaded, Surface}
#import dolomite::city::types::CityParams

@group(1) @binding(0) var<uniform> city: CityParams;

fn globe_radius(point: vec4<f32>) -> f32 {
    return f32(u32(point.w) / 8u) * 0.001;
}

fn globe_corner(point: vec4<f32>) -> vec3<f32> {
    let number = u32(point.w) % 8u;
    let side = select(1.0, -1.0, number % 2u == 1u);
    return side * vec3(f32(number / 2u == 0u), f32(number / 2u == 1u), f32(number / 2u == 2u));
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let point = patch_point(input, 0u, 0u);
    let centre = stage_position(input, point.xyz);
    let radius = globe_radius(point);
    if !in_view(view, centre, radius) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    let away = max(distance(centre, view.eye) - radius, 0.05);
    let n = clamp(sqrt(radius * view.pixels_per_radian / (city.relief.x * away)), 1.0, 64.0);
    return PatchLevels(vec4(n), vec2(n));
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let a = patch_point(input, 0u, 0u);
    let p = globe_corner(a) * at.x + globe_corner(patch_point(input, 1u, 0u)) * at.y + globe_corner(patch_point(input, 2u, 0u)) * at.z;
    var vertex: Vertex;
    vertex.normal = normalize(p);
    vertex.position = a.xyz + vertex.normal * globe_radius(a);
    vertex.uv = at.xy;
    vertex.previous = vertex.position;
    vertex.material = 0u;
    return vertex;
}

fn material(surface: Surface) -> Shaded {
    return Shaded(vec3(0.7, 0.68, 0.62), city.lamps.xyz * city.lamps.w, surface.normal, 0.25, 0.0, 0.5, 1.0, false, true);
}
