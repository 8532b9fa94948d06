#define_import_path dolomite::city::shade

// What a pixel of a city is: what covers it, its windows, and the light of lamps that are far.

#import dolomite::city::types::{CityParams, BRICKS, PLASTER, FAR, LEAVES, GRASS}
#import dolomite::city::look::{Cover, cover, ground_at, mean_height}
#import dolomite::city::windows::{lit_number, window_hash}
#import dolomite::geometry::draw_types::Shaded

// A window at a place of a wall: 0 none, 1 frame, 2 dark, 3 lit.
fn window_at(city: CityParams, cell: vec2<i32>, lot: u32, side: u32, at: vec2<f32>) -> u32 {
    let width = city.post.w;
    let spacing = city.plan.w;
    let columns = floor((width - 0.8) / spacing);
    let x = (at.x - 0.5 * (width - columns * spacing)) / spacing;
    let y = at.y / city.plan.z;
    if x < 0.0 || x >= columns || y < 0.0 {
        return 0u;
    }
    let within = abs(vec2(fract(x), fract(y)) - vec2(0.5, 0.52));
    let half_size = vec2(0.26, 0.27);
    if within.x > half_size.x || within.y > half_size.y {
        return 0u;
    }
    let frame = half_size - within < vec2(0.07 / spacing, 0.07 / city.plan.z);
    let bar = within.x < 0.02;
    if frame.x || frame.y || bar {
        return 1u;
    }
    let number = lit_number(window_hash(city.place.x, cell, lot, side, u32(x), u32(y)), city.place.z);
    return select(2u, 3u, number < city.place.y);
}

// Side that a wall looks to: west, south, east, north.
fn wall_side(normal: vec3<f32>) -> u32 {
    if abs(normal.x) > abs(normal.z) {
        return select(0u, 2u, normal.x > 0.0);
    }
    return select(3u, 1u, normal.z > 0.0);
}

// `world` is the place in the world; `uv` metres on the face; `height` and `detail` are the map's height there, and
// how much of it a pixel can show.
fn shade(city: CityParams, material: u32, world: vec3<f32>, away: f32, flat_normal: vec3<f32>, normal: vec3<f32>, uv: vec2<f32>, height: f32, detail: f32) -> Shaded {
    var surface = material & 7u;
    let lot = (material >> 3u) & 3u;
    let tint = material >> 5u;
    // From inside the wall, so that rounding does not choose the neighbour's cell.
    let inside = world - flat_normal * 0.5;
    let number = floor(inside.xz / city.plan.x);
    let cell = vec2<i32>(number);
    if surface == FAR {
        let all = city.place.w == 0u;
        let west_east = vec2(all || cell.x == 0, all || cell.x == -1);
        let north_south = vec2(all || cell.y == 0, all || cell.y == -1);
        surface = ground_at(inside.xz - number * city.plan.x, city.plan.x, city.plan.y, west_east, north_south);
    }
    let shown = mix(mean_height(surface), height, detail);
    let covered = cover(surface, tint, shown);
    var shaded = Shaded(covered.albedo, vec3(0.0), normal, covered.roughness, 0.0, 0.4, 0.7 + 0.3 * shown, false, true);
    if surface == GRASS || surface == LEAVES {
        shaded.reflectance = 0.2;
    }
    if surface == BRICKS || surface == PLASTER {
        let window = window_at(city, cell, lot, wall_side(flat_normal), vec2(uv.x, world.y - city.ground.w));
        if window == 1u {
            shaded.base_color = vec3(0.55, 0.53, 0.48);
            shaded.normal = flat_normal;
        } else if window >= 2u {
            shaded.base_color = vec3(0.02, 0.025, 0.03);
            shaded.roughness = 0.12;
            shaded.reflectance = 0.6;
            shaded.normal = flat_normal;
            if window == 3u {
                shaded.emissive = vec3(1.0, 0.62, 0.28) * city.night.x;
            }
        }
    }
    // Light of lamps that are no lights here: as much on average as they give the ground, below them alone.
    let share = smoothstep(city.night.z, city.night.w, away) * (1.0 - smoothstep(3.0, 7.0, world.y - city.ground.w));
    shaded.emissive += shaded.base_color * city.lamps.xyz * (city.night.y * share * 0.31830989);
    return shaded;
}
