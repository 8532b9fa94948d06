#define_import_path dolomite::terrain::bindings

// The height function as plugins/terrain/src/gpu_layout.rs lays it out.

#import dolomite::terrain::layer::{Layer, Octave, TerrainUniform, OCTAVE_WORDS}

@group(1) @binding(0) var<storage, read> terrain_layers: array<Layer>;
@group(1) @binding(1) var<storage, read> terrain_data: array<u32>;
@group(1) @binding(2) var<uniform> terrain: TerrainUniform;

fn load_octave(table: u32, index: u32) -> Octave {
    let at = table + index * OCTAVE_WORDS;
    return Octave(
        terrain_data[at],
        terrain_data[at + 1u],
        terrain_data[at + 2u],
        vec2(terrain_data[at + 3u], terrain_data[at + 4u]),
        vec2(terrain_data[at + 5u], terrain_data[at + 6u]),
        bitcast<f32>(terrain_data[at + 7u]),
        bitcast<f32>(terrain_data[at + 8u]),
        bitcast<f32>(terrain_data[at + 9u]),
        bitcast<f32>(terrain_data[at + 10u]),
    );
}

// Sample of a map, clamped at its borders, metres.
fn load_sample(layer: Layer, column: i32, row: i32) -> f32 {
    let x = u32(clamp(column, 0, i32(layer.size.x) - 1));
    let z = u32(clamp(row, 0, i32(layer.size.y) - 1));
    return bitcast<f32>(terrain_data[layer.data + z * layer.size.x + x]);
}
