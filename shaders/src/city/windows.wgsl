#define_import_path dolomite::city::windows

// Which windows are lit: the integers of plugins/city/src/windows.rs.

#import dolomite::terrain::hash::pcg

fn cell_hash(seed: u32, cell: vec2<i32>) -> u32 {
    return pcg(pcg(pcg(seed) + bitcast<u32>(cell.y)) + bitcast<u32>(cell.x));
}

fn window_hash(seed: u32, cell: vec2<i32>, lot: u32, side: u32, column: u32, storey: u32) -> u32 {
    return pcg(cell_hash(seed, cell) + (lot | (side << 2u) | (column << 4u) | (storey << 16u)));
}

// Compared with a limit of 24 bits.
fn lit_number(window: u32, hour: u32) -> u32 {
    let by_hour = pcg(window ^ pcg(hour));
    return ((window >> 8u) * 3u + (by_hour >> 8u)) >> 2u;
}
