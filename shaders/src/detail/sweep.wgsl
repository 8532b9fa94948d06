// Drops blocks of cells that no choice has looked at for long, where nothing hangs on them. A thread a block.
// Cells are looked at from the roots down: what hangs on a block is never younger.

#import dolomite::detail::types::Link
#import dolomite::detail::bindings::{cells, detail, links, GROUP, root_count}
#import dolomite::detail::stock::{put_back, stock}

@compute @workgroup_size(64)
fn sweep(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let last = min(atomicLoad(&stock.used), detail.capacity) / 4u;
    // Roots stay.
    let roots = (root_count() + 3u) / 4u;
    for (var block = roots + id.x; block < last; block += groups.x * GROUP) {
        let first = 4u * block;
        // 0 in a block that is free.
        var kept = links[first].centre.x == 0u;
        for (var k = 0u; k < 4u; k++) {
            kept = kept || links[first + k].children != 0u || cells[first + k].looked >= detail.oldest;
        }
        if kept {
            continue;
        }
        links[links[first].parent].children = 0u;
        for (var k = 0u; k < 4u; k++) {
            links[first + k] = Link(vec2(0u), 0u, 0u);
        }
        put_back(first);
    }
}
