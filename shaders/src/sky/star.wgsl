#define_import_path dolomite::sky::star

// Stars on a dome about the camera: octahedra of eight triangle patches, never refined.
//
// A control point holds the direction of its star (of length 1, the entity's scale is the radius of
// the dome) and, in w, the star's class times eight plus the number of the octahedron's corner: twice
// the axis, plus one on its negative side. The class is its magnitude (32 classes) times eight plus
// its colour.
//
// A star is much smaller than a pixel. Its octahedron is as large as the disc that a camera's lens
// would draw, some pixels in any view; the light falls off inside it, so that what all pixels get
// together is the star's light wherever it stands between them. It does not flicker when the camera
// turns, and its edge is not seen.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, in_view, patch_point, stage, stage_position}
#import dolomite::geometry::draw_types::{Shaded, Surface, geometry_draw}

struct StarLight {
    // Exposed illuminance of a star of magnitude 0, for each class of colour.
    colours: array<vec4<f32>, 8>,
    // Optical depth of the air above; w: exposed luminance of 1 in the map of the sky.
    depth: vec4<f32>,
}

@group(1) @binding(0) var<uniform> star_light: StarLight;
@group(1) @binding(1) var sky_map: texture_cube<f32>;
@group(1) @binding(2) var sky_sampler: sampler;

const PI: f32 = 3.14159265;

fn class_magnitude(class_number: u32) -> f32 {
    return -1.5 + 8.0 * f32(class_number / 8u) / 31.0;
}

// Radius of the disc, pixels: bright stars spread.
fn disc_radius(magnitude: f32) -> f32 {
    return mix(2.3, 1.2, smoothstep(-1.5, 4.0, magnitude));
}

// Radius of the octahedron, pixels: its outline is a square on a corner, which holds the disc.
fn outline_radius(magnitude: f32) -> f32 {
    return 1.41421356 * disc_radius(magnitude);
}

fn star_class(point: vec4<f32>) -> u32 {
    return u32(point.w) / 8u;
}

// Corner of the octahedron: x and y across the line of sight, z towards the eye.
fn corner_offset(point: vec4<f32>) -> vec3<f32> {
    let number = u32(point.w) % 8u;
    let side = select(1.0, -1.0, number % 2u == 1u);
    return side * vec3(f32(number / 2u == 0u), f32(number / 2u == 1u), f32(number / 2u == 2u));
}

// Radius of the octahedron on a dome of radius 1.
fn star_radius(point: vec4<f32>) -> f32 {
    return outline_radius(class_magnitude(star_class(point))) / stage.view.pixels_per_radian;
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let a = patch_point(input, 0u, 0u);
    let b = patch_point(input, 1u, 0u);
    let c = patch_point(input, 2u, 0u);
    // Half of the faces look away from the eye: they hold the corner at the back.
    let back = min(min(corner_offset(a).z, corner_offset(b).z), corner_offset(c).z) < 0.0;
    let centre = stage_position(input, a.xyz);
    let radius = distance(centre, stage_position(input, a.xyz * (1.0 + star_radius(a))));
    if back || a.y < 0.0 || !in_view(view, centre, radius) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    return PatchLevels(vec4(1.0), vec2(1.0));
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let a = patch_point(input, 0u, 0u);
    let offset = corner_offset(a) * at.x + corner_offset(patch_point(input, 1u, 0u)) * at.y + corner_offset(patch_point(input, 2u, 0u)) * at.z;
    let towards_eye = -a.xyz;
    // Any axis that does not point along the line of sight.
    let aside = select(vec3(0.0, 1.0, 0.0), vec3(1.0, 0.0, 0.0), abs(a.y) > 0.7);
    let right = normalize(cross(aside, towards_eye));
    let up = cross(towards_eye, right);
    var vertex: Vertex;
    vertex.position = a.xyz + star_radius(a) * (right * offset.x + up * offset.y + towards_eye * offset.z);
    vertex.normal = towards_eye;
    vertex.uv = offset.xy;
    vertex.previous = vertex.position;
    vertex.material = star_class(a);
    return vertex;
}

// Share of the light of the zenith's air that is passed at a sine of elevation: 40 times as much air
// at the horizon (Rozenberg 1966).
fn through_air(sine: f32) -> vec3<f32> {
    let height = max(sine, 0.0);
    return exp(-star_light.depth.xyz / (height + 0.025 * exp(-11.0 * height)));
}

fn material(surface: Surface) -> Shaded {
    let direction = normalize(surface.position - geometry_draw.camera);
    // What a pixel covers, in the sky and of the octahedron's outline.
    let solid_angle = length(cross(dpdx(direction), dpdy(direction)));
    let along = dpdx(surface.uv);
    let down = dpdy(surface.uv);
    let magnitude = class_magnitude(surface.material);
    let radius = disc_radius(magnitude);
    let pixels = outline_radius(magnitude);
    let covered = abs(along.x * down.y - along.y * down.x) * pixels * pixels;
    // A disc that fades towards its rim; its integral over the plane is 1.
    let rim = max(1.0 - dot(surface.uv, surface.uv) * pixels * pixels / (radius * radius), 0.0);
    let share = 3.0 / (PI * radius * radius) * rim * rim * covered;
    let colour = star_light.colours[surface.material % 8u].xyz;
    let light = colour * pow(10.0, -0.4 * magnitude) * through_air(direction.y);
    // Cube maps are left-handed.
    let sky = textureSampleLevel(sky_map, sky_sampler, direction * vec3(1.0, 1.0, -1.0), 0.0).xyz;
    let seen = sky * star_light.depth.w + light * share / max(solid_angle, 1e-12);
    return Shaded(seen, vec3(0.0), surface.normal, 1.0, 0.0, 0.0, 1.0, true, false);
}
