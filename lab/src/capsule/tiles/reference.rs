//! Which lights reach which tile, in f64, by the rules of `deferred/tiles.wgsl`.

use bevy::math::{DMat4, DVec2, DVec3, DVec4, Vec3};
use dolomite_deferred::light::{LightRow, SPOT};
use dolomite_deferred::render::TILE;

use super::scene::{NEAR, Seen, TEXTURE, VIEWPORT};

/// A light that is decided otherwise when all lengths are so much longer or shorter is left out, metres: forty steps of
/// an f32 of 40 m.
const MARGIN: f64 = 1.5e-4;

/// A tile as the pass sees it, in f64: `Tile` of the WGSL file.
pub(super) struct Tile {
    sides: [DVec4; 4],
    near: f64,
    far: f64,
    slices: f64,
    middle: DVec3,
    radius: f64,
    /// Bits of the slices in which a surface lies whatever is rounded, and of those in which one may.
    filled: [u32; 2],
}

pub(super) fn in_view(view_from_clip: DMat4, ndc: DVec3) -> DVec3 {
    view_from_clip.project_point3(ndc)
}

/// The slice at a distance.
fn slice(tile_near: f64, slices: f64, distance: f64) -> u32 {
    if slices == 0.0 {
        return 0;
    }
    ((distance - tile_near) * slices).clamp(0.0, 31.0) as u32
}

/// The tile of a column and row; `None` where there is only sky.
pub(super) fn tile(seen: &Seen, [column, row]: [u32; 2]) -> Option<Tile> {
    let view_from_clip = seen.clip_from_view.as_dmat4().inverse();
    let [x0, y0, width, height] = VIEWPORT;
    let size = DVec2::new(width.into(), height.into());
    let corner = DVec2::new(column.into(), row.into()) * f64::from(TILE);
    let pixels = (0..TILE * TILE)
        .map(|k| corner + DVec2::new((k % TILE).into(), (k / TILE).into()))
        .filter(|pixel| pixel.cmplt(size).all());
    let depths: Vec<f64> = pixels
        .map(|pixel| {
            let [x, y] = [pixel.x as u32 + x0, pixel.y as u32 + y0];
            f64::from(seen.depths[(y * TEXTURE[0] + x) as usize]) / 65_535.0
        })
        .filter(|depth| *depth > 0.0)
        .collect();
    let nearest = depths.iter().copied().reduce(f64::max)?;
    let farthest = depths.iter().copied().fold(nearest, f64::min);

    let ndc = |pixel: DVec2| pixel / size * DVec2::new(2.0, -2.0) + DVec2::new(-1.0, 1.0);
    let low = ndc(corner - 0.25);
    let high = ndc(corner + f64::from(TILE) + 0.25);
    let corners = [
        DVec2::new(low.x, high.y),
        DVec2::new(high.x, high.y),
        DVec2::new(high.x, low.y),
        DVec2::new(low.x, low.y),
    ];
    let at = |depth: f64| corners.map(|xy| in_view(view_from_clip, xy.extend(depth)));
    let (front, back) = (at(1.0), at(0.5));
    let box_corners = [at(nearest), at(farthest)].concat();
    let least = box_corners.iter().copied().fold(DVec3::MAX, DVec3::min);
    let most = box_corners.iter().copied().fold(DVec3::MIN, DVec3::max);
    let inside = (front[0] + front[2] + back[0] + back[2]) * 0.25;
    let sides = [0, 1, 2, 3].map(|k| {
        let normal = (front[(k + 1) % 4] - front[k])
            .cross(back[k] - front[k])
            .normalize();
        let normal = if normal.dot(inside - front[k]) > 0.0 {
            normal
        } else {
            -normal
        };
        normal.extend(-normal.dot(front[k]))
    });
    let (near, far) = (-most.z, -least.z);
    let depth = far - near;
    let slices = if depth > 1e-3 * far.abs() && depth < 1e12 {
        32.0 / depth
    } else {
        0.0
    };
    let mut filled = [0_u32; 2];
    for depth in depths {
        let distance = f64::from(NEAR) / depth;
        let [a, b] = [-1e-6, 1e-6].map(|off| slice(near, slices, distance * (1.0 + off)));
        filled[1] |= (1 << a) | (1 << b);
        if a == b {
            filled[0] |= 1 << a;
        }
    }
    Some(Tile {
        sides,
        near,
        far,
        slices,
        middle: (least + most) * 0.5,
        radius: (most - least).length() * 0.5,
        filled,
    })
}

/// Whether a light reaches a tile when all lengths are `longer` metres longer; `filled` says where surfaces lie.
fn reaches(seen: &Seen, light: &LightRow, tile: &Tile, filled: u32, longer: f64) -> bool {
    let turn = seen.world_from_view.as_dmat4();
    let axes = [turn.x_axis, turn.y_axis, turn.z_axis].map(DVec4::truncate);
    let to_view = |v: DVec3| DVec3::new(axes[0].dot(v), axes[1].dot(v), axes[2].dot(v));
    let offset = Vec3::from(light.position).as_dvec3() - turn.w_axis.truncate();
    let middle = to_view(offset);
    let reach = f64::from(light.range) * 1.001 + 1e-6 * offset.length() + longer;
    if -middle.z - reach > tile.far || -middle.z + reach < tile.near {
        return false;
    }
    let slack = reach + 4e-6 * tile.far.abs();
    let [first, last] = [-slack, slack].map(|off| slice(tile.near, tile.slices, -middle.z + off));
    if filled & (u32::MAX << first) & (u32::MAX >> (31 - last)) == 0 {
        return false;
    }
    if tile
        .sides
        .iter()
        .any(|side| side.dot(middle.extend(1.0)) < -reach)
    {
        return false;
    }
    let to_tile = tile.middle - middle;
    if to_tile.length() > reach + tile.radius {
        return false;
    }
    if light.kind & SPOT == 0 {
        return true;
    }
    let along = to_tile.dot(to_view(Vec3::from(light.direction).as_dvec3()));
    let across = (to_tile.length_squared() - along * along).max(0.0).sqrt();
    let outside = f64::from(light.cos_outer) * across - along * f64::from(light.sin_outer);
    let radius = tile.radius * 1.001 + 1e-3 * to_tile.length() + longer;
    outside <= radius && along >= -radius
}

/// Whether a light reaches a tile; `None` where a rounding may decide.
pub(super) fn decided(seen: &Seen, light: &LightRow, tile: Option<&Tile>) -> Option<bool> {
    let Some(tile) = tile else { return Some(false) };
    let [sure, maybe] = tile.filled;
    let least = reaches(seen, light, tile, sure, -MARGIN);
    (least == reaches(seen, light, tile, maybe, MARGIN)).then_some(least)
}
