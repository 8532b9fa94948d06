#define_import_path dolomite::blocks::border

// Lines of a lattice whose outermost columns and rows may have another width: along and point in
// plugins/ground/src/detail/lattice.rs. Lines count from the first, and may lie before it; all arithmetic wraps.

#import dolomite::detail::bindings::detail
#import dolomite::detail::lattice::times
#import dolomite::terrain::fixed::{Fixed, GroundPoint, fixed_add, fixed_metres, fixed_sub, ground_point}

// step * at.
fn signed_times(step: vec2<u32>, at: i32) -> Fixed {
    let product = times(step, bitcast<u32>(at));
    // A negative number was taken 2^32 too large.
    return Fixed(product.whole - select(0u, step.y, at < 0), product.rest);
}

// The line from which on the last column or row is, of so many roots.
fn last_begin(roots: u32) -> i32 {
    return bitcast<i32>(roots << (detail.depth + 1u)) - bitcast<i32>(detail.border);
}

// How far a line is moved by what is longer before it.
fn moved(at: i32, roots: u32, first: vec2<u32>, last: vec2<u32>) -> Fixed {
    let before = signed_times(first, min(at, bitcast<i32>(detail.border)));
    return fixed_add(before, signed_times(last, max(at - last_begin(roots), 0)));
}

fn moved_x(at: i32) -> Fixed {
    return moved(at, detail.roots.x, detail.first_x, detail.last_x);
}

fn moved_z(at: i32) -> Fixed {
    return moved(at, detail.roots.y, detail.first_z, detail.last_z);
}

// World place of a lattice point.
fn border_point(at: vec2<u32>) -> GroundPoint {
    let x = fixed_add(Fixed(bitcast<u32>(detail.origin_cell.x), detail.origin_frac.x), times(detail.step_x, at.x));
    let z = fixed_add(Fixed(bitcast<u32>(detail.origin_cell.y), detail.origin_frac.y), times(detail.step_z, at.y));
    let at_line = bitcast<vec2<i32>>(at);
    return ground_point(fixed_add(x, moved_x(at_line.x)), fixed_add(z, moved_z(at_line.y)));
}

// From one lattice point to another, metres.
fn metres_between(from_at: vec2<i32>, to_at: vec2<i32>) -> vec2<f32> {
    let lines = to_at - from_at;
    let x = fixed_add(signed_times(detail.step_x, lines.x), fixed_sub(moved_x(to_at.x), moved_x(from_at.x)));
    let z = fixed_add(signed_times(detail.step_z, lines.y), fixed_sub(moved_z(to_at.y), moved_z(from_at.y)));
    return vec2(fixed_metres(x), fixed_metres(z));
}
