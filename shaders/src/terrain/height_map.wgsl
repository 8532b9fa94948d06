#define_import_path dolomite::terrain::height_map

// Heights between the samples of a map, with their gradient. CPU reference:
// plugins/terrain/src/height_map/interpolate.rs; samples are taken relative to one of them.

#import dolomite::terrain::fixed::{Fixed, coordinate, fixed_sub, fraction}
#import dolomite::terrain::layer::{Layer, BILINEAR}
#import dolomite::terrain::bindings::load_sample

// Catmull-Rom weights of the samples at -1, 0, 1, 2, and their derivatives.
fn cubic_weights(t: f32) -> vec4<f32> {
    let t2 = t * t;
    let t3 = t2 * t;
    return vec4(t2 - 0.5 * (t3 + t), 1.5 * t3 - 2.5 * t2 + 1.0, 2.0 * t2 - 1.5 * t3 + 0.5 * t, 0.5 * (t3 - t2));
}

fn cubic_slopes(t: f32) -> vec4<f32> {
    let t2 = t * t;
    return vec4(2.0 * t - 1.5 * t2 - 0.5, 4.5 * t2 - 5.0 * t, 4.0 * t - 4.5 * t2 + 0.5, 1.5 * t2 - t);
}

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
