#define_import_path dolomite::city::look

// Colours of a city's surfaces, from the height of the map at a place: pure functions.

#import dolomite::city::types::{ASPHALT, COBBLES, GRASS, BRICKS, PLASTER, TILES}

// Reflectance, and how rough.
struct Cover {
    albedo: vec3<f32>,
    roughness: f32,
}

// Colour of walls, of eight.
fn wall_tint(tint: u32, brick: bool) -> vec3<f32> {
    let warm = f32(tint & 3u) / 3.0;
    let dark = f32(tint >> 2u);
    if brick {
        return mix(vec3(0.32, 0.115, 0.07), vec3(0.42, 0.23, 0.13), warm) * (1.0 - 0.35 * dark);
    }
    // Cream, sand, ochre, rose; white, grey, green, blue.
    let paint = array<vec3<f32>, 8>(vec3(0.66, 0.58, 0.44), vec3(0.62, 0.47, 0.30), vec3(0.58, 0.38, 0.17), vec3(0.58, 0.36, 0.29), vec3(0.70, 0.69, 0.65), vec3(0.46, 0.47, 0.46), vec3(0.40, 0.47, 0.36), vec3(0.38, 0.46, 0.52));
    return paint[tint & 7u];
}

// `height` is that of the map, 0 to 1.
fn cover(surface: u32, tint: u32, height: f32) -> Cover {
    let joint = smoothstep(0.15, 0.45, height);
    switch surface {
        case ASPHALT: {
            return Cover(vec3(0.055, 0.056, 0.06) * (0.75 + 0.5 * height), 0.85);
        }
        case COBBLES: {
            return Cover(mix(vec3(0.05, 0.045, 0.04), vec3(0.21, 0.195, 0.175) * (0.6 + 0.5 * height), joint), 0.7);
        }
        case GRASS: {
            return Cover(mix(vec3(0.030, 0.052, 0.013), vec3(0.085, 0.135, 0.028), height), 0.95);
        }
        case BRICKS: {
            return Cover(wall_tint(tint, true) * (0.8 + 0.25 * height), 0.85);
        }
        case PLASTER: {
            return Cover(wall_tint(tint, false) * (0.88 + 0.16 * height), 0.9);
        }
        case TILES: {
            // Three clays, and slate.
            let clay = array<vec3<f32>, 4>(vec3(0.34, 0.105, 0.055), vec3(0.26, 0.10, 0.06), vec3(0.19, 0.085, 0.06), vec3(0.085, 0.095, 0.11))[(tint >> 1u) & 3u];
            return Cover(clay * (0.45 + 0.75 * height), 0.75);
        }
        default: {
            return Cover(mix(vec3(0.012, 0.030, 0.008), vec3(0.05, 0.11, 0.022), height), 0.8);
        }
    }
}

// What the map's height is where a pixel covers much of it.
fn mean_height(surface: u32) -> f32 {
    return select(0.5, 0.65, surface == COBBLES || surface == BRICKS);
}

// What covers flat ground at a place of a cell, metres from its corner: half a street all round, or by two bits
// (lines west and east, north and south) where only some are streets.
fn ground_at(at: vec2<f32>, pitch: f32, street: f32, west_east: vec2<bool>, north_south: vec2<bool>) -> u32 {
    let kerb = 0.5 * street;
    let across = (at.x < kerb && west_east.x) || (at.x > pitch - kerb && west_east.y);
    let along = (at.y < kerb && north_south.x) || (at.y > pitch - kerb && north_south.y);
    if across && along {
        return COBBLES;
    }
    return select(GRASS, ASPHALT, across || along);
}
