#define_import_path dolomite::blocks::locate

// Which drawn triangle lies under a place. Like locate in plugins/ground/src/blocks/locate.rs, but in the world, where the
// triangles are drawn: beside the border of a lattice on the samples of a map the sides of triangles are not straight on it.

#import dolomite::blocks::bindings::{heads, records, seen}
#import dolomite::blocks::border::{moved_x, moved_z}
#import dolomite::blocks::ratio::{BEFORE, Axis, line_along}
#import dolomite::blocks::record::{ERRORS, NEST, NO_BLOCK, number_at}
#import dolomite::blocks::way::{Block, block_at, find_children, way_of}
#import dolomite::detail::bindings::detail
#import dolomite::detail::lattice::{corner_direction, side_direction, times}
#import dolomite::terrain::fixed::{Fixed, GroundPoint, fixed_add, fixed_metres, fixed_sub, ground_x, ground_z}

struct Located {
    // The block that draws the triangle; NO_BLOCK where none is drawn.
    slot: u32,
    // Numbers of its corners.
    corners: vec3<u32>,
    // How far the triangle is from the ground at most where its corners stand on it, metres.
    error: f32,
}

// A square of cells of a block, in half cells.
struct Square {
    centre: vec2<u32>,
    half: u32,
    // At which corner of the larger square it lies.
    quarter: u32,
}

// a < b, both without a sign.
fn below(a: Fixed, b: Fixed) -> bool {
    return a.whole < b.whole || (a.whole == b.whole && a.rest < b.rest);
}

fn line_x(at: u32) -> Fixed {
    return fixed_add(times(detail.step_x, at), moved_x(bitcast<i32>(at)));
}

fn line_z(at: u32) -> Fixed {
    return fixed_add(times(detail.step_z, at), moved_z(bitcast<i32>(at)));
}

// Slot of the root under a place relative to the least corner; NO_BLOCK outside of the ground.
fn root_at(x: Fixed, z: Fixed) -> u32 {
    let shift = detail.depth + 1u;
    // What lies before the least corner has wrapped and lies beyond the far end.
    if below(line_x(detail.roots.x << shift), x) || below(line_z(detail.roots.y << shift), z) {
        return NO_BLOCK;
    }
    var root = vec2(0u);
    for (var bit = 32u; bit > 0u; bit >>= 1u) {
        let next = root | vec2(bit);
        if next.x < detail.roots.x && !below(x, line_x(next.x << shift)) {
            root.x = next.x;
        }
        if next.y < detail.roots.y && !below(z, line_z(next.y << shift)) {
            root.y = next.y;
        }
    }
    // Roots have the slots after the first, row by row.
    return 1u + root.y * detail.roots.x + root.x;
}

fn corner_at(square: Square, corner: u32) -> vec2<u32> {
    return square.centre + corner_direction(corner) * square.half;
}

fn middle_at(square: Square, side: u32) -> vec2<u32> {
    return square.centre + side_direction(side) * square.half;
}

fn child_of(square: Square, quarter: u32) -> Square {
    let half = square.half / 2u;
    return Square(square.centre + corner_direction(quarter) * half, half, quarter);
}

fn error_at(block: Block, at: vec2<u32>) -> f32 {
    return bitcast<f32>(records[block.record + ERRORS + number_at(at)]);
}

fn is_there_at(block: Block, at: vec2<u32>, coarsening: f32) -> bool {
    return way_of(block, number_at(at), coarsening) > 0.0;
}

// From a vertex to a place relative to the view's anchor, metres.
fn from_vertex_at(block: Block, at: vec2<u32>, x: Fixed, z: Fixed) -> vec2<f32> {
    let along = at + vec2(BEFORE);
    return vec2(
        fixed_metres(fixed_sub(x, line_along(block.frame.x, along.x))),
        fixed_metres(fixed_sub(z, line_along(block.frame.z, along.y))),
    );
}

fn cross_of_sides(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

// One of the two halves of a square whose centre is not there.
fn half_of(block: Block, slot: u32, square: Square, x: Fixed, z: Fixed) -> Located {
    let outer = square.quarter;
    let from_outer = from_vertex_at(block, corner_at(square, outer), x, z);
    let from_inner = from_vertex_at(block, corner_at(square, outer + 2u), x, z);
    let from_first = from_vertex_at(block, corner_at(square, outer + 1u), x, z);
    // From the outer corner: along the diagonal, and to the first corner after it.
    let diagonal = from_outer - from_inner;
    let first = from_outer - from_first;
    let same = cross_of_sides(diagonal, from_outer) * cross_of_sides(diagonal, first) >= 0.0;
    let apex = number_at(corner_at(square, outer + select(3u, 1u, same)));
    let ends = vec2(number_at(corner_at(square, outer)), number_at(corner_at(square, outer + 2u)));
    return Located(slot, vec3(apex, ends), error_at(block, square.centre));
}

// The triangle of a square whose centre is there, in a quarter that is no square of its own.
fn side_of_square(block: Block, slot: u32, square: Square, quarter: u32, x: Fixed, z: Fixed, coarsening: f32) -> Located {
    let off = from_vertex_at(block, square.centre, x, z);
    let corner = corner_at(square, quarter);
    let to_corner = off - from_vertex_at(block, corner, x, z);
    // A quarter lies at the end of the side of its number and at the beginning of the next.
    let upright = abs(off.x * to_corner.y) > abs(off.y * to_corner.x);
    let ends = upright == ((quarter & 1u) == 0u);
    let side = select(quarter + 1u, quarter, ends) & 3u;
    let middle = middle_at(square, side);
    let centre = number_at(square.centre);
    let whole = vec3(centre, number_at(corner_at(square, side)), number_at(corner_at(square, side + 3u)));
    if square.half == 1u {
        // The middle is the child's, and errs by less than what it needs.
        return Located(slot, whole, NEST * error_at(block, square.centre));
    }
    if !is_there_at(block, middle, coarsening) {
        return Located(slot, whole, error_at(block, middle));
    }
    let cut = error_at(block, child_of(square, quarter).centre);
    return Located(slot, vec3(centre, number_at(corner), number_at(middle)), cut);
}

fn locate(place: GroundPoint, coarsening: f32) -> Located {
    let nowhere = Located(NO_BLOCK, vec3(0u), 0.0);
    let origin_x = Fixed(bitcast<u32>(detail.origin_cell.x), detail.origin_frac.x);
    let origin_z = Fixed(bitcast<u32>(detail.origin_cell.y), detail.origin_frac.y);
    var slot = root_at(fixed_sub(ground_x(place), origin_x), fixed_sub(ground_z(place), origin_z));
    if slot == NO_BLOCK || seen[slot].stamp != detail.stamp {
        return nowhere;
    }
    let x = fixed_sub(ground_x(place), Fixed(bitcast<u32>(detail.view.anchor.x), 0u));
    let z = fixed_sub(ground_z(place), Fixed(bitcast<u32>(detail.view.anchor.y), 0u));
    var block = block_at(slot);
    var square = Square(vec2(16u), 16u, block.quarter);
    // Blocks are halved 24 times at most, squares four times in each.
    for (var step = 0u; step < 128u; step++) {
        if !is_there_at(block, square.centre, coarsening) {
            return half_of(block, slot, square, x, z);
        }
        let off = from_vertex_at(block, square.centre, x, z);
        let quarter = select(select(0u, 1u, off.x >= 0.0), select(3u, 2u, off.x >= 0.0), off.y >= 0.0);
        if square.half == 16u {
            let children = heads[slot].children;
            if ((find_children(children, coarsening) >> quarter) & 1u) == 1u {
                slot = children[quarter];
                block = block_at(slot);
                square = Square(vec2(16u), 16u, block.quarter);
                continue;
            }
        }
        let is_cell = square.half > 1u && is_there_at(block, middle_at(square, quarter), coarsening)
            && is_there_at(block, middle_at(square, quarter + 1u), coarsening);
        if !is_cell {
            return side_of_square(block, slot, square, quarter, x, z, coarsening);
        }
        square = child_of(square, quarter);
    }
    return nowhere;
}
