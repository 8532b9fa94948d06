#define_import_path dolomite::terrain::permutation

// The noise of the literature: 256-entry permutation, four gradients. CPU reference:
// plugins/terrain/src/noise/permutation.rs.

#import dolomite::terrain::fixed::{Fixed, coordinate, fraction}
#import dolomite::terrain::noise::{CellGradients, cell_noise}
#import dolomite::terrain::layer::{Layer, OCTAVE_WORDS}
#import dolomite::terrain::bindings::{load_octave, terrain_data}

fn permutation_gradient(permutation: u32, x: u32, z: u32) -> vec2<f32> {
    let column = terrain_data[permutation + (x & 255u)];
    let choice = terrain_data[permutation + ((column + z) & 255u)] & 3u;
    // (1, 1), (-1, 1), (-1, -1), (1, -1)
    return vec2(select(1.0, -1.0, choice == 1u || choice == 2u), select(1.0, -1.0, choice >= 2u));
}

fn permutation_height(layer: Layer, x: Fixed, z: Fixed) -> vec3<f32> {
    let permutation = layer.data + layer.octaves * OCTAVE_WORDS;
    var sum = vec3(0.0);
    for (var k = 0u; k < layer.octaves; k++) {
        let octave = load_octave(layer.data, k);
        let cx = coordinate(x, octave.mantissa, octave.shift);
        let cz = coordinate(z, octave.mantissa, octave.shift);
        let ends = CellGradients(
            vec4(
                permutation_gradient(permutation, cx.whole, cz.whole),
                permutation_gradient(permutation, cx.whole, cz.whole + 1u),
            ),
            vec4(
                permutation_gradient(permutation, cx.whole + 1u, cz.whole),
                permutation_gradient(permutation, cx.whole + 1u, cz.whole + 1u),
            ),
        );
        sum += cell_noise(ends, fraction(cx), fraction(cz)) * vec3(octave.amplitude, octave.slope, octave.slope);
    }
    return sum;
}
