#define_import_path dolomite::detail::unseen

// What samples at a spacing may miss altogether. CPU reference: plugins/terrain/src/bounds/unseen.rs.

#import dolomite::terrain::fixed::{GroundPoint, fixed_metres, fixed_sub, ground_x, ground_z, Fixed}
#import dolomite::terrain::layer::{Layer, BILINEAR, BICUBIC, HILL, EDITS_BILINEAR}
#import dolomite::terrain::edits::missed_of_edits
#import dolomite::terrain::bindings::{terrain, terrain_data, terrain_layers}
#ifdef TERRAIN_TILED
#import dolomite::terrain::clip::clip_missed
#endif

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

// Metres; the rectangle is given by its centre and sides.
fn unseen(centre: GroundPoint, sides: vec2<f32>, spacing: f32) -> f32 {
    var missed = 0.0;
    for (var i = 0u; i < terrain.layer_count; i++) {
        let layer = terrain_layers[i];
        if layer.kind == HILL {
            let dx = fixed_metres(fixed_sub(ground_x(centre), Fixed(bitcast<u32>(layer.origin_cell.x), layer.origin_frac.x)));
            let dz = fixed_metres(fixed_sub(ground_z(centre), Fixed(bitcast<u32>(layer.origin_cell.y), layer.origin_frac.y)));
            let away = max(abs(vec2(dx, dz)) - sides * 0.5, vec2(0.0));
            // scale: 1 / radius, height.
            let near = length(away) * layer.scale.x < 1.0;
            if near && 1.0 < 4.0 * spacing * layer.scale.x {
                missed += abs(layer.scale.y);
            }
        } else if layer.kind == BILINEAR || layer.kind == BICUBIC {
            // scale: samples a metre.
            let apart = max(layer.scale.x, layer.scale.y) * spacing;
            if apart > 1.001 {
                let dx = fixed_metres(fixed_sub(ground_x(centre), Fixed(bitcast<u32>(layer.origin_cell.x), layer.origin_frac.x)));
                let dz = fixed_metres(fixed_sub(ground_z(centre), Fixed(bitcast<u32>(layer.origin_cell.y), layer.origin_frac.y)));
                let low = (vec2(dx, dz) - sides * 0.5) * layer.scale;
                missed += missed_of_map(layer, low, low + sides * layer.scale, apart);
            }
        }
#ifndef TERRAIN_WITHOUT_EDITS
        else if layer.kind >= EDITS_BILINEAR && max(layer.scale.x, layer.scale.y) * spacing > 1.001 {
            let dx = fixed_metres(fixed_sub(ground_x(centre), Fixed(bitcast<u32>(layer.origin_cell.x), layer.origin_frac.x)));
            let dz = fixed_metres(fixed_sub(ground_z(centre), Fixed(bitcast<u32>(layer.origin_cell.y), layer.origin_frac.y)));
            let low = (vec2(dx, dz) - sides * 0.5) * layer.scale;
            missed += missed_of_edits(layer, low, low + sides * layer.scale, layer.scale * spacing);
        }
#endif
    }
    return missed;
}
