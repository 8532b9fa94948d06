#define_import_path dolomite::city::levels

// Levels of patches, by a bound of the error and by distance. The CPU reference, with the derivation:
// plugins/city/src/levels.rs.

#import dolomite::city::types::{CityParams, TILES}
#import dolomite::city::relief::{PatchData, is_border}

struct CityLevels {
    // Of the sides u = 0, v = 0, u = 1, v = 1.
    outer: vec4<f32>,
    // Along u and v.
    inner: vec2<f32>,
}

// Four corners: (0,0), (1,0), (1,1), (0,1).
struct Corners {
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
    d: vec3<f32>,
}

const MOST: f32 = 64.0;

// Of a length at a distance; `pixels` of a radian.
fn bound_level(city: CityParams, pixels: f32, size: f32, away: f32, amplitude: f32, bend: f32) -> f32 {
    let allowed = city.relief.x * max(away, 0.0) / pixels;
    if amplitude <= allowed {
        return 1.0;
    }
    // Nothing allowed: as fine as can be, without a division by 0.
    if allowed == 0.0 {
        return MOST;
    }
    return min(size * sqrt(bend / allowed), MOST);
}

fn bound_side(city: CityParams, eye: vec3<f32>, pixels: f32, data: PatchData, side: u32, a: vec3<f32>, b: vec3<f32>) -> f32 {
    let size = distance(a, b);
    let away = distance((a + b) * 0.5, eye) - 0.5 * size - city.bound.z - city.bound.x;
    if is_border(data, side) {
        return bound_level(city, pixels, size, away, city.bound.x, city.bound.y);
    }
    let surface = u32(data.face.w) & 7u;
    return bound_level(city, pixels, size, away, data.map.z, city.bend[surface / 4u][surface % 4u]);
}

fn bound_levels(city: CityParams, eye: vec3<f32>, pixels: f32, data: PatchData, at: Corners) -> CityLevels {
    let outer = vec4(
        bound_side(city, eye, pixels, data, 0u, at.a, at.d),
        bound_side(city, eye, pixels, data, 1u, at.a, at.b),
        bound_side(city, eye, pixels, data, 2u, at.b, at.c),
        bound_side(city, eye, pixels, data, 3u, at.d, at.c),
    );
    let middle = (at.a + at.b + at.c + at.d) * 0.25;
    let radius = max(max(distance(at.a, middle), distance(at.b, middle)), max(distance(at.c, middle), distance(at.d, middle)));
    let away = distance(middle, eye) - radius - city.bound.x;
    let surface = u32(data.face.w) & 7u;
    let bend = city.bend[surface / 4u][surface % 4u];
    let wide = max(distance(at.a, at.b), distance(at.d, at.c));
    let high = max(distance(at.a, at.d), distance(at.b, at.c));
    let inner = vec2(
        bound_level(city, pixels, wide, away, data.map.z, bend),
        bound_level(city, pixels, high, away, data.map.z, bend),
    );
    return CityLevels(outer, select(inner, max(inner, vec2(3.0)), inner > vec2(1.0)));
}

fn with_inner(outer: vec4<f32>) -> CityLevels {
    return CityLevels(outer, vec2(max(outer.y, outer.w), max(outer.x, outer.z)));
}

fn ground_side(city: CityParams, eye: vec3<f32>, a: vec3<f32>, b: vec3<f32>) -> f32 {
    let away = distance((a + b) * 0.5, eye);
    if away > city.ground.z {
        return city.ground.y;
    }
    let share = 0.6 * (away / city.ground.z) + 0.4;
    return city.ground.x + (city.ground.y - city.ground.x) * share;
}

fn ground_levels(city: CityParams, eye: vec3<f32>, at: Corners) -> CityLevels {
    return with_inner(vec4(
        ground_side(city, eye, at.a, at.d),
        ground_side(city, eye, at.a, at.b),
        ground_side(city, eye, at.b, at.c),
        ground_side(city, eye, at.d, at.c),
    ));
}

// Level a metre, and length.
fn face_side(city: CityParams, eye: vec3<f32>, reach: vec2<f32>, a: vec3<f32>, b: vec3<f32>) -> vec2<f32> {
    let away = (a + b) * 0.5 - eye;
    let flat_distance = sqrt(away.x * away.x + away.z * away.z);
    let share = clamp((flat_distance - reach.x) / (reach.y - reach.x), 0.0, 1.0);
    let size = distance(a, b);
    return vec2((city.ground.x + (city.ground.y - city.ground.x) * share) / size, size);
}

fn face_levels(city: CityParams, eye: vec3<f32>, reach: vec2<f32>, at: Corners) -> CityLevels {
    let left = face_side(city, eye, reach, at.a, at.d);
    let low = face_side(city, eye, reach, at.a, at.b);
    let right = face_side(city, eye, reach, at.b, at.c);
    let high = face_side(city, eye, reach, at.d, at.c);
    let sideways = (left.x + right.x) * 0.5;
    let upwards = (low.x + high.x) * 0.5;
    return with_inner(vec4(sideways * left.y, upwards * low.y, sideways * right.y, upwards * high.y));
}

fn city_levels(city: CityParams, eye: vec3<f32>, pixels: f32, data: PatchData, at: Corners) -> CityLevels {
    let mode = city.bound.w;
    if mode > 0.0 {
        return CityLevels(vec4(mode), vec2(mode));
    }
    if mode == 0.0 {
        return bound_levels(city, eye, pixels, data, at);
    }
    let surface = u32(data.face.w) & 7u;
    if surface <= 2u {
        return ground_levels(city, eye, at);
    }
    return face_levels(city, eye, select(city.faces.xy, city.faces.zw, surface == TILES), at);
}
