#define_import_path dolomite::terrain::height_map

// Heights between the samples of a map, with their gradient. CPU reference:
// plugins/terrain/src/height_map/interpolate.rs; samples are taken relative to one of them.

#import dolomite::terrain::fixed::{Fixed, coordinate, fixed_sub, fraction}
#import dolomite::terrain::layer::{Layer, BILINEAR}
#import dolomite::terrain::bindings::load_sample
#import dolomite::terrain::cubic::{cubic_slopes, cubic_weights}
#ifdef TERRAIN_TILED
#import dolomite::terrain::clip::clip_height
#endif

// Between the samples (i, j) and (i + 1, j + 1); fx, fz from the first, 0 to 1.
fn bilinear(layer: Layer, i: i32, j: i32, fx: f32, fz: f32) -> vec3<f32> {
    let middle = load_sample(layer, i, j);
    let east = load_sample(layer, i + 1, j) - middle;
    let south = load_sample(layer, i, j + 1) - middle;
    let far = load_sample(layer, i + 1, j + 1) - middle;
    let twist = (far - south) - east;
    return vec3(
        middle + (fx * east + fz * (south + fx * twist)),
        vec2(east + fz * twist, south + fx * twist) * layer.scale,
    );
}

fn bicubic(layer: Layer, i: i32, j: i32, fx: f32, fz: f32) -> vec3<f32> {
    let middle = load_sample(layer, i, j);
    let wx = cubic_weights(fx);
    let sx = cubic_slopes(fx);
    let wz = cubic_weights(fz);
    let sz = cubic_slopes(fz);
    var value = 0.0;
    var gradient = vec2(0.0);
    for (var dj = 0; dj < 4; dj++) {
        let row = vec4(
            load_sample(layer, i - 1, j + dj - 1),
            load_sample(layer, i, j + dj - 1),
            load_sample(layer, i + 1, j + dj - 1),
            load_sample(layer, i + 2, j + dj - 1),
        ) - middle;
        let across = dot(wx, row);
        value += wz[dj] * across;
        gradient += vec2(wz[dj] * dot(sx, row), sz[dj] * across);
    }
    return vec3(middle + value, gradient * layer.scale);
}

// Whoever knows that a terrain has no maps of one kind leaves it out, as in height.wgsl.
fn map_height(layer: Layer, x: Fixed, z: Fixed) -> vec3<f32> {
    let origin_x = Fixed(bitcast<u32>(layer.origin_cell.x), layer.origin_frac.x);
    let origin_z = Fixed(bitcast<u32>(layer.origin_cell.y), layer.origin_frac.y);
    let cx = coordinate(fixed_sub(x, origin_x), layer.mantissa.x, layer.shift.x);
    let cz = coordinate(fixed_sub(z, origin_z), layer.mantissa.y, layer.shift.y);
#ifdef TERRAIN_TILED
    if layer.octaves > 0u {
        return clip_height(layer, vec2(bitcast<i32>(cx.whole), bitcast<i32>(cz.whole)), vec2(fraction(cx), fraction(cz)));
    }
#endif
    // Two cells beyond a border all samples are the border's: no need to go further.
    let i = clamp(bitcast<i32>(cx.whole), -4, i32(layer.size.x) + 4);
    let j = clamp(bitcast<i32>(cz.whole), -4, i32(layer.size.y) + 4);
    let fx = fraction(cx);
    let fz = fraction(cz);
#ifndef TERRAIN_WITHOUT_BILINEAR
    if layer.kind == BILINEAR {
        return bilinear(layer, i, j, fx, fz);
    }
#endif
#ifdef TERRAIN_WITHOUT_BICUBIC
    return vec3(0.0);
#else
    return bicubic(layer, i, j, fx, fz);
#endif
}
