// Heights about the blocks that are made. A thread four places of a row, a row of workgroups a block. Heights come from here
// alone, and blocks of one size that have a place in common have it as the same of the four: it has the same bits in both.

#import dolomite::detail::bindings::detail
#import dolomite::detail::lattice::{lattice_point, times}
#import dolomite::blocks::bindings::{heads, lists, made_list}
#import dolomite::blocks::border::{moved_x, moved_z}
#import dolomite::blocks::samples::{BEFORE_BLOCK, FOURS, FOUR_COUNT, SAMPLES, SAMPLE_COUNT, sample_row, samples}
#import dolomite::terrain::fixed::{Fixed, fixed_add, fixed_sub, ground_x, ground_z}
#import dolomite::terrain::four::{Four, four_heights}
#ifdef TERRAIN_TILED
#import dolomite::terrain::clip::{clip_near, ON_SAMPLES}
#endif

// Steps to the east of a place.
fn along(from_x: Fixed, line: i32, steps: u32) -> Fixed {
    return fixed_add(fixed_add(from_x, times(detail.step_x, steps)), moved_x(line + bitcast<i32>(steps)));
}

@compute @workgroup_size(64)
fn sample_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let k = group.x * 64u + thread;
    if k >= FOUR_COUNT {
        return;
    }
    let row = k / FOURS;
    let column = 4u * (k % FOURS);
    let slot = lists[made_list() + group.y];
    let half = heads[slot].half;
    let first = heads[slot].centre - vec2(half);
    let corner = lattice_point(first);
    // The ring of blocks on the border lies before the lattice's first point: steps are taken off the place.
    let step = half / 32u;
    let before = BEFORE_BLOCK * step;
    let west = fixed_sub(ground_x(corner), times(detail.step_x, before));
    let north = fixed_sub(ground_z(corner), times(detail.step_z, before));
    let line = bitcast<vec2<i32>>(first - vec2(before));
    let z = fixed_add(fixed_add(north, times(detail.step_z, row * step)), moved_z(line.y + bitcast<i32>(row * step)));
    let x = Four(
        along(west, line.x, column * step),
        along(west, line.x, (column + 1u) * step),
        along(west, line.x, (column + 2u) * step),
        along(west, line.x, (column + 3u) * step),
    );
#ifdef TERRAIN_TILED
    clip_near = ON_SAMPLES;
#endif
    let heights = four_heights(x, Four(z, z, z, z));
    let at = sample_row(group.y) + row * SAMPLES + column;
    // The last of a row stands alone.
    for (var i = 0u; i < min(4u, SAMPLES - column); i++) {
        samples[at + i] = heights[i];
        // No error of its vertex is known yet.
        samples[at + SAMPLE_COUNT + i] = -1.0;
    }
}
