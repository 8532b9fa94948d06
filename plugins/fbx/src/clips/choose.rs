//! Which kind of keys is smallest for a property.

use super::fit::{Keys, Signal};
use super::value::{Value, angle};
use crate::model::{Channel, Interpolation, Property};
use glam::{DQuat, DVec3};

/// Largest angle between a rotation and itself in 16-bit integers, radians: four components off by
/// half of 1/32767 each, and twice that as an angle.
const SHORT_ERROR: f64 = 2.0 * 2.0 * 0.5 / 32767.0;

/// A property as it is sampled.
pub(crate) struct Sampled<'a> {
    pub(crate) node: usize,
    pub(crate) times: &'a [f32],
    pub(crate) jumps: &'a [bool],
}

/// Keys of a channel; `None` where it stands still at its rest.
pub(crate) struct Choice {
    pub(crate) channel: Channel,
    /// It never leaves its value at rest.
    pub(crate) at_rest: bool,
}

/// Keys of a translation or a scale, within `tolerance` in its own unit.
pub(crate) fn vector(
    sampled: &Sampled,
    property: Property,
    values: &[DVec3],
    rest: DVec3,
    tolerance: f64,
) -> Choice {
    let distance = |a: &DVec3, b: &DVec3| (*a - *b).length();
    choose(sampled, property, values, &rest, distance, tolerance)
}

/// Keys of weights of morph targets; `reach` is metres a unit of each weight, `tolerance` metres.
pub(crate) fn weights(
    sampled: &Sampled,
    values: &[Vec<f64>],
    rest: &Vec<f64>,
    reach: &[f64],
    tolerance: f64,
) -> Choice {
    let distance = |a: &Vec<f64>, b: &Vec<f64>| -> f64 {
        let each = a.iter().zip(b).zip(reach);
        each.map(|((a, b), reach)| (a - b).abs() * reach).sum()
    };
    choose(sampled, Property::Weights, values, rest, distance, tolerance)
}

/// Keys of a rotation within `tolerance` radians. `values` lie on one side each of the last.
pub(crate) fn rotation(
    sampled: &Sampled,
    values: &[DQuat],
    rest: DQuat,
    tolerance: f64,
) -> Choice {
    let distance = |a: &DQuat, b: &DQuat| angle(*a, *b);
    let mut best = choose(sampled, Property::Rotation, values, &rest, distance, tolerance);
    if best.channel.times.len() > 1 && tolerance > 1.5 * SHORT_ERROR {
        let other = choose(
            sampled,
            Property::Rotation,
            values,
            &rest,
            distance,
            tolerance - SHORT_ERROR,
        );
        if let Some(short) = shortened(other.channel)
            && bytes(&short) < bytes(&best.channel)
        {
            best.channel = short;
        }
    }
    best
}

fn choose<V: Value>(
    sampled: &Sampled,
    property: Property,
    values: &[V],
    rest: &V,
    distance: impl Fn(&V, &V) -> f64,
    tolerance: f64,
) -> Choice {
    let signal = Signal {
        times: sampled.times,
        jumps: sampled.jumps,
        values,
        distance,
    };
    let make = |keys: &Keys<V>, interpolation| channel(sampled, property, values, keys, interpolation);
    if let Some(value) = signal.constant(rest, tolerance) {
        let at_rest = value == *rest;
        let keys = Keys { at: vec![0], tangents: Vec::new() };
        let channel = channel(sampled, property, &[value], &keys, Interpolation::Linear);
        return Choice { channel, at_rest };
    }
    let channel = match signal.steps(tolerance) {
        Some(keys) => make(&keys, Interpolation::Step),
        None => {
            let linear = make(&signal.linear(tolerance), Interpolation::Linear);
            // Two lines are no larger than any cubic.
            match linear.times.len() {
                0..=2 => linear,
                _ => {
                    let cubic = make(&signal.cubic(tolerance), Interpolation::Cubic);
                    if bytes(&cubic) < bytes(&linear) { cubic } else { linear }
                }
            }
        }
    };
    Choice { channel, at_rest: false }
}

fn channel<V: Value>(
    sampled: &Sampled,
    property: Property,
    values: &[V],
    keys: &Keys<V>,
    interpolation: Interpolation,
) -> Channel {
    let mut numbers = Vec::new();
    for (i, &at) in keys.at.iter().enumerate() {
        let mut put = |value: &V, factor: f64| {
            let mut scaled = value.zero();
            V::add(&mut scaled, value, factor);
            scaled.numbers(&mut numbers);
        };
        if interpolation != Interpolation::Cubic {
            put(&values[at], 1.0);
            continue;
        }
        // Tangents of the file format are per second.
        let length = |a: usize, b: usize| f64::from(sampled.times[b]) - f64::from(sampled.times[a]);
        match i.checked_sub(1) {
            Some(last) => put(&keys.tangents[last].1, 1.0 / length(keys.at[last], at)),
            None => put(&values[at], 0.0),
        }
        put(&values[at], 1.0);
        match keys.tangents.get(i) {
            Some((out, _)) => put(out, 1.0 / length(at, keys.at[i + 1])),
            None => put(&values[at], 0.0),
        }
    }
    Channel {
        node: sampled.node,
        property,
        interpolation,
        times: keys.at.iter().map(|&at| sampled.times[at]).collect(),
        values: numbers.into_iter().map(|x| x as f32).collect(),
        short: false,
    }
}

/// The channel in 16-bit integers, if all of its numbers lie between -1 and 1.
fn shortened(mut channel: Channel) -> Option<Channel> {
    for value in &mut channel.values {
        if value.abs() > 1.0 {
            return None;
        }
        *value = (*value * 32767.0).round() / 32767.0;
    }
    channel.short = true;
    Some(channel)
}

/// Bytes of a channel's keys and times.
pub(crate) fn bytes(channel: &Channel) -> usize {
    channel.times.len() * 4 + channel.values.len() * if channel.short { 2 } else { 4 }
}
