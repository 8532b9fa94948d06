#define_import_path dolomite::city::shade

// What a pixel of a city is: what covers it, its windows, and the light of lamps that are far.

#import dolomite::city::types::{CityParams, ASPHALT, BRICKS, COBBLES, PLASTER, FAR, LEAVES, GRASS}
#import dolomite::city::facade::{RECESS, WallOf, WallPlace, wall_look, wall_place}
#import dolomite::city::look::{Cover, cover, ground_at, mean_height}
#import dolomite::city::street::street_look
#import dolomite::geometry::draw_types::Shaded

// Side that a wall looks to: west, south, east, north.
fn wall_side(normal: vec3<f32>) -> u32 {
    if abs(normal.x) > abs(normal.z) {
        return select(0u, 2u, normal.x > 0.0);
    }
    return select(3u, 1u, normal.z > 0.0);
}

// Along a wall to the right, seen from outside.
fn wall_right(normal: vec3<f32>) -> vec3<f32> {
    return cross(vec3(0.0, 1.0, 0.0), normal);
}

// A pixel before it is shaded: its place in the world, the ray to it from the eye with its length, the surface's flat
// normal and the one with relief, metres on the face, the map's height, how much of that a pixel can show, and the
// metres that a pixel covers.
struct Seen {
    material: u32,
    world: vec3<f32>,
    ray: vec3<f32>,
    away: f32,
    flat_normal: vec3<f32>,
    normal: vec3<f32>,
    uv: vec2<f32>,
    height: f32,
    detail: f32,
    pixel: f32,
}

fn shade(city: CityParams, seen: Seen) -> Shaded {
    var surface = seen.material & 7u;
    let lot = (seen.material >> 3u) & 3u;
    let tint = seen.material >> 5u;
    // From inside the wall, so that rounding does not choose the neighbour's cell.
    let inside = seen.world - seen.flat_normal * 0.5;
    let number = floor(inside.xz / city.plan.x);
    let cell = vec2<i32>(number);
    let all = city.place.w == 0u;
    let streets = vec4(all || cell.x == 0, all || cell.x == -1, all || cell.y == 0, all || cell.y == -1);
    let in_cell = inside.xz - number * city.plan.x;
    if surface == FAR {
        surface = ground_at(in_cell, city.plan.x, city.plan.y, streets.xy, streets.zw);
    }
    let shown = mix(mean_height(surface), seen.height, seen.detail);
    let covered = cover(surface, tint, shown);
    var shaded = Shaded(covered.albedo, vec3(0.0), seen.normal, covered.roughness, 0.0, 0.4, 0.7 + 0.3 * shown, false, true);
    if surface == ASPHALT || surface == GRASS || surface == COBBLES {
        let street = street_look(surface, in_cell, city.plan.x, 0.5 * city.plan.y, streets, covered.albedo, covered.roughness, shown, seen.pixel);
        shaded.base_color = street.albedo;
        shaded.roughness = street.roughness;
        shaded.normal = normalize(mix(seen.flat_normal, seen.normal, street.relief));
        shaded.occlusion = mix(1.0, shaded.occlusion, street.relief);
    }
    if surface == GRASS || surface == LEAVES {
        shaded.reflectance = 0.2;
    }
    if surface == BRICKS || surface == PLASTER {
        let right = wall_right(seen.flat_normal);
        let ray = vec3(dot(seen.ray, right), seen.ray.y, dot(seen.ray, seen.flat_normal));
        let out = city.heights[surface / 4u][surface % 4u] * seen.height * seen.detail;
        let place = vec2(seen.uv.x, seen.world.y - city.ground.w);
        let on_wall = WallPlace(wall_place(place, ray, out, 0.0), wall_place(place, ray, out, RECESS), seen.pixel);
        let wall_of = WallOf(cell, lot, wall_side(seen.flat_normal), tint, surface);
        let look = wall_look(city, wall_of, on_wall, covered.albedo);
        shaded.base_color = look.albedo;
        shaded.emissive = look.light * city.night.x;
        if look.kind > 0u {
            shaded.normal = right * look.facing.x + vec3(0.0, look.facing.y, 0.0) + seen.flat_normal * look.facing.z;
            shaded.occlusion = look.occlusion;
        }
        if look.kind == 2u {
            shaded.roughness = 0.1;
            shaded.reflectance = 0.7;
        }
    }
    // Light of lamps that are no lights here: as much on average as they give the ground, below them alone.
    let share = smoothstep(city.night.z, city.night.w, seen.away) * (1.0 - smoothstep(3.0, 7.0, seen.world.y - city.ground.w));
    shaded.emissive += shaded.base_color * city.lamps.xyz * (city.night.y * share * 0.31830989);
    return shaded;
}
