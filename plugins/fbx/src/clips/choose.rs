//! Which kind of keys is smallest for a property.

use super::fit::{Keys, Signal};
use super::value::{Value, angle};
use crate::model::{Channel, Interpolation, Property};
use glam::{DQuat, DVec3};

/// Largest angle between a rotation and itself in 16-bit integers, radians: four components off by
/// half of 1/32767 each, and twice that as an angle.
const SHORT_ERROR: f64 = 2.0 * 2.0 * 0.5 / 32767.0;

/// Tolerances from so many times [`SHORT_ERROR`] on have room for it.
const SHORT_WORTH: f64 = 2.5;

/// A property as it is sampled.
pub(crate) struct Sampled<'a> {
    pub(crate) node: usize,
    pub(crate) times: &'a [f64],
    pub(crate) jumps: &'a [bool],
    /// Samples that keys may stand on.
    pub(crate) stops: &'a [usize],
    /// Samples on the file's own keys: channels that have theirs on all of them share their times.
    pub(crate) common: &'a [usize],
    /// Kinds of keys that are tried; an earlier try may have told which is smaller.
    pub(crate) kinds: Kinds,
}

/// Kinds of keys for what moves.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) enum Kinds {
    #[default]
    Any,
    Linear,
    Cubic,
    /// A part of a clip whose other parts have it so too: no steps, and two keys for what stands still.
    OnlyLinear,
    OnlyCubic,
}

impl Kinds {
    fn is_part(self) -> bool {
        matches!(self, Self::OnlyLinear | Self::OnlyCubic)
    }
}

/// Keys of a channel.
#[derive(Clone)]
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
    choose(sampled, property, values, &rest, distance, tolerance, false)
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
    choose(
        sampled,
        Property::Weights,
        values,
        rest,
        distance,
        tolerance,
        false,
    )
}

/// Keys of a rotation within `tolerance` radians. `values` lie on one side each of the last.
pub(crate) fn rotation(sampled: &Sampled, values: &[DQuat], rest: DQuat, tolerance: f64) -> Choice {
    let distance = |a: &DQuat, b: &DQuat| angle(*a, *b);
    // Half the bytes for a part of the tolerance, where it is a small one.
    let short = tolerance > SHORT_WORTH * SHORT_ERROR;
    let tolerance = if short {
        tolerance - SHORT_ERROR
    } else {
        tolerance
    };
    choose(
        sampled,
        Property::Rotation,
        values,
        &rest,
        distance,
        tolerance,
        short,
    )
}

fn choose<V: Value>(
    sampled: &Sampled,
    property: Property,
    values: &[V],
    rest: &V,
    distance: impl Fn(&V, &V) -> f64,
    tolerance: f64,
    short: bool,
) -> Choice {
    let signal = Signal {
        times: sampled.times,
        jumps: sampled.jumps,
        stops: sampled.stops,
        values,
        distance,
    };
    let make = |keys: &Keys<V>, interpolation| {
        let made = channel(sampled, property, values, keys, interpolation);
        if short { shortened(made) } else { made }
    };
    if let Some(value) = signal.constant(rest, tolerance) {
        let at_rest = value == *rest;
        if sampled.kinds.is_part() && values.len() > 1 {
            let channel = still(sampled, property, values, &value);
            return Choice { channel, at_rest };
        }
        let keys = Keys {
            at: vec![0],
            tangents: Vec::new(),
        };
        let channel = channel(sampled, property, &[value], &keys, Interpolation::Linear);
        return Choice { channel, at_rest };
    }
    let cubic = || make(&signal.cubic(tolerance), Interpolation::Cubic);
    let steps = match sampled.kinds.is_part() {
        true => None,
        false => signal.steps(tolerance),
    };
    let channel = match (steps, sampled.kinds) {
        (Some(keys), _) => make(&keys, Interpolation::Step),
        (None, Kinds::Cubic | Kinds::OnlyCubic) => cubic(),
        (None, kinds) => match lines(&signal, sampled.common, tolerance, &make) {
            Some(lines) => {
                let ask = kinds == Kinds::Any && lines.times.len() > 2;
                match ask && cubics_pay(&signal, &lines, tolerance) {
                    true => [cubic(), lines].into_iter().min_by_key(bytes),
                    false => Some(lines),
                }
                .unwrap_or_else(cubic)
            }
            None => cubic(),
        },
    };
    Choice {
        channel,
        at_rest: false,
    }
}

/// Two keys of one value.
fn still<V: Value>(sampled: &Sampled, property: Property, values: &[V], value: &V) -> Channel {
    let last = values.len() - 1;
    let (interpolation, tangents) = match sampled.kinds {
        Kinds::OnlyCubic => (Interpolation::Cubic, vec![(value.zero(), value.zero())]),
        _ => (Interpolation::Linear, Vec::new()),
    };
    let keys = Keys {
        at: vec![0, last],
        tangents,
    };
    let values = vec![value.clone(); values.len()];
    channel(sampled, property, &values, &keys, interpolation)
}

/// The smaller of straight lines between the fewest keys, and between all of the file's own, of which
/// the times are kept once for all channels.
fn lines<V: Value, D: Fn(&V, &V) -> f64>(
    signal: &Signal<V, D>,
    common: &[usize],
    tolerance: f64,
    make: &impl Fn(&Keys<V>, Interpolation) -> Channel,
) -> Option<Channel> {
    let few = signal
        .linear(tolerance)
        .map(|keys| make(&keys, Interpolation::Linear));
    let all = signal
        .linear_on(common, tolerance)
        .map(|keys| make(&keys, Interpolation::Linear));
    match (few, all) {
        (Some(few), Some(all)) if bytes(&all) - all.times.len() * 4 < bytes(&few) => Some(all),
        (few, all) => few.or(all),
    }
}

/// Stops of the part of a signal that is tried before all of it.
const PART: usize = 32;

/// Whether cubics may be smaller than `lines`: they are tried on a part in the middle.
fn cubics_pay<V: Value, D: Fn(&V, &V) -> f64>(
    signal: &Signal<V, D>,
    lines: &Channel,
    tolerance: f64,
) -> bool {
    let count = signal.stops.len();
    if count <= PART {
        return true;
    }
    let stops = &signal.stops[(count - PART) / 2..(count + PART) / 2];
    let (first, last) = (stops[0], stops[PART - 1]);
    let stops: Vec<usize> = stops.iter().map(|stop| stop - first).collect();
    let part = Signal {
        times: &signal.times[first..=last],
        jumps: &signal.jumps[first..=last],
        stops: &stops,
        values: &signal.values[first..=last],
        distance: &signal.distance,
    };
    let cubics = part.cubic(tolerance).at.len();
    let times = signal.times[first] as f32..=signal.times[last] as f32;
    let lines = lines
        .times
        .iter()
        .filter(|time| times.contains(time))
        .count();
    // A cubic's key has three values; with its time it is less than three of a line's.
    cubics * 2 <= lines
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
        let length = |a: usize, b: usize| sampled.times[b] - sampled.times[a];
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
        times: keys.at.iter().map(|&at| sampled.times[at] as f32).collect(),
        values: numbers.into_iter().map(|x| x as f32).collect(),
        short: false,
    }
}

/// The channel in 16-bit integers, if all of its numbers lie between -1 and 1.
fn shortened(mut channel: Channel) -> Channel {
    if channel.values.iter().all(|value| value.abs() <= 1.0) {
        for value in &mut channel.values {
            *value = (*value * 32767.0).round() / 32767.0;
        }
        channel.short = true;
    }
    channel
}

/// Bytes of a channel's keys and times.
pub(crate) fn bytes(channel: &Channel) -> usize {
    channel.times.len() * 4 + channel.values.len() * if channel.short { 2 } else { 4 }
}
