#define_import_path dolomite::classic::functions

// The classic scene: levels by distance and relief, a bilinear surface, colour by height. CPU reference:
// lab/classic/src/functions.rs.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, edge_level, entity_params, patch_point, stage_position}
#import dolomite::geometry::draw_types::{Shaded, Surface}
#import dolomite::classic::look::{coloured, lit}

// 1024 x 1024 samples, row by row; a storage buffer, because the weights of filtered textures have
// no more than 8 bits.
@group(1) @binding(0) var<storage, read> heights: array<f32>;

const SAMPLES: i32 = 1024;
const SCALE: f32 = 100.0;
const REACH: f32 = 400.0;
const RELIEF: f32 = 10.0;
const GREATEST: f32 = 32.0;

// Level of an edge between two points of the stage; `ground` is the height 0 there.
fn classic_level(a: vec3<f32>, b: vec3<f32>, ground: f32, eye: vec3<f32>) -> f32 {
    let middle = (a + b) * 0.5;
    let away = distance(vec3(middle.x, ground, middle.z), eye);
    let relief = clamp(abs(a.y - b.y) / RELIEF, 0.0, 1.0);
    let share = 0.6 * away / REACH + 0.4 * (1.0 - relief);
    return select(GREATEST + (1.0 - GREATEST) * share, 1.0, away > REACH);
}

fn level_between(view: StageView, rule: f32, ground: f32, a: vec3<f32>, b: vec3<f32>) -> f32 {
    if rule == 1.0 {
        return edge_level(view, a, b);
    }
    return classic_level(a, b, ground, view.eye);
}

// Whether a box meets the frustum.
fn seen(view: StageView, low: vec3<f32>, high: vec3<f32>) -> bool {
    var inside = true;
    for (var k = 0u; k < 6u; k++) {
        let plane = view.planes[k];
        let farthest = select(low, high, plane.xyz >= vec3(0.0));
        inside = inside && dot(plane.xyz, farthest) + plane.w >= 0.0;
    }
    return inside;
}

// Parameter 0 of the entity: rule (0 classic, 1 length on the screen, 2 the same everywhere), level of
// rule 2, whether patches outside of the frustum are left out.
fn control(input: Patch, view: StageView) -> PatchLevels {
    let rule = entity_params(input, 0u);
    let a = stage_position(input, patch_point(input, 0u, 0u).xyz);
    let b = stage_position(input, patch_point(input, 1u, 0u).xyz);
    let c = stage_position(input, patch_point(input, 2u, 0u).xyz);
    let d = stage_position(input, patch_point(input, 3u, 0u).xyz);
    let ground = stage_position(input, vec3(0.0)).y;
    if rule.z > 0.0 {
        let range = patch_point(input, 4u, 0u).xy + ground;
        if !seen(view, vec3(a.x, range.x, c.z), vec3(c.x, range.y, a.z)) {
            return PatchLevels(vec4(0.0), vec2(0.0));
        }
    }
    if rule.x == 2.0 {
        return PatchLevels(vec4(rule.y), vec2(rule.y));
    }
    let u_low = level_between(view, rule.x, ground, d, a);
    let v_low = level_between(view, rule.x, ground, a, b);
    let u_high = level_between(view, rule.x, ground, b, c);
    let v_high = level_between(view, rule.x, ground, c, d);
    return PatchLevels(vec4(u_low, v_low, u_high, v_high), vec2(max(v_low, v_high), max(u_low, u_high)));
}

// In texture coordinates: the light on the surface, and its height.
fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let low_corner = patch_point(input, 0u, 0u).xz;
    let high_corner = patch_point(input, 2u, 0u).xz;
    let place = low_corner + (high_corner - low_corner) * at.xy;
    // Sample i stands at i + 1/2 metres from the border at -512.
    let from_border = place + 511.5;
    let low = floor(from_border);
    let t = from_border - low;
    let column = vec2<i32>(i32(low.x), i32(low.x) + 1) & vec2(SAMPLES - 1);
    let row = (vec2<i32>(i32(low.y), i32(low.y) + 1) & vec2(SAMPLES - 1)) * SAMPLES;
    let a = SCALE * heights[row.x + column.x];
    let b = SCALE * heights[row.x + column.y];
    let c = SCALE * heights[row.y + column.x];
    let d = SCALE * heights[row.y + column.y];
    let near = a + (b - a) * t.x;
    let far = c + (d - c) * t.x;
    let along_x = (b - a) + ((d - c) - (b - a)) * t.y;
    let along_z = (c - a) + ((d - b) - (c - a)) * t.x;
    var vertex: Vertex;
    vertex.position = vec3(place.x, near + (far - near) * t.y, place.y);
    vertex.normal = vec3(-along_x, 1.0, -along_z);
    vertex.uv = lit(vertex.position, normalize(vertex.normal));
    vertex.previous = vertex.position;
    vertex.material = 0u;
    return vertex;
}

// Colour by height and the light of the vertices: not lit again.
fn material(surface: Surface) -> Shaded {
    return coloured(surface.normal, surface.uv.x, surface.uv.y);
}
