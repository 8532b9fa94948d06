#define_import_path dolomite::blocks::counting

// The coarsenings for which vertices are counted: half octaves up to 11.3, then steps of 4.

const COARSENINGS: u32 = 16u;

fn coarsening_of(k: u32) -> f32 {
    return exp2(select(f32(2 * i32(k) - 12), 0.5 * f32(k), k < 8u));
}
