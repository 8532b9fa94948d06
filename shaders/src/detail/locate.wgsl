#define_import_path dolomite::detail::locate

// Which drawn triangle lies under a place. CPU reference: locate in
// plugins/ground/src/detail/probe.rs. The walk goes down from a root by comparing fixed-point
// numbers, so that it is exact at any distance from the origin.

#import dolomite::detail::bindings::{cells, detail, links, seen}
#import dolomite::detail::lattice::{cell_half, cell_quarter, corner_direction, times}
#import dolomite::detail::types::{NO_CELL, cell_quarters}
#import dolomite::detail::vertices::{CENTRE, Vertex, appears, corner_of, is_drawn, middle_of}
#import dolomite::terrain::fixed::{Fixed, GroundPoint, fixed_metres, fixed_sub, ground_x, ground_z}

struct Located {
    // The cell that draws the triangle; NO_CELL where none is drawn.
    cell: u32,
    // Its corners, counter-clockwise seen from above.
    corners: array<Vertex, 3>,
    // How far the triangle is from the ground at most where its corners stand on it, metres.
    error: f32,
}

fn nowhere() -> Located {
    let none = Vertex(0u, 0u);
    return Located(NO_CELL, array(none, none, none), 0.0);
}

// a < b, both without a sign.
fn below(a: Fixed, b: Fixed) -> bool {
    return a.whole < b.whole || (a.whole == b.whole && a.rest < b.rest);
}

// The last root along an axis that begins at the place or before it; `count` is 64 at most.
fn root_along(place: Fixed, step: vec2<u32>, count: u32) -> u32 {
    var root = 0u;
    for (var bit = 32u; bit > 0u; bit >>= 1u) {
        let next = root | bit;
        if next < count && !below(place, times(step, next << (detail.depth + 1u))) {
            root = next;
        }
    }
    return root;
}

// The triangle of a root that stays two; `off` is relative to its centre, in half sides.
fn of_root(at: u32, centre: vec2<u32>, half: u32, off: vec2<f32>) -> Located {
    let outer = cell_quarter(centre, half);
    var corners: array<Vertex, 4>;
    for (var k = 0u; k < 4u; k++) {
        corners[k] = corner_of(at, outer + k);
    }
    // On which side of the diagonal through corner `outer` the place is, and corner `outer` + 1.
    let along = vec2<f32>(bitcast<vec2<i32>>(corner_direction(outer)));
    let first = vec2<f32>(bitcast<vec2<i32>>(corner_direction(outer + 1u)));
    let place_side = off.x * along.y - off.y * along.x;
    let first_side = first.x * along.y - first.y * along.x;
    let error = cells[at].error;
    if place_side * first_side >= 0.0 {
        return Located(at, array(corners[2], corners[1], corners[0]), error);
    }
    return Located(at, array(corners[0], corners[3], corners[2]), error);
}

// The triangle of a cell that is drawn, in its quarter `quarter`, which is no cell of its own.
fn of_cell(at: u32, quarter: u32, off: vec2<f32>) -> Located {
    // A quarter lies at the end of the side of its number and at the beginning of the next.
    let upright = abs(off.x) > abs(off.y);
    let ends = upright == ((quarter & 1u) == 0u);
    let side = select(quarter + 1u, quarter, ends) & 3u;
    let middle = Vertex(at, CENTRE);
    if seen[at].middles[side] <= appears() {
        let corners = array(middle, corner_of(at, side), corner_of(at, side + 3u));
        return Located(at, corners, cell_quarters(cells[at])[side]);
    }
    // Half of it: one of the two triangles of the quarter as a cell.
    let children = links[at].children;
    var error = cells[at].finer;
    if children != 0u {
        error = cells[children + quarter].error;
    }
    let corner = corner_of(at, quarter);
    let mid = middle_of(at, side);
    if ends {
        return Located(at, array(middle, corner, mid), error);
    }
    return Located(at, array(middle, mid, corner), error);
}

fn locate(place: GroundPoint) -> Located {
    let x = fixed_sub(ground_x(place), Fixed(bitcast<u32>(detail.origin_cell.x), detail.origin_frac.x));
    let z = fixed_sub(ground_z(place), Fixed(bitcast<u32>(detail.origin_cell.y), detail.origin_frac.y));
    let size = detail.roots << vec2(detail.depth + 1u);
    // What lies before the origin has wrapped and lies beyond the far end.
    if below(times(detail.step_x, size.x), x) || below(times(detail.step_z, size.y), z) {
        return nowhere();
    }
    var at = root_along(z, detail.step_z, detail.roots.y) * detail.roots.x + root_along(x, detail.step_x, detail.roots.x);
    if seen[at].stamp != detail.stamp {
        return nowhere();
    }
    var found = nowhere();
    loop {
        let centre = links[at].centre;
        let half = cell_half(centre);
        let from_centre = vec2(
            fixed_metres(fixed_sub(x, times(detail.step_x, centre.x))),
            fixed_metres(fixed_sub(z, times(detail.step_z, centre.y))),
        );
        let off = from_centre / vec2(fixed_metres(times(detail.step_x, half)), fixed_metres(times(detail.step_z, half)));
        let whole = seen[at].centre <= appears();
        let quarter = select(select(0u, 1u, off.x >= 0.0), select(3u, 2u, off.x >= 0.0), off.y >= 0.0);
        if !whole && is_drawn(links[at].children, quarter) {
            at = links[at].children + quarter;
            continue;
        }
        if seen[at].seen == 0u {
            break;
        }
        if whole {
            found = of_root(at, centre, half, off);
        } else {
            found = of_cell(at, quarter, off);
        }
        break;
    }
    return found;
}
