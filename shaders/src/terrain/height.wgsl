#define_import_path dolomite::terrain::height

// The height function: height (metres) and gradient at a ground point. CPU reference:
// `Terrain::sample` in plugins/terrain/src/terrain.rs.

#import dolomite::terrain::fixed::{Fixed, GroundPoint, fixed_metres, fixed_sub, ground_x, ground_z}
#import dolomite::terrain::layer::{Layer, ERODED, CLASSIC, BILINEAR, BICUBIC, HILL, EDITS_BILINEAR}
#import dolomite::terrain::bindings::{terrain, terrain_layers}
#import dolomite::terrain::fractal::fractal_height
#import dolomite::terrain::permutation::permutation_height
#import dolomite::terrain::height_map::map_height
#import dolomite::terrain::edits::edits_height

// height * (1 - r^2/R^2)^3 within R.
fn hill_height(layer: Layer, x: Fixed, z: Fixed) -> vec3<f32> {
    let dx = fixed_metres(fixed_sub(x, Fixed(bitcast<u32>(layer.origin_cell.x), layer.origin_frac.x)));
    let dz = fixed_metres(fixed_sub(z, Fixed(bitcast<u32>(layer.origin_cell.y), layer.origin_frac.y)));
    let d = vec2(dx, dz) * layer.scale.x;
    let rest = max(1.0 - dot(d, d), 0.0);
    let square = rest * rest;
    return vec3(layer.scale.y * square * rest, d * (-6.0 * layer.scale.y * layer.scale.x * square));
}

// below + s(t) * added, gradient by product and chain rule.
fn masked(layer: Layer, below: vec3<f32>, added: vec3<f32>) -> vec3<f32> {
    if layer.mask_scale == 0.0 {
        return below + added;
    }
    let t = clamp((below.x - layer.mask_low) * layer.mask_scale, 0.0, 1.0);
    let step = t * t * (3.0 - 2.0 * t);
    let slope = 6.0 * t * (1.0 - t) * layer.mask_scale;
    return vec3(below.x + step * added.x, below.yz * (1.0 + slope * added.x) + added.yz * step);
}

// Height, d/dx, d/dz.
fn terrain_height(p: GroundPoint) -> vec3<f32> {
    let x = ground_x(p);
    let z = ground_z(p);
    var height = vec3(terrain.base, 0.0, 0.0);
    for (var i = 0u; i < terrain.layer_count; i++) {
        let layer = terrain_layers[i];
        var added = vec3(0.0);
        // Whoever knows that a terrain has no layer of a kind leaves it out: software Vulkan runs all sides of a
        // branch.
#ifndef TERRAIN_WITHOUT_FRACTALS
        if layer.kind <= ERODED {
            added = fractal_height(layer, x, z);
        }
#endif
#ifndef TERRAIN_WITHOUT_CLASSIC
        if layer.kind == CLASSIC {
            added = permutation_height(layer, x, z);
        }
#endif
#ifndef TERRAIN_WITHOUT_MAPS
        if layer.kind == BILINEAR || layer.kind == BICUBIC {
            added = map_height(layer, x, z);
        }
#endif
#ifndef TERRAIN_WITHOUT_HILLS
        if layer.kind == HILL {
            added = hill_height(layer, x, z);
        }
#endif
#ifndef TERRAIN_WITHOUT_EDITS
        if layer.kind >= EDITS_BILINEAR {
            added = edits_height(layer, x, z);
        }
#endif
        height = masked(layer, height, added);
    }
    return height;
}
