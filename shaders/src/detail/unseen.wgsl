#define_import_path dolomite::detail::unseen

// What samples at a spacing may miss altogether: the twin of plugins/terrain/src/bounds/unseen.rs.

#import dolomite::terrain::fixed::{GroundPoint, fixed_metres, fixed_sub, ground_x, ground_z, Fixed}
#import dolomite::terrain::layer::{BILINEAR, BICUBIC, HILL}
#import dolomite::terrain::bindings::{terrain, terrain_layers}

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
            // scale: samples a metre; erosion: from the lowest to the highest height.
            if max(layer.scale.x, layer.scale.y) * spacing > 1.001 {
                missed += layer.erosion;
            }
        }
    }
    return missed;
}
