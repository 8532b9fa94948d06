//! Random curves.

use crate::random::{Random, round};
use crate::scene::{Clamp, Curve, Key, TICKS, Way};

/// What a curve's values are like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    /// Between which values keys lie.
    pub(super) values: [f64; 2],
    /// No cubic may go beyond its keys: for scales, which must not pass 0.
    pub(super) held: bool,
}

/// A curve whose keys lie around a clip.
pub(super) fn curve(clip: [i64; 2], range: Range, random: &mut Random) -> Curve {
    let length = (clip[1] - clip[0]) as f64;
    let baked = random.chance(0.12);
    let mut times: Vec<i64> = match baked {
        // A key every frame.
        true => {
            let frame = TICKS / i64::from(random.pick(&[24, 30, 60]));
            let count = (length / frame as f64).clamp(1.0, 60.0) as i64;
            (0..=count).map(|i| clip[0] + i * frame).collect()
        }
        false => {
            let count = 1 + random.below(8);
            let beyond = if random.chance(0.3) { 0.4 } else { 0.0 };
            let mut time = || clip[0] + (random.between(-beyond, 1.0 + beyond) * length) as i64;
            let mut times: Vec<i64> = (0..count).map(|_| time()).collect();
            if random.chance(0.7) {
                times.extend(clip);
            }
            times
        }
    };
    times.sort_unstable();
    // Keys that share a place, or nearly so, are none that a program would write.
    let least = ((length * 1e-3) as i64).max(TICKS / 20_000);
    let mut last = None;
    times.retain(|&time| {
        let keep = last.is_none_or(|last| time - last >= least);
        if keep {
            last = Some(time);
        }
        keep
    });
    let style = random.below(9);
    let mut keys: Vec<Key> = Vec::new();
    let [low, high] = range.values;
    for (number, &time) in times.iter().enumerate() {
        let mut value = round(random.between(low, high), 2) as f32;
        let again = keys.last().filter(|_| random.chance(0.2));
        if let Some(last) = again {
            value = last.value;
        }
        // A flat key's neighbour is the same or clearly another.
        if let Some(last) = keys.last()
            && (last.value - value).abs() < 2e-3
        {
            value = last.value;
        }
        let next = times
            .get(number + 1)
            .map_or(1.0, |&next| (next - time) as f64 / TICKS as f64);
        let way = way(style, range, next, random);
        keys.push(Key {
            time,
            value,
            way,
            weights: None,
            velocity: random.chance(0.03),
        });
    }
    tidy(&mut keys, random);
    Curve::of(keys)
}

fn way(style: usize, range: Range, next: f64, random: &mut Random) -> Way {
    let style = match style {
        8 => random.below(7),
        style => style,
    };
    let clamp = match range.held {
        true => Clamp::Progressive,
        false => random.pick(&[Clamp::Free, Clamp::Free, Clamp::Flat, Clamp::Progressive]),
    };
    match style {
        0 => Way::Linear,
        1 => Way::Constant,
        2 => match random.chance(0.5) {
            true => Way::ConstantNext,
            false => Way::Linear,
        },
        3 | 4 => Way::Auto {
            clamp,
            time_independent: random.chance(0.3),
        },
        5 if !range.held => Way::Tcb([0, 1, 2].map(|_| round(random.between(-0.8, 0.8), 1) as f32)),
        _ => {
            let steep = match range.held {
                true => 0.0,
                false => (range.values[1] - range.values[0]) / next * 2.0,
            };
            let mut slope = || random.between(-steep, steep) as f32;
            let right = slope();
            Way::User {
                right,
                next_left: slope(),
                broken: true,
            }
        }
    }
}

/// Makes neighbours fit: tangents of two sides stand in two keys.
fn tidy(keys: &mut [Key], random: &mut Random) {
    let weighted = random.chance(0.3);
    let joined = random.chance(0.4);
    for at in 0..keys.len() {
        let next = keys.get(at + 1).map(|key| key.way);
        let key = &mut keys[at];
        let Way::User {
            right,
            next_left,
            broken,
        } = key.way
        else {
            continue;
        };
        // A key that finds its own slope is told none.
        let next_is_user = !matches!(next, Some(Way::Auto { .. } | Way::Tcb(_)));
        let mut left = if next_is_user { next_left } else { 0.0 };
        if joined && let Some(Way::User { right, .. }) = next {
            left = right;
        }
        key.way = Way::User {
            right,
            next_left: left,
            broken: broken && !joined,
        };
        if weighted && next_is_user && random.chance(0.7) {
            key.weights = Some([0, 1].map(|_| random.between(500.0, 9500.0) as u16));
        }
    }
    // Unbroken keys have the same slope on both sides; at the first key and after others there is only one.
    for at in 0..keys.len() {
        let before = at.checked_sub(1).map(|i| keys[i].way);
        if let Way::User {
            right,
            next_left,
            broken: false,
        } = keys[at].way
        {
            let same = match before {
                None => true,
                Some(Way::User { next_left, .. }) => next_left == right,
                Some(_) => false,
            };
            keys[at].way = Way::User {
                right,
                next_left,
                broken: !same,
            };
        }
    }
}
