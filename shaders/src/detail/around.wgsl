#define_import_path dolomite::detail::around

// The cells around a cell, from those around its parent: what find them in the tree would be walks.

#import dolomite::detail::types::{APPEARS, NO_CELL}
#import dolomite::detail::bindings::{detail, links, seen}

// A quarter of a cell of the last depth, if it is looked at.
fn quarter_of(cell: u32, corner: u32) -> u32 {
    if cell == NO_CELL {
        return NO_CELL;
    }
    let first = links[cell].children;
    if first == 0u || seen[cell].centre <= APPEARS {
        return NO_CELL;
    }
    return first + (corner & 3u);
}

fn root_at(x: u32, z: u32) -> u32 {
    // Wraps below.
    return select(NO_CELL, z * detail.roots.x + x, x < detail.roots.x && z < detail.roots.y);
}

// All roots are looked at.
fn find_around_root(at: u32) {
    let x = at % detail.roots.x;
    let z = at / detail.roots.x;
    seen[at].beside = vec4(root_at(x - 1u, z), root_at(x, z - 1u), root_at(x + 1u, z), root_at(x, z + 1u));
    seen[at].across = vec4(
        root_at(x - 1u, z - 1u),
        root_at(x + 1u, z - 1u),
        root_at(x + 1u, z + 1u),
        root_at(x - 1u, z + 1u),
    );
}

// Of the quarter at corner q of its parent, blocks being aligned. Sides q and q + 1 are the parent's; beyond
// the others, and beyond corner q + 2, lie quarters of the same parent.
fn find_around(at: u32, parent: u32) {
    let q = at & 3u;
    let first = at - q;
    let q1 = (q + 1u) & 3u;
    let q2 = (q + 2u) & 3u;
    let q3 = (q + 3u) & 3u;
    let here = seen[parent].beside[q];
    let next = seen[parent].beside[q1];
    seen[at].beside[q] = quarter_of(here, q1);
    seen[at].beside[q1] = quarter_of(next, q3);
    seen[at].beside[q2] = first + q1;
    seen[at].beside[q3] = first + q3;
    seen[at].across[q] = quarter_of(seen[parent].across[q], q2);
    seen[at].across[q1] = quarter_of(next, q2);
    seen[at].across[q2] = first + q2;
    seen[at].across[q3] = quarter_of(here, q2);
}
