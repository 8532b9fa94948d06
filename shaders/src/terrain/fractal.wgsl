#define_import_path dolomite::terrain::fractal

// Sums of octaves: value (metres) and gradient in xyz. CPU reference: plugins/terrain/src/noise/sum.rs
// and scalar.rs, where the sums are defined.

#import dolomite::terrain::fixed::{Fixed, coordinate, fixed_add, fraction, metres_fixed}
#import dolomite::terrain::noise::{CellGradients, NoiseSample, cell_gradients, cell_noise, cell_noise_bent}
#import dolomite::terrain::layer::{Layer, Octave, FBM, RIDGED, BILLOW, OCTAVE_WORDS}
#import dolomite::terrain::bindings::load_octave

// Square of the rounding of |n|: (1/32)^2.
const SMOOTH_SQUARED: f32 = 0.0009765625;

struct Cell {
    ends: CellGradients,
    fx: f32,
    fz: f32,
}

fn octave_cell(octave: Octave, x: Fixed, z: Fixed) -> Cell {
    let cx = fixed_add(coordinate(x, octave.mantissa, octave.shift), Fixed(octave.offset_x.x, octave.offset_x.y));
    let cz = fixed_add(coordinate(z, octave.mantissa, octave.shift), Fixed(octave.offset_z.x, octave.offset_z.y));
    return Cell(cell_gradients(cx.whole, cz.whole, octave.seed), fraction(cx), fraction(cz));
}

// sqrt(n^2 + eps^2) and its derivative.
fn smooth_abs(n: f32) -> vec2<f32> {
    let size = sqrt(n * n + SMOOTH_SQUARED);
    return vec2(size, n / size);
}

fn fbm(table: u32, octaves: u32, x: Fixed, z: Fixed) -> vec3<f32> {
    var sum = vec3(0.0);
    for (var k = 0u; k < octaves; k++) {
        let octave = load_octave(table, k);
        let cell = octave_cell(octave, x, z);
        sum += cell_noise(cell.ends, cell.fx, cell.fz) * vec3(octave.amplitude, octave.slope, octave.slope);
    }
    return sum;
}

fn billow(table: u32, octaves: u32, x: Fixed, z: Fixed) -> vec3<f32> {
    var sum = vec3(0.0);
    for (var k = 0u; k < octaves; k++) {
        let octave = load_octave(table, k);
        let cell = octave_cell(octave, x, z);
        let n = cell_noise(cell.ends, cell.fx, cell.fz);
        let size = smooth_abs(n.x);
        sum += vec3((size.x * 2.0 - 1.0) * octave.amplitude, n.yz * (size.y * 2.0 * octave.slope));
    }
    return sum;
}

fn ridged(table: u32, octaves: u32, x: Fixed, z: Fixed) -> vec3<f32> {
    var sum = vec3(0.0);
    // The last octave's squared ridge and its gradient weigh the next.
    var weight = vec3(1.0, 0.0, 0.0);
    for (var k = 0u; k < octaves; k++) {
        let octave = load_octave(table, k);
        let cell = octave_cell(octave, x, z);
        let n = cell_noise(cell.ends, cell.fx, cell.fz);
        let size = smooth_abs(n.x);
        let ridge = 1.0 - size.x;
        let square = ridge * ridge;
        let slope = n.yz * (ridge * size.y * (-2.0 * octave.frequency));
        sum += vec3(square * weight.x, slope * weight.x + square * weight.yz) * octave.amplitude;
        weight = vec3(square, slope);
    }
    return sum;
}

fn eroded(table: u32, octaves: u32, erosion: f32, x: Fixed, z: Fixed) -> vec3<f32> {
    var sum = vec3(0.0);
    // Slope gathered so far, in units of the first octave's, and its derivatives.
    var g = vec2(0.0);
    var bend = vec3(0.0);
    for (var k = 0u; k < octaves; k++) {
        let octave = load_octave(table, k);
        let cell = octave_cell(octave, x, z);
        let n = cell_noise_bent(cell.ends, cell.fx, cell.fz);
        g += n.first.yz * octave.relative;
        bend += n.second * (octave.relative * octave.frequency);
        let weight = 1.0 / (dot(g, g) * erosion + 1.0);
        let fall = n.first.x * (weight * weight) * (-2.0 * erosion * octave.amplitude);
        let steep = weight * octave.slope;
        sum += vec3(
            n.first.x * weight * octave.amplitude,
            n.first.yz * steep + vec2(bend.x * g.x + bend.y * g.y, bend.y * g.x + bend.z * g.y) * fall,
        );
    }
    return sum;
}

fn layer_sum(layer: Layer, x: Fixed, z: Fixed) -> vec3<f32> {
    switch layer.kind {
        case FBM: { return fbm(layer.data, layer.octaves, x, z); }
        case RIDGED: { return ridged(layer.data, layer.octaves, x, z); }
        case BILLOW: { return billow(layer.data, layer.octaves, x, z); }
        default: { return eroded(layer.data, layer.octaves, layer.erosion, x, z); }
    }
}

// A fractal layer; a warp moves the position first, the chain rule follows.
fn fractal_height(layer: Layer, x: Fixed, z: Fixed) -> vec3<f32> {
    if layer.warp_octaves == 0u {
        return layer_sum(layer, x, z);
    }
    let wx = fbm(layer.warp_data, layer.warp_octaves, x, z);
    let wz = fbm(layer.warp_data + layer.warp_octaves * OCTAVE_WORDS, layer.warp_octaves, x, z);
    let h = layer_sum(layer, fixed_add(x, metres_fixed(wx.x)), fixed_add(z, metres_fixed(wz.x)));
    return vec3(
        h.x,
        h.y + (h.y * wx.y + h.z * wz.y),
        h.z + (h.y * wx.z + h.z * wz.z),
    );
}
