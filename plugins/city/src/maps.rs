//! The maps that come with the crate: asphalt, cobbles, bricks, plaster, roof tiles and leaves, each 4 m long, made
//! of integer hashes and arithmetic alone, so that their texels are the same everywhere.

use crate::hash::{pcg, unit};
use crate::map::{DisplacementMap, TEXELS_PER_METRE};

/// Texels along a side of each: 4 m.
pub const SIDE: usize = 128;

/// Length of each, metres.
pub const TILE: f32 = SIDE as f32 / TEXELS_PER_METRE;

/// Number of maps.
pub const MAPS: usize = 6;

/// All of them, by [`Surface::map`](crate::Surface::map). Takes some milliseconds.
///
/// # Panics
/// Never: their side is right.
#[must_use]
pub fn maps() -> [DisplacementMap; MAPS] {
    let painters: [fn(f32, f32) -> f32; MAPS] = [asphalt, cobbles, bricks, plaster, tiles, leaves];
    painters.map(|paint| {
        let texel = |k: usize| {
            let metre = |t: usize| (t as f32 + 0.5) / TEXELS_PER_METRE;
            let height = paint(metre(k % SIDE), metre(k / SIDE));
            (height.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
        };
        DisplacementMap::new(SIDE, (0..SIDE * SIDE).map(texel).collect())
            .expect("a power of two, and all texels")
    })
}

/// Between the values of a lattice of `per` points a metre, smoothly; periodic in [`TILE`]. From 0 to 1.
fn noise(x: f32, y: f32, per: f32, salt: u32) -> f32 {
    let n = (TILE * per) as u32;
    let (x, y) = (x * per, y * per);
    let (i, j) = (x.floor(), y.floor());
    let smooth = |f: f32| f * f * (3.0 - 2.0 * f);
    let (u, v) = (smooth(x - i), smooth(y - j));
    let value = |di: u32, dj: u32| {
        let (i, j) = ((i as u32 + di) % n, (j as u32 + dj) % n);
        unit(pcg(pcg(salt ^ j).wrapping_add(i)))
    };
    let low = value(0, 0) * (1.0 - u) + value(1, 0) * u;
    let high = value(0, 1) * (1.0 - u) + value(1, 1) * u;
    low * (1.0 - v) + high * v
}

/// From 0 at the rim of a stone to 1 in its middle, `edge` metres from there, with no slope at either: a displaced
/// surface takes triangles by its bends.
fn rounded(distance: f32, edge: f32) -> f32 {
    let t = (distance / edge).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// In which course and stone a place lies, and its distance to the joint, metres: courses of `height`, stones of
/// `length`, every second course shifted by half a stone.
fn masonry(x: f32, y: f32, length: f32, height: f32) -> (u32, f32) {
    let course = (y / height).floor();
    let shift = 0.5 * (course as u32 % 2) as f32;
    let along = x / length + shift;
    let stone = along.floor();
    let per_tile = (TILE / length) as u32;
    let id = pcg((course as u32) << 8 | (stone as u32 % per_tile));
    let to_end = (along - stone).min(1.0 - along + stone) * length;
    let to_side = (y / height - course).min(1.0 - y / height + course) * height;
    (id, to_end.min(to_side))
}

fn asphalt(x: f32, y: f32) -> f32 {
    0.6 * noise(x, y, 2.0, 1) + 0.4 * noise(x, y, 8.0, 2)
}

fn cobbles(x: f32, y: f32) -> f32 {
    let (id, joint) = masonry(x, y, 0.5, 0.4);
    (0.75 + 0.25 * unit(id)) * rounded(joint, 0.2)
}

fn bricks(x: f32, y: f32) -> f32 {
    let (id, joint) = masonry(x, y, 0.5, 0.25);
    (0.8 + 0.2 * unit(id)) * rounded(joint, 0.125)
}

fn plaster(x: f32, y: f32) -> f32 {
    0.7 * noise(x, y, 1.0, 3) + 0.3 * noise(x, y, 4.0, 4)
}

fn tiles(x: f32, y: f32) -> f32 {
    let (rows, columns) = (2.5, 4.0);
    let row = y * rows;
    let up = row - row.floor();
    let across = x * columns + 0.5 * (row as u32 % 2) as f32;
    let t = 2.0 * (across - across.floor()) - 1.0;
    // Each row lies on the one below it: thickest at its lower end.
    let lap = (1.0 - up) * (up * 8.0).min(1.0);
    0.55 * lap + 0.45 * (1.0 - t * t)
}

fn leaves(x: f32, y: f32) -> f32 {
    let tufts = noise(x, y, 3.0, 5);
    let tips = noise(x, y, 7.0, 6);
    0.55 * tufts + 0.45 * tips
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{FNV, fnv};

    #[test]
    fn maps_are_the_same_everywhere_and_use_their_range() {
        let maps = maps();
        let hash = maps.iter().fold(FNV, |state, map| fnv(state, map.texels()));
        assert_eq!(hash, HASH, "{hash:#x}");
        for map in &maps {
            let (low, high) = map
                .texels()
                .iter()
                .fold((255, 0), |(low, high), t| (low.min(*t), high.max(*t)));
            assert!(low < 70 && high > 190, "{low} {high}");
        }
    }

    /// What the first run gave; another value on another machine would be a fault.
    const HASH: u64 = 0xa44d_61b6_c231_b05b;

    #[test]
    fn maps_go_on_over_their_borders() {
        for map in &maps() {
            // A step from the last row to the first is like one in between: by no more than the greatest of all.
            let steps = |rows: core::ops::Range<i32>| {
                rows.flat_map(|y| (0..128).map(move |x| (x, y)))
                    .map(|(x, y)| map.texel(x, y + 1).abs_diff(map.texel(x, y)))
                    .max()
            };
            assert!(steps(127..128) <= steps(0..127));
        }
    }
}
