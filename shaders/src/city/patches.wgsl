#define_import_path dolomite::city::patches

// The patches of a city: ground, walls, roofs and hedges. Control points 0 to 3 are the corners with a mark, 4 to 7
// the patch's data. The CPU references: plugins/city/src/relief.rs and levels.rs.

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex, in_view, patch_point, stage_position}
#import dolomite::geometry::draw_types::{Shaded, Surface, geometry_draw}
#import dolomite::city::types::{CityParams, FAR, TILES, LEAVES}
#import dolomite::city::map::{MapSample, spline, texel_at, texel_place}
#import dolomite::city::relief::{PatchData, face_base, face_place}
#import dolomite::city::levels::{Corners, city_levels}
#import dolomite::city::shade::{Seen, shade, wall_right}

@group(1) @binding(0) var<uniform> city: CityParams;
// Four texels a word, map after map.
@group(1) @binding(1) var<storage, read> city_maps: array<u32>;

fn load_texel(x: i32, y: i32, number: u32) -> f32 {
    let at = texel_at(x, y, number, i32(city.relief.w));
    return f32((city_maps[at >> 2u] >> ((at & 3u) * 8u)) & 255u);
}

fn load_row(x: i32, y: i32, number: u32) -> vec3<f32> {
    return vec3(load_texel(x - 1, y, number), load_texel(x, y, number), load_texel(x + 1, y, number));
}

fn sample_map(at: vec2<f32>, number: u32) -> MapSample {
    let p = texel_place(at);
    let x = i32(p.x);
    let y = i32(p.y);
    return spline(mat3x3(load_row(x, y - 1, number), load_row(x, y, number), load_row(x, y + 1, number)), p.zw);
}

fn load_data(input: Patch) -> PatchData {
    return PatchData(patch_point(input, 4u, 0u), patch_point(input, 5u, 0u), patch_point(input, 6u, 0u), patch_point(input, 7u, 0u));
}

fn control(input: Patch, view: StageView) -> PatchLevels {
    let data = load_data(input);
    let at = Corners(
        stage_position(input, patch_point(input, 0u, 0u).xyz),
        stage_position(input, patch_point(input, 1u, 0u).xyz),
        stage_position(input, patch_point(input, 2u, 0u).xyz),
        stage_position(input, patch_point(input, 3u, 0u).xyz),
    );
    let middle = (at.a + at.b + at.c + at.d) * 0.25;
    let radius = max(max(distance(at.a, middle), distance(at.b, middle)), max(distance(at.c, middle), distance(at.d, middle)));
    if !in_view(view, middle, radius + data.map.z) {
        return PatchLevels(vec4(0.0), vec2(0.0));
    }
    if (u32(data.face.w) & 7u) == FAR {
        return PatchLevels(vec4(1.0), vec2(1.0));
    }
    let levels = city_levels(city, view.eye, view.pixels_per_radian, data, at);
    return PatchLevels(levels.outer, levels.inner);
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let data = load_data(input);
    let c0 = patch_point(input, 0u, 0u).xyz;
    let c1 = patch_point(input, 1u, 0u).xyz;
    let c2 = patch_point(input, 2u, 0u).xyz;
    let c3 = patch_point(input, 3u, 0u).xyz;
    let along = normalize(c1 - c0);
    let out = normalize(cross(along, c3 - c0));
    let up = cross(out, along);
    let place = face_place(data, city.relief.y, at.xy);
    let texels = city.relief.z;
    let found = sample_map(data.map.xy + place.at * texels, u32(data.map.w));
    let amplitude = data.face.z;
    let slope = amplitude * (found.slope * texels * place.share + found.height * place.by);
    var vertex: Vertex;
    vertex.position = face_base(c0, c1, c2, c3, at.xy) + out * (amplitude * (found.height * place.share));
    vertex.normal = out - along * slope.x - up * slope.y;
    vertex.uv = place.at;
    vertex.previous = vertex.position;
    vertex.material = u32(data.face.w);
    return vertex;
}

fn material(surface: Surface) -> Shaded {
    let world = surface.position + geometry_draw.anchor;
    let away = distance(surface.position, geometry_draw.camera);
    let kind = surface.material & 7u;
    let flat_ground = kind <= 2u || kind == FAR;
    // Walls and ground look along an axis; roofs have the normal of their vertices.
    var flat_normal = surface.normal;
    if flat_ground {
        flat_normal = vec3(0.0, 1.0, 0.0);
    } else if kind != TILES && kind != LEAVES {
        let along_x = abs(surface.normal.x) > abs(surface.normal.z);
        flat_normal = select(vec3(0.0, 0.0, sign(surface.normal.z)), vec3(sign(surface.normal.x), 0.0, 0.0), along_x);
    }
    let texels = city.relief.z;
    let on_map = select(surface.uv, vec2(world.x, -world.z), flat_ground) * texels;
    let footprint = length(fwidth(on_map));
    let pixel = length(fwidth(world)) * 0.7;
    // Gone where a pixel covers a stone.
    let detail = 1.0 - smoothstep(2.0, 8.0, footprint);
    var height = 0.5;
    var normal = flat_normal;
    let number = array<u32, 8>(0u, 1u, 5u, 2u, 3u, 4u, 5u, 5u)[kind];
    if detail > 0.0 && kind != FAR {
        let found = sample_map(on_map, number);
        height = found.height;
        if kind != TILES && kind != LEAVES {
            let right = select(wall_right(flat_normal), vec3(1.0, 0.0, 0.0), flat_ground);
            let up = cross(flat_normal, right);
            let steep = found.slope * (texels * city.heights[kind / 4u][kind % 4u] * detail);
            normal = normalize(flat_normal - right * steep.x - up * steep.y);
        }
    }
    let ray = (surface.position - geometry_draw.camera) / max(away, 1e-6);
    return shade(city, Seen(surface.material, world, ray, away, flat_normal, normal, surface.uv, height, detail, pixel));
}
