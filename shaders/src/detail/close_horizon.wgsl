// What a layer of the horizon hides, those beyond it hide as well. A thread a column.

#import dolomite::detail::bindings::{counts, HORIZON}
#import dolomite::detail::horizon::{COLUMNS, LAYERS}

const GROUP: u32 = 64u;

@compute @workgroup_size(64)
fn close_horizon(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    for (var column = id.x; column < COLUMNS; column += groups.x * GROUP) {
        var steepest = 0u;
        for (var layer = 0u; layer < LAYERS; layer++) {
            let at = HORIZON + layer * COLUMNS + column;
            steepest = max(steepest, atomicLoad(&counts[at]));
            atomicStore(&counts[at], steepest);
        }
    }
}
