//! How many of those that stand are drawn at a distance, and how wide: the functions of `shaders/src/vegetation/law.wgsl`,
//! in Rust, and where about the eye how many levels of ranks are looked at.
//!
//! A blade is a pixel wide at the distance `reach[0]`. Beyond it the share 1/d stays, each d times as wide: pixels
//! stay covered and no blade is less than a pixel. From `reach[1]` on the share falls as 1/d², since the area of rings
//! grows as d². Towards `reach[3]` all end, and the shade of the ground takes over.

use super::layout::{LayerParams, MOST_REACH, MOST_RINGS, Ring, STEPS};
use crate::density::Growth;
use crate::place::LEVELS;

/// Distance from which on the share falls with the square, metres; of those that are a pixel wide beyond it, as far
/// as they are.
pub const SQUARE_FROM: f32 = 120.0;

/// Where the fade at the end begins, as a share of the reach.
pub const FADE_FROM: f32 = 0.6;

/// The numbers of a kind's law: its blades are so wide, it is drawn so far.
#[must_use]
pub fn reach_of(width: f32, pixels_per_radian: f32, reach: f32) -> [f32; 4] {
    let first = (width * pixels_per_radian).clamp(0.25, MOST_REACH);
    let reach = reach.clamp(0.0, MOST_REACH);
    [first, first.max(SQUARE_FROM), reach * FADE_FROM, reach]
}

/// The share that is drawn at a distance.
#[must_use]
pub fn kept_share(reach: [f32; 4], distance: f32) -> f32 {
    let d = distance.max(1e-3);
    (reach[0] / d).min(1.0) * (reach[1] / d).min(1.0)
}

/// The least distance from which on no more than this share is drawn.
#[must_use]
pub fn distance_of(reach: [f32; 4], share: f32) -> f32 {
    let [first, second, ..] = reach;
    if share >= 1.0 {
        0.0
    } else if share * second >= first {
        first / share
    } else {
        (first * second / share).sqrt()
    }
}

/// Rings of a kind about a place: in each only the candidates of the ranks that may be drawn there are looked at. `eye`
/// is relative to `anchor`, whole metres of the world; x and z of both.
pub fn set_rings(layer: &mut LayerParams, anchor: [i64; 2], eye: [f64; 2]) {
    let Growth { lattice, full, .. } = layer.growth;
    let reach = layer.reach;
    layer.ring_count = 0;
    layer.rings = [Ring::default(); MOST_RINGS];
    if !(full > 0.0 && reach[3] > 0.0) {
        return;
    }
    let quarter = |level: u32| 1.0 / (1_u64 << (2 * level)) as f32;
    let mut level = 0;
    while level + 1 < LEVELS && full <= quarter(level + 1) {
        level += 1;
    }
    // In steps of the world; a level's cells are whole numbers of them.
    let cell = |level: u32| 1_i64 << (12 + lattice.pitch_log2 + level.cast_signed());
    let mut inner: Option<[[i64; 2]; 2]> = None;
    let mut count = 0;
    loop {
        let side = 8 * cell(level);
        let last = level == LEVELS || count + 1 == MOST_RINGS;
        let far = distance_of(reach, quarter(level + 1) / full);
        let last = last || far >= reach[3];
        let far = f64::from(if last { reach[3] } else { far });
        let place = |axis: usize, off: f64| {
            ((anchor[axis] * 4096) as f64 + (eye[axis] + off) * STEPS) / (2 * side) as f64
        };
        // Even tiles, so that borders are those of the next level too.
        let from = [0, 1].map(|axis| 2 * place(axis, -far).floor() as i64);
        let to = [0, 1].map(|axis| 2 * place(axis, far).ceil() as i64);
        // The greatest number that a piece's words hold.
        let tiles = (to[0] - from[0]).max(to[1] - from[1]).clamp(2, 8190);
        let local = |axis: usize| (from[axis] * side - anchor[axis] * 4096) as i32;
        let relative = |corner: [i64; 2]| [0, 1].map(|axis| (corner[axis] - from[axis]) as i32);
        let [inner_from, inner_to] = inner.map_or([[0; 2]; 2], |ends| ends.map(relative));
        layer.rings[count] = Ring {
            least: [local(0), local(1)],
            square: [0, 1].map(|axis| (from[axis] * 8) as i32),
            inner_from,
            inner_to,
            tiles: tiles as i32,
            level,
            pad: [0; 2],
        };
        count += 1;
        if last {
            break;
        }
        inner = Some([from, [0, 1].map(|axis| from[axis] + tiles)].map(|ends| ends.map(|k| k / 2)));
        level += 1;
    }
    layer.ring_count = count as u32;
}
