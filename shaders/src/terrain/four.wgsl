#define_import_path dolomite::terrain::four

// Heights of four places at once: the height of height.wgsl, term by term, without its gradient. What is read of the
// terrain is read once for the four: on software Vulkan reading an octave takes longer than evaluating it. CPU reference:
// `Terrain::sample` in plugins/terrain/src/terrain.rs.

#import dolomite::terrain::bindings::{load_octave, terrain, terrain_layers}
#import dolomite::terrain::edits::edits_height
#import dolomite::terrain::fixed::{Fixed, fixed_add, metres_fixed}
#import dolomite::terrain::fractal::{octave_cell, smooth_abs}
#import dolomite::terrain::height::hill_height
#import dolomite::terrain::height_map::map_height
#import dolomite::terrain::layer::{BICUBIC, BILINEAR, BILLOW, CLASSIC, EDITS_BILINEAR, ERODED, FBM, HILL, Layer, OCTAVE_WORDS, Octave, RIDGED}
#import dolomite::terrain::noise::cell_noise
#import dolomite::terrain::permutation::permutation_height

// One axis of four places.
struct Four {
    a: Fixed,
    b: Fixed,
    c: Fixed,
    d: Fixed,
}

// Value and slope of an octave, one component a place.
struct FourNoise {
    value: vec4<f32>,
    dx: vec4<f32>,
    dz: vec4<f32>,
}

fn four_moved(at: Four, metres: vec4<f32>) -> Four {
    return Four(
        fixed_add(at.a, metres_fixed(metres.x)),
        fixed_add(at.b, metres_fixed(metres.y)),
        fixed_add(at.c, metres_fixed(metres.z)),
        fixed_add(at.d, metres_fixed(metres.w)),
    );
}

fn noise_at(octave: Octave, x: Fixed, z: Fixed) -> vec3<f32> {
    let cell = octave_cell(octave, x, z);
    return cell_noise(cell.ends, cell.fx, cell.fz);
}

fn four_noise(octave: Octave, x: Four, z: Four) -> FourNoise {
    let a = noise_at(octave, x.a, z.a);
    let b = noise_at(octave, x.b, z.b);
    let c = noise_at(octave, x.c, z.c);
    let d = noise_at(octave, x.d, z.d);
    return FourNoise(vec4(a.x, b.x, c.x, d.x), vec4(a.y, b.y, c.y, d.y), vec4(a.z, b.z, c.z, d.z));
}

fn four_smooth_abs(n: vec4<f32>) -> vec4<f32> {
    return vec4(smooth_abs(n.x).x, smooth_abs(n.y).x, smooth_abs(n.z).x, smooth_abs(n.w).x);
}

fn four_fbm(table: u32, octaves: u32, x: Four, z: Four) -> vec4<f32> {
    var sum = vec4(0.0);
    for (var k = 0u; k < octaves; k++) {
        let octave = load_octave(table, k);
        sum += four_noise(octave, x, z).value * octave.amplitude;
    }
    return sum;
}

// All kinds of sums in one loop: what differs is a few operations, and software Vulkan would go round one loop a kind.
fn four_sum(layer: Layer, x: Four, z: Four) -> vec4<f32> {
    var sum = vec4(0.0);
    // Ridged: the last octave's squared ridge. Eroded: slope gathered so far, in units of the first octave's.
    var ridge_weight = vec4(1.0);
    var gx = vec4(0.0);
    var gz = vec4(0.0);
    for (var k = 0u; k < layer.octaves; k++) {
        let octave = load_octave(layer.data, k);
        let n = four_noise(octave, x, z);
        let size = four_smooth_abs(n.value);
        let ridge = vec4(1.0) - size;
        let square = ridge * ridge;
        gx += n.dx * octave.relative;
        gz += n.dz * octave.relative;
        let worn = vec4(1.0) / ((gx * gx + gz * gz) * layer.erosion + vec4(1.0));
        var term = n.value * worn * octave.amplitude;
        term = select(term, n.value * octave.amplitude, layer.kind == FBM);
        term = select(term, square * ridge_weight * octave.amplitude, layer.kind == RIDGED);
        term = select(term, (size * 2.0 - vec4(1.0)) * octave.amplitude, layer.kind == BILLOW);
        sum += term;
        ridge_weight = square;
    }
    return sum;
}

fn four_fractals(layer: Layer, x: Four, z: Four) -> vec4<f32> {
    if layer.warp_octaves == 0u {
        return four_sum(layer, x, z);
    }
    let wx = four_fbm(layer.warp_data, layer.warp_octaves, x, z);
    let wz = four_fbm(layer.warp_data + layer.warp_octaves * OCTAVE_WORDS, layer.warp_octaves, x, z);
    return four_sum(layer, four_moved(x, wx), four_moved(z, wz));
}

fn four_masked(layer: Layer, below: vec4<f32>, added: vec4<f32>) -> vec4<f32> {
    let t = clamp((below - vec4(layer.mask_low)) * layer.mask_scale, vec4(0.0), vec4(1.0));
    let step = t * t * (vec4(3.0) - 2.0 * t);
    return below + select(step * added, added, layer.mask_scale == 0.0);
}

fn four_heights(x: Four, z: Four) -> vec4<f32> {
    var height = vec4(terrain.base);
    for (var i = 0u; i < terrain.layer_count; i++) {
        let layer = terrain_layers[i];
        var added = vec4(0.0);
        // As in height.wgsl.
#ifndef TERRAIN_WITHOUT_FRACTALS
        if layer.kind <= ERODED {
            added = four_fractals(layer, x, z);
        }
#endif
#ifndef TERRAIN_WITHOUT_CLASSIC
        if layer.kind == CLASSIC {
            added = vec4(
                permutation_height(layer, x.a, z.a).x,
                permutation_height(layer, x.b, z.b).x,
                permutation_height(layer, x.c, z.c).x,
                permutation_height(layer, x.d, z.d).x,
            );
        }
#endif
#ifndef TERRAIN_WITHOUT_MAPS
        if layer.kind == BILINEAR || layer.kind == BICUBIC {
            added = vec4(
                map_height(layer, x.a, z.a).x,
                map_height(layer, x.b, z.b).x,
                map_height(layer, x.c, z.c).x,
                map_height(layer, x.d, z.d).x,
            );
        }
#endif
#ifndef TERRAIN_WITHOUT_HILLS
        if layer.kind == HILL {
            added = vec4(
                hill_height(layer, x.a, z.a).x,
                hill_height(layer, x.b, z.b).x,
                hill_height(layer, x.c, z.c).x,
                hill_height(layer, x.d, z.d).x,
            );
        }
#endif
#ifndef TERRAIN_WITHOUT_EDITS
        if layer.kind >= EDITS_BILINEAR {
            added = vec4(
                edits_height(layer, x.a, z.a).x,
                edits_height(layer, x.b, z.b).x,
                edits_height(layer, x.c, z.c).x,
                edits_height(layer, x.d, z.d).x,
            );
        }
#endif
        height = four_masked(layer, height, added);
    }
    return height;
}
