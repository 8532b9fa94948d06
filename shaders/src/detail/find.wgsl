#define_import_path dolomite::detail::find

// Finds cells by their places: up from one that is near until it holds the place, then down.

#import dolomite::detail::types::NO_CELL
#import dolomite::detail::bindings::{detail, links, seen}
#import dolomite::detail::lattice::{cell_half, on_lattice}

// The cell at `target`, of half side `half`, if this choice looked at it.
fn find_cell(from_cell: u32, target_centre: vec2<u32>, half: u32) -> u32 {
    if !on_lattice(detail, target_centre) {
        return NO_CELL;
    }
    var at = from_cell;
    var own = links[at].centre;
    var size = cell_half(own);
    let root = 1u << detail.depth;
    loop {
        let low = own - vec2(size);
        // Wraps below.
        if all(target_centre - low < vec2(2u * size)) && size >= half {
            break;
        }
        if size == root {
            let place = target_centre >> vec2(detail.depth + 1u);
            at = place.y * detail.roots.x + place.x;
            own = links[at].centre;
            break;
        }
        at = links[at].parent;
        own = links[at].centre;
        size <<= 1u;
    }
    while size > half {
        let first = links[at].children;
        if first == 0u {
            return NO_CELL;
        }
        let east = target_centre.x > own.x;
        let south = target_centre.y > own.y;
        at = first + select(select(0u, 1u, east), select(3u, 2u, east), south);
        own = links[at].centre;
        size >>= 1u;
    }
    return select(NO_CELL, at, seen[at].stamp == detail.stamp);
}
