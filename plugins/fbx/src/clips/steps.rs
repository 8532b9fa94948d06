//! Numbers of channels as whole multiples of powers of two, and rotations as the codec's filter has them.

use crate::codec::{exponent_below, power, quaternion_of_bits};
use crate::model::{Channel, Interpolation};
use glam::{DQuat, DVec4};

/// The finest step of a quaternion that the filter for them has, as a power of two.
const FINEST_OF_FILTER: i32 = -14;

/// A step that what is left of a unit quaternion's length may have, as a power of two.
const LENGTH: i32 = -16;

/// The whole multiple of a power of two next to `x`.
pub(super) fn round(x: f64, step: i32) -> f32 {
    let step = power(step);
    ((x / step).round() * step) as f32
}

/// How much coarser than values tangents may be, as a power of two: at most 4/27 of a tangent times the
/// time between two keys is seen.
fn tangents(times: &[f32]) -> i32 {
    let gaps = times.windows(2).map(|pair| f64::from(pair[1] - pair[0]));
    let longest = gaps.fold(1e-6, f64::max);
    exponent_below(4.0 / longest)
}

/// Rounds all numbers of a channel to a power of two.
pub(super) fn vector(channel: &mut Channel, step: i32) {
    let keys = channel.times.len().max(1);
    let width = channel.values.len() / keys;
    let cubic = channel.interpolation == Interpolation::Cubic;
    let coarser = if cubic { tangents(&channel.times) } else { 0 };
    for key in channel.values.chunks_mut(width.max(1)) {
        for (i, x) in key.iter_mut().enumerate() {
            let middle = !cubic || (width / 3..2 * width / 3).contains(&i);
            *x = round(f64::from(*x), if middle { step } else { step + coarser });
        }
    }
    channel.short = false;
}

/// Rounds a rotation to steps of `2^step` in each component of its quaternion; `aim` says where each key belongs.
pub(super) fn rotation(channel: &mut Channel, step: i32, aim: impl Fn(usize, DQuat) -> DQuat) {
    if channel.interpolation == Interpolation::Cubic {
        vector(channel, step);
        return;
    }
    let mut aims: Vec<DQuat> = Vec::with_capacity(channel.times.len());
    for (key, q) in channel.values.chunks(4).enumerate() {
        let q = DQuat::from_array([q[0], q[1], q[2], q[3]].map(f64::from));
        let q = aim(key, q.normalize()).normalize();
        let turned = aims.last().is_some_and(|last| last.dot(q) < 0.0);
        aims.push(if turned { -q } else { q });
    }
    channel.values.clear();
    if step >= FINEST_OF_FILTER {
        let bits = (1 - step).clamp(4, 15) as u32;
        for q in aims {
            let (_, back) = quaternion_of_bits(q.to_array(), bits);
            channel.values.extend(back.map(|x| f32::from(x) / 32767.0));
        }
        channel.short = true;
        return;
    }
    // The component that is never small takes what the others leave of the length, and needs few bits.
    let least = |i: usize| {
        aims.iter()
            .map(|q| q.to_array()[i].abs())
            .fold(1.0, f64::min)
    };
    let large = (0..4)
        .max_by(|&a, &b| least(a).total_cmp(&least(b)))
        .unwrap_or(3);
    let coarse = least(large) > 0.25;
    for q in aims {
        let mut q = DVec4::from(q);
        if coarse {
            let kept = f64::from(round(q[large], LENGTH));
            q *= kept / q[large];
            q[large] = kept;
        }
        let numbers = q.to_array();
        let numbers = numbers
            .iter()
            .enumerate()
            .map(|(i, &x)| match coarse && i == large {
                true => x as f32,
                false => round(x, step),
            });
        channel.values.extend(numbers);
    }
    channel.short = false;
}
