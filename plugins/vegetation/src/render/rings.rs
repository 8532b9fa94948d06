//! Where about the eye how many levels of ranks are looked at.

use super::layout::{LayerParams, MOST_RINGS, Ring, STEPS};
use crate::density::Growth;
use crate::place::LEVELS;

/// Rings of a kind about a place: in each only the candidates of the ranks that may be drawn there are looked at. `eye`
/// is relative to `anchor`, whole metres of the world; x and z of both.
pub fn set_rings(layer: &mut LayerParams, anchor: [i64; 2], eye: [f64; 2]) {
    let Growth { lattice, full, .. } = layer.growth;
    let law = layer.reach;
    layer.ring_count = 0;
    layer.rings = [Ring::default(); MOST_RINGS];
    if !(full > 0.0 && law.reach > 0.0) {
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
        let far = law.distance_of(quarter(level + 1) / full);
        let last = last || far >= law.reach;
        let far = f64::from(if last { law.reach } else { far });
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
