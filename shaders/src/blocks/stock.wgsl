#define_import_path dolomite::blocks::stock

// Which slots are in use: those below `used`, but for the free ones.

struct Stock {
    used: u32,
    free: atomic<u32>,
    pad_a: u32,
    pad_b: u32,
    // The free ones.
    slots: array<u32>,
}

@group(1) @binding(2) var<storage, read_write> stock: Stock;
