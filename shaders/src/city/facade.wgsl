#define_import_path dolomite::city::facade

// Walls of buildings: windows that stand back in the wall, shutters, doors, a base and edges of stone. Pure functions.

#import dolomite::city::types::{CityParams, BRICKS}
#import dolomite::city::windows::{lit_number, window_hash}

// How far window panes stand back, metres.
const RECESS: f32 = 0.14;

// A wall where a pixel sees it, metres: x to the right from its left end, seen from outside, y from the ground.
struct WallPlace {
    // On the flat wall.
    front: vec2<f32>,
    // Behind it by RECESS, along the ray.
    back: vec2<f32>,
    // Metres that a pixel covers.
    pixel: f32,
}

// What is seen there. `kind`: 0 the wall itself, 1 something painted, 2 glass.
struct WallLook {
    kind: u32,
    albedo: vec3<f32>,
    light: vec3<f32>,
    // Which way it looks, along the wall's right, up, and out.
    facing: vec3<f32>,
    occlusion: f32,
}

// Which building: its cell, lot and the side of the wall.
struct WallOf {
    cell: vec2<i32>,
    lot: u32,
    side: u32,
    tint: u32,
    surface: u32,
}

// A place on the wall along the ray through a displaced point: `place` and `ray` (from the eye, of length 1) along
// the wall's right, up and out; `out` is how far the point stands out, `depth` how far behind the wall is looked.
fn wall_place(place: vec2<f32>, ray: vec3<f32>, out: f32, depth: f32) -> vec2<f32> {
    // No farther than four times the depth: a ray along the wall has no place on it.
    let step = (out + depth) / max(-ray.z, 0.25);
    return place + ray.xy * step;
}

// 24 bits of a hash as a number from 0 to 1.
fn unit_of(hash: u32) -> f32 {
    return f32(hash >> 8u) * 5.9604645e-8;
}

// 1 within `half` of the middle, softened over a pixel.
fn strip(d: f32, half: f32, pixel: f32) -> f32 {
    return 1.0 - smoothstep(half - 0.5 * pixel, half + 0.5 * pixel, abs(d));
}

// Colour of bricks of 25 by 8 centimetres in courses, by place: each has its own, and joints go where a pixel covers
// half a course.
fn brick_colour(at: vec2<f32>, clay: vec3<f32>, pixel: f32) -> vec3<f32> {
    let course = floor(at.y * 12.0);
    let along = at.x * 4.0 + 0.5 * fract(course * 0.5) * 2.0;
    let brick = vec2(fract(along), fract(at.y * 12.0));
    let id = sin(dot(vec2(floor(along), course), vec2(12.9898, 78.233))) * 43758.547;
    let joint = min(min(brick.x, 1.0 - brick.x) * 0.25, min(brick.y, 1.0 - brick.y) * 0.0833);
    let near = 1.0 - smoothstep(0.012, 0.05, pixel);
    let own = clay * mix(1.0, 0.75 + 0.5 * fract(id), near);
    let shown = smoothstep(0.003, 0.008 + pixel, joint);
    return mix(own, mix(vec3(0.42, 0.40, 0.36), own, shown), near);
}

// What a lit room looks like through its window: `at` from -1 to 1 within the pane.
fn room_light(window: u32, at: vec2<f32>) -> vec3<f32> {
    let own = unit_of(window * 747796405u + 2891336453u);
    let warm = mix(vec3(1.0, 0.50, 0.18), vec3(1.0, 0.74, 0.44), own);
    // Some watch a screen.
    let colour = select(warm, vec3(0.42, 0.62, 1.0), (window & 31u) == 7u);
    let strong = 0.45 + 0.8 * unit_of(window * 277803737u + 13u);
    let curtain = step(0.62 + 0.3 * own, abs(at.x));
    let folds = 0.75 + 0.25 * sin(at.x * 60.0);
    let upper = 0.65 + 0.45 * smoothstep(-1.0, 0.9, at.y);
    return colour * (strong * upper * mix(1.0, 0.38 * folds, curtain));
}

fn wall_look(city: CityParams, wall_of: WallOf, at: WallPlace, wall: vec3<f32>) -> WallLook {
    let width = city.post.w;
    let storey = city.plan.z;
    let spacing = city.plan.w;
    let house = window_hash(city.place.x, wall_of.cell, wall_of.lot, 0u, 15u, 15u);
    let brick = wall_of.surface == BRICKS;
    let stone = mix(vec3(0.46, 0.43, 0.37), vec3(0.60, 0.57, 0.50), f32(wall_of.tint & 1u));
    let trim = select(mix(vec3(0.72, 0.70, 0.65), wall, 0.25), stone, brick);
    var look = WallLook(0u, wall, vec3(0.0), vec3(0.0, 0.0, 1.0), 1.0);
    if brick {
        look.albedo = brick_colour(at.front, wall, at.pixel);
    }
    // A base, a course at every storey, and stones at the edges.
    let y = at.front.y;
    let level = abs(y - max(round(y / storey), 1.0) * storey);
    let edge = min(at.front.x, width - at.front.x);
    let quoin = 0.28 + 0.16 * step(0.5, fract(y / 0.7));
    var bare = strip(level, 0.09, at.pixel);
    bare = max(bare, (1.0 - smoothstep(0.55, 0.55 + at.pixel, y)));
    bare = max(bare, select(0.0, 1.0 - smoothstep(quoin, quoin + at.pixel, edge), brick));
    let base = select(trim, stone * 0.72, y < 0.6);
    look.albedo = mix(look.albedo, base, bare);
    if bare > 0.5 {
        look.kind = 1u;
    }
    // Soot and rain: darker below.
    look.albedo *= 0.82 + 0.18 * smoothstep(0.0, 1.6, y);

    let columns = floor((width - 0.8) / spacing);
    let left = 0.5 * (width - columns * spacing);
    let x = (at.front.x - left) / spacing;
    if x < 0.0 || x >= columns || y < 0.0 {
        return look;
    }
    let number = vec2<u32>(u32(x), u32(y / storey));
    let middle = vec2(left + (f32(number.x) + 0.5) * spacing, (f32(number.y) + 0.52) * storey);
    let window = window_hash(city.place.x, wall_of.cell, wall_of.lot, wall_of.side, number.x, number.y);
    // One column of one side has the door; the others of the ground are as those above.
    let is_door = number.y == 0u && (house & 3u) == wall_of.side && ((house >> 2u) % u32(columns)) == number.x;
    var centre = middle;
    var half_size = vec2(0.26 * spacing, 0.27 * storey);
    if is_door {
        half_size = vec2(0.55, 1.15);
        centre.y = 1.15;
    }
    let front = at.front - centre;
    let inside = abs(front) - half_size;
    // Around the opening: a frame of stone, a sill below it, shutters beside it.
    if max(inside.x, inside.y) > 0.0 {
        let outline = max(inside.x, inside.y);
        let shutters = !brick && !is_door && (house >> 8u) % 3u == 0u && inside.y <= 0.0;
        if shutters && inside.x < 0.40 {
            let paint = array<vec3<f32>, 4>(vec3(0.05, 0.13, 0.08), vec3(0.06, 0.10, 0.17), vec3(0.17, 0.07, 0.04), vec3(0.30, 0.30, 0.27))[(house >> 12u) & 3u];
            let slat = fract((at.front.y) * 12.0);
            let near = 1.0 - smoothstep(0.01, 0.04, at.pixel);
            let shade = mix(0.85, 0.55 + 0.6 * slat, near);
            let gap = step(0.03, inside.x) * (1.0 - step(0.385, inside.x));
            look.albedo = mix(look.albedo * 0.6, paint * shade, gap);
            look.kind = 1u;
            return look;
        }
        let sill = !is_door && front.y < 0.0 && inside.y < 0.11 && inside.x < 0.1;
        let frame = outline < 0.085;
        if sill || (frame && !shutters) {
            look.albedo = trim * select(1.0, 1.1, sill);
            look.kind = 1u;
        }
        return look;
    }
    let back = at.back - centre;
    let pane = abs(back) - half_size;
    look.kind = 1u;
    if max(pane.x, pane.y) > 0.0 {
        // The side of the opening; it looks towards its middle.
        let across = pane.x > pane.y;
        look.facing = select(vec3(0.0, -sign(back.y), 0.0), vec3(-sign(back.x), 0.0, 0.0), across);
        look.albedo = trim * 0.85;
        look.occlusion = 0.6;
        return look;
    }
    let within = back / half_size;
    if is_door {
        let wood = array<vec3<f32>, 4>(vec3(0.10, 0.045, 0.02), vec3(0.03, 0.07, 0.05), vec3(0.12, 0.02, 0.02), vec3(0.035, 0.045, 0.09))[(house >> 16u) & 3u];
        let light = within.y > 0.66;
        let panel = max(abs(abs(back.x) - 0.26) - 0.17, abs(fract(within.y * 1.4 + 0.3) - 0.5) - 0.36);
        look.albedo = wood * select(1.0, 0.7, panel < 0.0);
        if light {
            look.kind = 2u;
            look.albedo = vec3(0.02, 0.025, 0.03);
            let lit = lit_number(house, city.place.z) < city.place.y;
            look.light = select(vec3(0.0), vec3(1.0, 0.6, 0.25) * 0.8, lit);
        }
        look.occlusion = 0.8;
        return look;
    }
    let bar = 0.035;
    let rim = max(pane.x, pane.y) > -0.06;
    let upright = abs(back.x) < bar;
    let cross = (house >> 20u) % 2u == 0u && abs(back.y - 0.3 * half_size.y) < bar;
    look.occlusion = 0.85;
    if rim || upright || cross {
        look.albedo = select(vec3(0.62, 0.60, 0.55), vec3(0.12, 0.07, 0.04), (house >> 24u) % 3u == 0u);
        return look;
    }
    look.kind = 2u;
    look.albedo = vec3(0.02, 0.025, 0.03);
    if lit_number(window, city.place.z) < city.place.y {
        look.light = room_light(window, within);
    } else if (window & 3u) == 0u {
        // Curtains behind the glass.
        look.albedo = vec3(0.16, 0.15, 0.14) * (0.8 + 0.2 * sin(back.x * 70.0));
    }
    return look;
}
