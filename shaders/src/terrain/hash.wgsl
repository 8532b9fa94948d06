#define_import_path dolomite::terrain::hash

// Integer hash, exact on every processor: PCG as in Jarzynski and Olano, "Hash Functions for GPU
// Rendering", JCGT 9(3), 2020. CPU reference: plugins/terrain/src/noise/hash.rs.

fn pcg(word: u32) -> u32 {
    let state = word * 747796405u + 2891336453u;
    let mixed = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (mixed >> 22u) ^ mixed;
}

// Two signed 16-bit halves in -1 up to 1, high half first: both steps are exact.
fn halves(word: u32) -> vec2<f32> {
    let high = bitcast<i32>(word) >> 16u;
    let low = bitcast<i32>(word << 16u) >> 16u;
    return vec2(f32(high), f32(low)) * 3.0517578125e-5; // 2^-15
}
