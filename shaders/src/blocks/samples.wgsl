#define_import_path dolomite::blocks::samples

// Heights of the bed about the blocks that are made in this frame, a quarter of a cell apart, row by row, from three cells
// before the block on; behind the heights of a block as many errors of the vertices that stand on them.

#import dolomite::detail::bindings::detail

// Cells along a side with a ring of three around; samples along it; of a block.
const WIDE: u32 = 22u;
const WIDE_COUNT: u32 = 484u;
const SAMPLES: u32 = 89u;
const SAMPLE_COUNT: u32 = 7921u;
// Fours of a row, the last not whole; of a block.
const FOURS: u32 = 23u;
const FOUR_COUNT: u32 = 2047u;
// Samples before the block.
const BEFORE_BLOCK: u32 = 12u;

@group(1) @binding(3) var<storage, read_write> samples: array<f32>;

fn sample_row(row: u32) -> u32 {
    return row * (2u * SAMPLE_COUNT);
}

// Height of the drawn surface, and of the bed as far as it is seen.
fn drawn(height: f32) -> vec2<f32> {
    return vec2(max(height, detail.sea), clamp(height, detail.sea - detail.opaque_depth, detail.sea));
}

fn surface(at: u32) -> vec2<f32> {
    return drawn(samples[at]);
}
