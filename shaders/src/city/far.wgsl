#define_import_path dolomite::city::far

// Buildings and hedges beyond the patches: a record each, drawn as a prism with a truncated pyramid, 18 triangles.
// Control point 0: middle (x, z) and halves of the size; 1: height of the eaves and of the roof, how far its top
// stands back, material. Entity parameter 0: the cell that the entity's corner is that of.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, entity_params, in_view, patch_point, stage_position}
#import dolomite::geometry::amplify_types::StoredVertex
#import dolomite::geometry::draw_types::{Shaded, Surface, geometry_draw}
#import dolomite::city::types::{CityParams, TILES, LEAVES}
#import dolomite::city::shade::{Seen, shade}

@group(1) @binding(0) var<uniform> city: CityParams;
// Cells whose blocks are patches: least column and row, greatest ones.
@group(1) @binding(1) var<uniform> near_cells: vec4<i32>;

fn control(input: Patch, view: StageView) -> PatchLevels {
    let plan = patch_point(input, 0u, 0u);
    let size = patch_point(input, 1u, 0u);
    let cell = vec2<i32>(entity_params(input, 0u).xy) + vec2<i32>(floor(plan.xy / city.plan.x));
    let is_near = all(cell >= near_cells.xy) && all(cell <= near_cells.zw);
    let height = size.x + size.y;
    let middle = stage_position(input, vec3(plan.x, 0.5 * height, plan.y));
    let radius = length(vec3(plan.z, 0.5 * height, plan.w));
    if is_near || !in_view(view, middle, radius) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    return PatchLevels(vec4(1.0), vec2(1.0));
}

// Two vertices hold the record: the lower one half of the size, the upper one the roof.
fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let plan = patch_point(input, 0u, 0u);
    let size = patch_point(input, 1u, 0u);
    let upper = at.x > 0.5;
    var vertex: Vertex;
    vertex.position = vec3(plan.x, select(0.0, size.x, upper), plan.y);
    vertex.normal = vec3(0.0, 1.0, 0.0);
    vertex.uv = select(plan.zw, size.yz, upper);
    vertex.previous = vertex.position;
    vertex.material = u32(size.w);
    return vertex;
}

// Corner of a square by number, counter-clockwise seen from above, from the north-west: -1 and 1.
fn square(k: u32) -> vec2<f32> {
    return vec2(select(-1.0, 1.0, (k & 3u) == 1u || (k & 3u) == 2u), select(-1.0, 1.0, (k & 3u) < 2u));
}

// Foot, eaves or top (0, 1, 2) of corner k.
fn record_point(low: StoredVertex, high: StoredVertex, ring: u32, k: u32) -> vec3<f32> {
    let inset = select(0.0, high.uv.y, ring == 2u);
    let at = square(k) * (low.uv - vec2(inset));
    let up = select(0.0, high.position.y - low.position.y, ring > 0u) + select(0.0, high.uv.x, ring == 2u);
    return low.position + vec3(at.x, up, at.y);
}

// 0 to 23 walls, 24 to 47 slopes, 48 to 53 the top.
fn amplify(a: StoredVertex, b: StoredVertex, c: StoredVertex, number: u32) -> StoredVertex {
    let corner = number % 6u;
    // (0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1).
    let right = corner == 1u || corner == 2u || corner == 4u;
    let above = corner == 2u || corner == 4u || corner == 5u;
    var made = a;
    if number >= 48u {
        let k = select(select(0u, 1u, right), select(3u, 2u, right), above);
        made.position = record_point(a, b, 2u, k);
        made.normal = vec3(0.0, 1.0, 0.0);
    } else {
        let side = (number / 6u) & 3u;
        let ring = number / 24u;
        made.position = record_point(a, b, ring + u32(above), side + u32(right));
        let p0 = record_point(a, b, ring, side);
        let along = record_point(a, b, ring, side + 1u) - p0;
        let out = cross(along, record_point(a, b, ring + 1u, side) - p0);
        // A record without a roof has slopes without area.
        made.normal = select(vec3(0.0, 1.0, 0.0), out / max(length(out), 1e-20), dot(out, out) > 0.0);
        made.uv = vec2(select(0.0, length(along), right), 0.0);
    }
    made.previous = made.position;
    let walls = number < 24u || (a.material & 7u) == LEAVES;
    made.material = select((a.material & 0xf8u) | TILES, a.material, walls);
    return made;
}

fn material(surface: Surface) -> Shaded {
    let world = surface.position + geometry_draw.anchor;
    let away = distance(surface.position, geometry_draw.camera);
    let pixel = length(fwidth(world)) * 0.7;
    let ray = (surface.position - geometry_draw.camera) / max(away, 1e-6);
    return shade(city, Seen(surface.material, world, ray, away, surface.normal, surface.normal, surface.uv, 0.5, 0.0, pixel));
}
