//! A channel whose keys stand on samples, and what becomes of it without one of them.

use super::fit::{self, Keys, Tangents};
use crate::clips::value::{Value, hermite};
use crate::model::{Channel, Interpolation, Property, Trs};
use glam::{DQuat, DVec3, DVec4};

/// The values of a property at the samples; three numbers are the first of four.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Target {
    pub(super) track: usize,
    pub(super) node: usize,
    pub(super) property: Property,
}

/// Keys of one property of one node.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    pub(super) target: Target,
    /// Cubic, else straight.
    pub(super) cubic: bool,
    /// 16-bit integers.
    pub(super) short: bool,
    /// Samples that are keys.
    pub(super) at: Vec<usize>,
    pub(super) values: Vec<DVec4>,
    /// Of each stretch, out of its first key and into its second; empty where it is straight.
    pub(super) tangents: Vec<Tangents>,
}

/// What a curve would be without one of its keys.
#[derive(Debug, Clone, Default)]
pub(super) struct Change {
    /// Number of the key that goes.
    pub(super) key: usize,
    /// Values of the keys before and after it.
    pub(super) values: [DVec4; 2],
    /// Where they are cubic: of the stretches beside these two keys.
    pub(super) tangents: Vec<Tangents>,
    /// The first sample that changes, and what is played there and after it.
    pub(super) from: usize,
    pub(super) played: Vec<DVec4>,
    /// A tangent would be too steep for the integers that the curve is kept in.
    pub(super) steep: bool,
}

/// What samples have in common.
#[derive(Clone, Copy)]
pub(super) struct Samples<'a> {
    /// Seconds.
    pub(super) times: &'a [f64],
    pub(super) stops: &'a [usize],
}

impl Curve {
    /// Keys on all of `at`.
    pub(super) fn through(
        target: Target,
        cubic: bool,
        at: &[usize],
        wanted: &[DVec4],
        samples: Samples,
    ) -> Self {
        let mut curve = Self {
            target,
            cubic,
            short: false,
            at: at.to_vec(),
            values: Vec::new(),
            tangents: Vec::new(),
        };
        curve.values = at.iter().map(|&at| wanted[at]).collect();
        if cubic {
            let keys = Keys {
                at,
                values: &curve.values,
                wanted,
                times: samples.times,
            };
            curve.tangents = (0..at.len() - 1)
                .map(|stretch| fit::tangents(&keys, stretch))
                .collect();
        }
        curve
    }

    /// Bytes of a key without its time.
    pub(super) fn width(&self) -> usize {
        let numbers = if self.is_rotation() { 4 } else { 3 };
        numbers * if self.short { 2 } else { 4 } * if self.cubic { 3 } else { 1 }
    }

    pub(super) fn is_rotation(&self) -> bool {
        self.target.property == Property::Rotation
    }

    /// The value, of unit length where it is a rotation.
    fn unit(&self, value: DVec4) -> DVec4 {
        match self.is_rotation() {
            true => value.normalize_or(DVec4::W),
            false => value,
        }
    }

    /// Makes all numbers what they are once they are written.
    pub(super) fn write(&mut self, times: &[f64]) {
        let short = self.short;
        let steps = DVec4::splat(32767.0);
        let written = |value: DVec4| match short {
            true => (value * 32767.0).clamp(-steps, steps).round() / 32767.0,
            false => value.as_vec4().as_dvec4(),
        };
        for value in &mut self.values {
            *value = written(*value);
        }
        for (pair, (out, into)) in self.at.windows(2).zip(&mut self.tangents) {
            let length = times[pair[1]] - times[pair[0]];
            *out = written(*out / length) * length;
            *into = written(*into / length) * length;
        }
    }

    /// No tangent is too steep for integers.
    pub(super) fn fits_short(&self, times: &[f64]) -> bool {
        fits_short(&self.at, &self.tangents, times)
    }

    /// What is played at the samples from the first to the last of keys with `values` and, where they are
    /// cubic, `tangents`.
    fn play(
        &self,
        at: &[usize],
        values: &[DVec4],
        tangents: &[Tangents],
        times: &[f64],
        out: &mut Vec<DVec4>,
    ) {
        out.clear();
        for stretch in 0..at.len() - 1 {
            let (from, to) = (at[stretch], at[stretch + 1]);
            let (p, q) = (values[stretch], values[stretch + 1]);
            let per_second = 1.0 / (times[to] - times[from]);
            let share = |i: usize| (times[i] - times[from]) * per_second;
            out.push(self.finished(p));
            if self.cubic {
                let (leave, arrive) = tangents[stretch];
                for i in from + 1..to {
                    let [a, b, c, d] = hermite(share(i));
                    out.push(self.finished(p * a + leave * b + q * c + arrive * d));
                }
            } else if self.is_rotation() {
                let line = DQuat::line(&quat(p).finish(), &quat(q).finish());
                for i in from + 1..to {
                    out.push(DVec4::from(DQuat::on_line(&line, share(i))));
                }
            } else {
                out.extend((from + 1..to).map(|i| p + (q - p) * share(i)));
            }
        }
        out.push(self.finished(values[at.len() - 1]));
    }

    fn finished(&self, value: DVec4) -> DVec4 {
        match self.is_rotation() {
            true => DVec4::from(quat(value).finish()),
            false => value,
        }
    }

    /// What is played at all samples.
    pub(super) fn played(&self, times: &[f64]) -> Vec<DVec4> {
        if self.at.len() == 1 {
            return vec![self.finished(self.values[0]); times.len()];
        }
        let mut out = Vec::with_capacity(times.len());
        self.play(&self.at, &self.values, &self.tangents, times, &mut out);
        out
    }

    /// The curve without key number `key`, which is neither the first nor the last. Both neighbours get
    /// the values that fit best.
    pub(super) fn without(&self, key: usize, wanted: &[DVec4], times: &[f64], change: &mut Change) {
        let first = (key - 1).saturating_sub(1);
        let last = (key + 2).min(self.at.len() - 1);
        let numbers: Vec<usize> = (first..=last).filter(|&k| k != key).collect();
        let at: Vec<usize> = numbers.iter().map(|&k| self.at[k]).collect();
        let mut values: Vec<DVec4> = numbers.iter().map(|&k| self.values[k]).collect();
        let a = key - 1 - first;
        let keys = Keys {
            at: &at,
            values: &values,
            wanted,
            times,
        };
        let [new_a, new_b] = fit::pair(&keys, a, self.cubic);
        values[a] = self.unit(new_a);
        values[a + 1] = self.unit(new_b);
        change.key = key;
        change.values = [values[a], values[a + 1]];
        change.tangents.clear();
        if self.cubic {
            let keys = Keys {
                at: &at,
                values: &values,
                wanted,
                times,
            };
            let all = (0..at.len() - 1).map(|stretch| fit::tangents(&keys, stretch));
            change.tangents.extend(all);
        }
        change.steep = self.short && !fits_short(&at, &change.tangents, times);
        change.from = at[0];
        self.play(&at, &values, &change.tangents, times, &mut change.played);
    }

    /// Takes a change.
    pub(super) fn take(&mut self, change: &Change) {
        let key = change.key;
        [self.values[key - 1], self.values[key + 1]] = change.values;
        self.at.remove(key);
        self.values.remove(key);
        if self.cubic {
            self.tangents.remove(key);
            let first = (key - 1).saturating_sub(1);
            self.tangents[first..first + change.tangents.len()].copy_from_slice(&change.tangents);
        }
    }

    /// It is one value, and that is `rest` as far as f32 can tell.
    pub(super) fn is_constant(&self, rest: DVec4) -> bool {
        let near = 1e-6 * rest.abs().max_element().max(1e-3);
        self.at.len() == 1 && self.values[0].distance(rest) <= near
    }

    /// One key for all.
    pub(super) fn constant(&self, value: DVec4) -> Self {
        Self {
            cubic: false,
            at: vec![0],
            values: vec![self.unit(value)],
            tangents: Vec::new(),
            ..self.clone()
        }
    }

    pub(super) fn channel(&self, times: &[f64]) -> Channel {
        let numbers = if self.is_rotation() { 4 } else { 3 };
        let mut values = Vec::new();
        let mut put = |value: DVec4| {
            values.extend(value.to_array()[..numbers].iter().map(|&x| x as f32));
        };
        for (key, &value) in self.values.iter().enumerate() {
            if !self.cubic {
                put(value);
                continue;
            }
            let length = |a: usize| times[self.at[a + 1]] - times[self.at[a]];
            put(key
                .checked_sub(1)
                .map_or(DVec4::ZERO, |last| self.tangents[last].1 / length(last)));
            put(value);
            put(self
                .tangents
                .get(key)
                .map_or(DVec4::ZERO, |(out, _)| *out / length(key)));
        }
        Channel {
            node: self.target.node,
            property: self.target.property,
            interpolation: match self.cubic {
                true => Interpolation::Cubic,
                false => Interpolation::Linear,
            },
            times: self.at.iter().map(|&at| times[at] as f32).collect(),
            values,
            short: self.short,
        }
    }
}

/// Tangents of keys at samples are at most 1 a second, which is what integers go to.
fn fits_short(at: &[usize], tangents: &[Tangents], times: &[f64]) -> bool {
    at.windows(2).zip(tangents).all(|(pair, (out, into))| {
        let length = times[pair[1]] - times[pair[0]];
        out.abs().max_element().max(into.abs().max_element()) <= length
    })
}

fn quat(value: DVec4) -> DQuat {
    DQuat::from_vec4(value)
}

/// Four numbers of whatever is moved.
pub(super) trait Widened {
    fn widened(&self) -> DVec4;
}

impl Widened for DVec3 {
    fn widened(&self) -> DVec4 {
        self.extend(0.0)
    }
}

impl Widened for DQuat {
    fn widened(&self) -> DVec4 {
        DVec4::from(*self)
    }
}

/// Puts a value into a pose.
pub(super) fn put(pose: &mut Trs, property: Property, value: DVec4) {
    match property {
        Property::Translation => pose.translation = value.truncate(),
        Property::Rotation => pose.rotation = quat(value),
        Property::Scale => pose.scale = value.truncate(),
        Property::Weights => {}
    }
}
