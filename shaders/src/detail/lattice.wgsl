#define_import_path dolomite::detail::lattice

// Places on the lattice, in integers. CPU reference: plugins/ground/src/detail/lattice.rs, where
// sides, corners and quarters are defined. Coordinates are unsigned and wrap.

#import dolomite::detail::bindings::detail
#import dolomite::terrain::fixed::{Fixed, GroundPoint, fixed_add, ground_point, mul_wide}

// 1 or -1 (as u32) along x and z towards a corner.
fn corner_direction(corner: u32) -> vec2<u32> {
    let k = corner & 3u;
    let minus = 0xffffffffu;
    return vec2(select(minus, 1u, k == 1u || k == 2u), select(minus, 1u, k >= 2u));
}

fn side_direction(side: u32) -> vec2<u32> {
    let k = side & 3u;
    let minus = 0xffffffffu;
    if (k & 1u) == 0u {
        return vec2(select(minus, 1u, k == 2u), 0u);
    }
    return vec2(0u, select(minus, 1u, k == 3u));
}

fn cell_corner(centre: vec2<u32>, half: u32, corner: u32) -> vec2<u32> {
    return centre + corner_direction(corner) * half;
}

fn on_lattice(centre: vec2<u32>) -> bool {
    return all(centre < (detail.roots << vec2(detail.depth + 1u)));
}

fn times(step: vec2<u32>, at: u32) -> Fixed {
    let low = mul_wide(step.y, at);
    return Fixed(low.y + step.x * at, low.x);
}

// World place of a lattice point.
fn lattice_point(at: vec2<u32>) -> GroundPoint {
    let x = Fixed(bitcast<u32>(detail.origin_cell.x), detail.origin_frac.x);
    let z = Fixed(bitcast<u32>(detail.origin_cell.y), detail.origin_frac.y);
    return ground_point(fixed_add(x, times(detail.step_x, at.x)), fixed_add(z, times(detail.step_z, at.y)));
}
