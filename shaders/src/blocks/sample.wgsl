// Heights about the blocks that are made. A thread a place, a row of workgroups a block. Heights come from here alone: what
// two blocks have in common has the same bits.

#import dolomite::detail::bindings::detail
#import dolomite::detail::lattice::{lattice_point, times}
#import dolomite::blocks::bindings::{heads, lists, made_list}
#import dolomite::blocks::border::{moved_x, moved_z}
#import dolomite::blocks::samples::{BEFORE_BLOCK, SAMPLES, SAMPLE_COUNT, sample_row, samples}
#import dolomite::terrain::fixed::{fixed_add, fixed_sub, ground_point, ground_x, ground_z}
#import dolomite::terrain::height::terrain_height

@compute @workgroup_size(64)
fn sample_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let k = group.x * 64u + thread;
    if k >= SAMPLE_COUNT {
        return;
    }
    let slot = lists[made_list() + group.y];
    let half = heads[slot].half;
    let corner = lattice_point(heads[slot].centre - vec2(half));
    // The ring of blocks on the border lies before the lattice's first point: steps are taken off the place.
    let step = half / 32u;
    let before = BEFORE_BLOCK * step;
    let x = fixed_add(fixed_sub(ground_x(corner), times(detail.step_x, before)), times(detail.step_x, k % SAMPLES * step));
    let z = fixed_add(fixed_sub(ground_z(corner), times(detail.step_z, before)), times(detail.step_z, k / SAMPLES * step));
    let line = bitcast<vec2<i32>>(heads[slot].centre - vec2(half) + vec2(k % SAMPLES, k / SAMPLES) * step - vec2(before));
    let place = ground_point(fixed_add(x, moved_x(line.x)), fixed_add(z, moved_z(line.y)));
    samples[sample_row(group.y) + k] = terrain_height(place).x;
    // No error of its vertex is known yet.
    samples[sample_row(group.y) + SAMPLE_COUNT + k] = -1.0;
}
