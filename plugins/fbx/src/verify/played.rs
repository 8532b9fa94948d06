//! Majorants of keys as they are played, over a span between keys.

use crate::clips::Value;
use crate::curves::{Majorant, Over, cubic, part};
use crate::model::{Channel, Interpolation, Property};
use glam::DQuat;

/// Numbers of a value.
fn width(channel: &Channel) -> usize {
    let values = match channel.interpolation {
        Interpolation::Cubic => 3,
        _ => 1,
    };
    channel.values.len() / (channel.times.len() * values).max(1)
}

/// What a channel does over a span.
enum Stretch {
    Still(usize),
    /// From one key to the next: shares at which the span begins and ends.
    Moves(usize, f64, f64),
    /// The span goes across a key.
    Across,
}

fn stretch(channel: &Channel, over: Over) -> Stretch {
    let times = &channel.times;
    let middle = over.middle();
    let next = times.partition_point(|&time| f64::from(time) <= middle);
    if next == 0 {
        return Stretch::Still(0);
    }
    if next == times.len() || channel.interpolation == Interpolation::Step {
        return Stretch::Still(next - 1);
    }
    let (begin, end) = (f64::from(times[next - 1]), f64::from(times[next]));
    if over.from < begin - over.slack || over.to > end + over.slack {
        return Stretch::Across;
    }
    let share = |time: f64| ((time - begin) / (end - begin)).clamp(0.0, 1.0);
    Stretch::Moves(next - 1, share(over.from), share(over.to))
}

/// The majorants of each number of a channel; seconds from the clip's begin.
pub(super) fn numbers(channel: &Channel, over: Over, out: &mut Vec<Majorant>) {
    let width = width(channel);
    let value = |key: usize, which: usize, number: usize| {
        let values = if channel.interpolation == Interpolation::Cubic {
            3
        } else {
            1
        };
        let which = which.min(values - 1);
        f64::from(channel.values[(key * values + which) * width + number])
    };
    let middle = usize::from(channel.interpolation == Interpolation::Cubic);
    match stretch(channel, over) {
        Stretch::Across => {
            let key = |time: f64| channel.times.partition_point(|&key| f64::from(key) <= time);
            let touched =
                key(over.from).saturating_sub(1)..(key(over.to) + 1).min(channel.times.len());
            out.extend((0..width).map(|i| {
                let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
                let mut take = |x: f64| (low, high) = (low.min(x), high.max(x));
                for at in touched.clone() {
                    let here = value(at, middle, i);
                    take(here);
                    if middle == 0 {
                        continue;
                    }
                    // Tangents reach over a third of the time to the next key, or less.
                    let time =
                        |at: usize| f64::from(channel.times[at.min(channel.times.len() - 1)]);
                    take(here + value(at, 2, i) * (time(at + 1) - time(at)) / 3.0);
                    take(here - value(at, 0, i) * (time(at) - time(at.saturating_sub(1))) / 3.0);
                }
                Majorant::within(low.abs().max(high.abs()), high - low)
            }));
        }
        Stretch::Still(key) => {
            out.extend((0..width).map(|i| Majorant::still(value(key, middle, i))));
        }
        Stretch::Moves(key, begin, end) => out.extend((0..width).map(|i| {
            let (a, d) = (value(key, middle, i), value(key + 1, middle, i));
            if middle == 0 {
                return Majorant::moving(a.abs().max(d.abs()), (d - a) * (end - begin));
            }
            let length = f64::from(channel.times[key + 1]) - f64::from(channel.times[key]);
            let (leave, arrive) = (value(key, 2, i) * length, value(key + 1, 0, i) * length);
            let points = [a, a + leave / 3.0, d - arrive / 3.0, d];
            cubic(part(points, begin, end))
        })),
    }
}

/// The majorant of the matrix of a channel of rotations.
pub(super) fn turn(channel: &Channel, over: Over) -> Majorant {
    match stretch(channel, over) {
        Stretch::Across => Majorant::within(1.0, 2.0),
        Stretch::Still(_) => Majorant::still(1.0),
        Stretch::Moves(key, begin, end) => match channel.interpolation {
            Interpolation::Cubic => {
                let mut parts = Vec::with_capacity(4);
                numbers(channel, over, &mut parts);
                sphere(&parts, channel, key, f64::midpoint(begin, end))
            }
            _ => {
                let quat = |key: usize| {
                    let numbers = &channel.values[key * 4..key * 4 + 4];
                    DQuat::from_array([0, 1, 2, 3].map(|i| f64::from(numbers[i]))).finish()
                };
                let half = DQuat::line(&quat(key), &quat(key + 1)).angle();
                Majorant::moving(0.0, 2.0 * half * (end - begin)).rotation()
            }
        },
    }
}

/// Of the matrix of a quaternion that is made one long: q x / |q|^2, from both sides.
fn sphere(parts: &[Majorant], channel: &Channel, key: usize, share: f64) -> Majorant {
    let long = |of: &dyn Fn(&Majorant) -> f64| {
        let squares = parts.iter().map(|part| of(part) * of(part));
        squares.sum::<f64>().sqrt()
    };
    let orders = std::array::from_fn(|k| long(&|part| part.0[k]));
    let mut long = Majorant(orders, long(&|part| part.1));
    let length = f64::from(channel.times[key + 1]) - f64::from(channel.times[key]);
    let quat = |key: usize, which: usize| {
        let at = (key * 3 + which) * 4;
        DQuat::from_array([0, 1, 2, 3].map(|i| f64::from(channel.values[at + i])))
    };
    let [a, b, c, d] = crate::clips::hermite(share);
    let middle = quat(key, 1) * a
        + quat(key, 2) * (b * length)
        + quat(key + 1, 1) * c
        + quat(key + 1, 0) * (d * length);
    let least = middle.length() - long.1;
    long.0[0] = long.0[0].min(middle.length() + long.1);
    let squared = long.product(&long);
    let mut out = squared.product(&squared.reciprocal(least.max(0.0) * least.max(0.0)));
    out.0[0] = 1.0;
    // Directions of two ways of four numbers are apart by at most twice what they are, over the length of one.
    out.1 = 4.0 * long.1 / middle.length();
    if out.1.is_nan() {
        out.1 = 2.0;
    }
    out.near(2.0)
}

/// Majorants of the length of a channel of three numbers, and of the largest of them.
pub(super) fn vector(channel: &Channel, over: Over) -> (Majorant, Majorant) {
    debug_assert!(channel.property != Property::Rotation);
    let mut parts = Vec::with_capacity(3);
    numbers(channel, over, &mut parts);
    match parts[..] {
        [x, y, z] => (Majorant::length(&[x, y, z]), x.max(&y).max(&z)),
        _ => (Majorant::UNKNOWN, Majorant::UNKNOWN),
    }
}
