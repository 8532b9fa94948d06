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

fn cell_half(centre: vec2<u32>) -> u32 {
    return 1u << countTrailingZeros(centre.x);
}

fn cell_corner(centre: vec2<u32>, half: u32, corner: u32) -> vec2<u32> {
    return centre + corner_direction(corner) * half;
}

fn cell_side_mid(centre: vec2<u32>, half: u32, side: u32) -> vec2<u32> {
    return centre + side_direction(side) * half;
}

// At which corner of its parent a cell lies.
fn cell_quarter(centre: vec2<u32>, half: u32) -> u32 {
    let upper = (centre / half) & vec2(2u);
    let east = upper.x != 0u;
    let south = upper.y != 0u;
    if south {
        return select(3u, 2u, east);
    }
    return select(0u, 1u, east);
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

// Sides of a cell, metres.
fn cell_sides(half: u32) -> vec2<f32> {
    let step = vec2(
        f32(detail.step_x.x) + f32(detail.step_x.y) * 2.3283064e-10,
        f32(detail.step_z.x) + f32(detail.step_z.y) * 2.3283064e-10,
    );
    return step * (2.0 * f32(half));
}
