// Numbers of the vertices of all cells that are drawn, after the corners of the roots. A thread a cell.

#import dolomite::detail::bindings::{counts, seen, GROUP, KEPT, VERTICES, kept_cell}
#import dolomite::detail::room::corner_count
#import dolomite::detail::vertices::{appears, owned}

@compute @workgroup_size(64)
fn number_vertices(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let last = atomicLoad(&counts[KEPT]);
    for (var k = id.x; k < last; k += groups.x * GROUP) {
        let at = kept_cell(k);
        if seen[at].centre <= appears() {
            continue;
        }
        let own = owned(at);
        seen[at].own = own;
        seen[at].first = corner_count() + atomicAdd(&counts[VERTICES], 1u + countOneBits(own));
    }
}
