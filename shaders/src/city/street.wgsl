#define_import_path dolomite::city::street

// What is painted and laid on the ground: lanes, crossings for people, gutters, kerbs and pavements. Pure functions of
// a place in its cell.

#import dolomite::city::types::{ASPHALT, GRASS}

// What covers a place: albedo, roughness, and how much of the map's height is left in its colour and slope.
struct StreetLook {
    albedo: vec3<f32>,
    roughness: f32,
    relief: f32,
}

fn line(d: f32, half: f32, pixel: f32) -> f32 {
    // A line thinner than a pixel covers its share of it.
    let wide = max(half, 0.5 * pixel);
    return (1.0 - smoothstep(wide - 0.5 * pixel, wide + 0.5 * pixel, abs(d))) * half / wide;
}

// `at` metres from the north-western corner of the cell; `streets`: which lines (west, east, north, south) are
// streets; `kerb` half of a street's width.
fn street_look(surface: u32, at: vec2<f32>, pitch: f32, kerb: f32, streets: vec4<bool>, albedo: vec3<f32>, roughness: f32, height: f32, pixel: f32) -> StreetLook {
    var look = StreetLook(albedo, roughness, 1.0);
    let far = 1e3;
    let dx = min(select(far, at.x, streets.x), select(far, pitch - at.x, streets.y));
    let dz = min(select(far, at.y, streets.z), select(far, pitch - at.y, streets.w));
    if surface == ASPHALT {
        let lateral = min(dx, dz);
        let along = select(at.x, at.y, dx < dz);
        let to_crossing = min(along, pitch - along) - kerb;
        let worn = 0.35 + 0.65 * smoothstep(0.25, 0.6, height);
        let dash = line(abs(fract(along / 4.0) - 0.5) * 4.0, 1.0, pixel);
        let lane = line(lateral, 0.06, pixel) * dash * step(2.9, to_crossing);
        let zebra = line(to_crossing - 1.4, 0.9, pixel) * line(abs(fract(lateral / 1.1) - 0.5) * 1.1, 0.27, pixel) * step(lateral, kerb - 0.5);
        let paint = max(lane, zebra) * worn;
        look.albedo = mix(look.albedo, vec3(0.55, 0.54, 0.50), paint);
        // Patches of older tar, and a gutter of stone.
        let old = sin(at.x * 1.7 + 2.0 * sin(at.y * 0.6)) * sin(at.y * 1.3 + sin(at.x * 0.9));
        look.albedo *= 1.0 + 0.12 * old;
        let gutter = smoothstep(kerb - 0.34 - pixel, kerb - 0.34, lateral);
        let stones = 0.75 + 0.25 * smoothstep(0.0, 0.05 + pixel, abs(fract(along * 2.5) - 0.5) * 0.4);
        look.albedo = mix(look.albedo, vec3(0.16, 0.155, 0.145) * stones, gutter);
    } else if surface == GRASS {
        let away = min(dx, dz) - kerb;
        let meadow = sin(at.x * 0.9 + sin(at.y * 1.7)) * sin(at.y * 0.7 + sin(at.x * 1.1));
        look.albedo *= 1.0 + 0.22 * meadow;
        let paved = 1.0 - smoothstep(1.0, 1.0 + max(pixel, 0.02), away);
        if paved > 0.0 {
            let slab = abs(fract(at * 2.0) - 0.5) * 0.5;
            let joint = smoothstep(0.238 - pixel, 0.25, max(slab.x, slab.y)) * (1.0 - smoothstep(0.02, 0.08, pixel));
            let id = floor(at * 2.0);
            let own = 0.9 + 0.2 * fract(sin(dot(id, vec2(12.9898, 78.233))) * 43758.547);
            var stone = vec3(0.30, 0.29, 0.27) * own * (0.92 + 0.16 * height);
            stone = mix(stone, vec3(0.12, 0.115, 0.10), joint * 0.7);
            let kerbstone = 1.0 - smoothstep(0.16, 0.16 + max(pixel, 0.01), away);
            let ends = smoothstep(0.47 - pixel, 0.49, abs(fract(select(at.x, at.y, dx < dz)) - 0.5));
            stone = mix(stone, vec3(0.40, 0.39, 0.36) * (1.0 - 0.5 * ends), kerbstone);
            look.albedo = mix(look.albedo, stone, paved);
            look.roughness = mix(look.roughness, 0.8, paved);
            look.relief = 1.0 - 0.85 * paved;
        }
    }
    return look;
}
