#define_import_path dolomite::detail::unseen

// What samples at a spacing may miss altogether. CPU reference: plugins/terrain/src/bounds/unseen.rs.

#import dolomite::terrain::fixed::{GroundPoint, coordinate, fixed_add, fixed_metres, fixed_sub, fraction, ground_x, ground_z, Fixed}
#import dolomite::terrain::layer::{Layer, RIDGED, BILLOW, ERODED, CLASSIC, BILINEAR, BICUBIC, HILL, EDITS_BILINEAR}
#import dolomite::terrain::edits::missed_of_edits
#import dolomite::terrain::bindings::{load_octave, terrain, terrain_data, terrain_layers}
#ifdef TERRAIN_TILED
#import dolomite::terrain::clip::clip_missed
#endif

// Beyond so many cells from sample to sample an octave counts as hidden.
const MOST_CELLS: f32 = 200.0;

// Between samples `apart` of the map's own, over a rectangle from `low` to `high` in their units. CPU reference:
// Deviations::missed in plugins/terrain/src/height_map/deviation.rs.
fn missed_of_map(layer: Layer, low: vec2<f32>, high: vec2<f32>, apart: f32) -> f32 {
#ifdef TERRAIN_TILED
    if layer.octaves > 0u {
        return clip_missed(layer, low, high, apart);
    }
#endif
    var windows = layer.warp_data;
    for (var k = 1u; k <= layer.warp_octaves; k++) {
        let count = ((layer.size - vec2(1u)) >> vec2(k)) + vec2(2u);
        let side = f32(1u << k);
        if side < apart {
            windows += count.x * count.y;
            continue;
        }
        let most = vec2<f32>(count - vec2(1u));
        let first = vec2<u32>(clamp(floor(low / side) + 1.0, vec2(0.0), most));
        let last = vec2<u32>(clamp(ceil(high / side), vec2(0.0), most));
        var largest = 0.0;
        for (var z = first.y; z <= last.y; z++) {
            for (var x = first.x; x <= last.x; x++) {
                largest = max(largest, bitcast<f32>(terrain_data[windows + z * count.x + x]));
            }
        }
        return 2.0 * largest;
    }
    // From the lowest to the highest height.
    return layer.erosion;
}

// The farthest from a whole number that lies between two numbers, 0 to 1/2.
fn farthest(a: f32, b: f32) -> f32 {
    let off = max(abs(a - round(a)), abs(b - round(b)));
    return select(0.5, off, floor(a + 0.5) == floor(b + 0.5));
}

// How high noise is at a place of its cells, 0 to 1/2, as a share of how high it is in the middle of a side.
fn met(place: vec2<f32>) -> f32 {
    let far = place * place * place * (place * (6.0 * place - 15.0) + 10.0);
    let near = 1.0 - far;
    let beyond = 1.0 - place;
    // Of the four corners: the square of its weight, and of how far it is.
    let near_z = vec2(near.x * near.y, far.x * near.y);
    let far_z = vec2(near.x * far.y, far.x * far.y);
    let away = vec2(place.x * place.x, beyond.x * beyond.x);
    let all = dot(near_z * near_z, away + place.y * place.y) + dot(far_z * far_z, away + beyond.y * beyond.y);
    return min(sqrt(8.0 * all), 1.0);
}

// What samples do not meet of a layer of noise because all of them stand at the same place of its cells; and the sum of its
// amplitudes. CPU reference: plugins/terrain/src/bounds/hidden.rs.
fn missed_of_noise(layer: Layer, centre: GroundPoint, sides: vec2<f32>, spacing: f32) -> vec2<f32> {
    let count = round(max(sides.x, sides.y) / spacing);
    let steps = sides / count;
    var sum = vec2(0.0);
    for (var k = 0u; k < layer.octaves; k++) {
        let octave = load_octave(layer.data, k);
        let amplitude = abs(octave.amplitude);
        let cells = steps * octave.frequency;
        let most = max(cells.x, cells.y);
        var share = 0.0;
        if most > MOST_CELLS {
            share = 1.0;
        } else if most >= 0.5 {
            let at_x = fixed_add(coordinate(ground_x(centre), octave.mantissa, octave.shift), Fixed(octave.offset_x.x, octave.offset_x.y));
            let at_z = fixed_add(coordinate(ground_z(centre), octave.mantissa, octave.shift), Fixed(octave.offset_z.x, octave.offset_z.y));
            let place = vec2(fraction(at_x), fraction(at_z));
            let drift = 0.5 * count * (cells - round(cells));
            let x = farthest(place.x - drift.x, place.x + drift.x);
            let z = farthest(place.y - drift.y, place.y + drift.y);
            share = 1.0 - met(vec2(x, z));
        }
        sum += amplitude * vec2(share, 1.0);
    }
    if layer.kind == RIDGED || layer.kind == BILLOW {
        sum.x *= 2.0;
    }
    return sum;
}

// Metres; the rectangle is given by its centre and sides.
fn unseen(centre: GroundPoint, sides: vec2<f32>, spacing: f32) -> f32 {
    var missed = 0.0;
    for (var i = 0u; i < terrain.layer_count; i++) {
        let layer = terrain_layers[i];
        // What is missed of the layer, and how far from 0 it may be.
        var own = vec2(0.0);
#ifndef TERRAIN_WITHOUT_FRACTALS
        if layer.kind <= ERODED {
            own = missed_of_noise(layer, centre, sides, spacing);
        }
#endif
#ifndef TERRAIN_WITHOUT_CLASSIC
        if layer.kind == CLASSIC {
            own = missed_of_noise(layer, centre, sides, spacing);
        }
#endif
        if layer.kind == HILL {
            let dx = fixed_metres(fixed_sub(ground_x(centre), Fixed(bitcast<u32>(layer.origin_cell.x), layer.origin_frac.x)));
            let dz = fixed_metres(fixed_sub(ground_z(centre), Fixed(bitcast<u32>(layer.origin_cell.y), layer.origin_frac.y)));
            let away = max(abs(vec2(dx, dz)) - sides * 0.5, vec2(0.0));
            // scale: 1 / radius, height.
            let near = length(away) * layer.scale.x < 1.0;
            let height = abs(layer.scale.y);
            own = vec2(select(0.0, height, near && 1.0 < 4.0 * spacing * layer.scale.x), height);
        } else if layer.kind == BILINEAR || layer.kind == BICUBIC {
            own.y = layer.erosion;
            // scale: samples a metre.
            let apart = max(layer.scale.x, layer.scale.y) * spacing;
            if apart > 1.001 {
                let dx = fixed_metres(fixed_sub(ground_x(centre), Fixed(bitcast<u32>(layer.origin_cell.x), layer.origin_frac.x)));
                let dz = fixed_metres(fixed_sub(ground_z(centre), Fixed(bitcast<u32>(layer.origin_cell.y), layer.origin_frac.y)));
                let low = (vec2(dx, dz) - sides * 0.5) * layer.scale;
                own.x = missed_of_map(layer, low, low + sides * layer.scale, apart);
            }
        }
#ifndef TERRAIN_WITHOUT_EDITS
        else if layer.kind >= EDITS_BILINEAR && max(layer.scale.x, layer.scale.y) * spacing > 1.001 {
            let dx = fixed_metres(fixed_sub(ground_x(centre), Fixed(bitcast<u32>(layer.origin_cell.x), layer.origin_frac.x)));
            let dz = fixed_metres(fixed_sub(ground_z(centre), Fixed(bitcast<u32>(layer.origin_cell.y), layer.origin_frac.y)));
            let low = (vec2(dx, dz) - sides * 0.5) * layer.scale;
            own.x = missed_of_edits(layer, low, low + sides * layer.scale, layer.scale * spacing);
        }
#endif
        // A mask that is missed by so much is open by so much more or less; without one the scale is 0.
        let turned = min(1.5 * missed * abs(layer.mask_scale), 1.0);
        missed += turned * own.y + own.x;
    }
    return missed;
}
