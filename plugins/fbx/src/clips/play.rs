//! Playing keys back as glTF's specification says, in f64.

use super::value::{Arc, Value, hermite};
use crate::model::{Channel, Interpolation, Property, Trs};
use glam::{DQuat, DVec3};

/// Where every node is.
pub(crate) type Pose = Vec<Trs>;

/// A channel, and the key that the last time was after.
pub(crate) struct Player<'a> {
    channel: &'a Channel,
    width: usize,
    at: usize,
    /// The way from a key of a rotation to the next one, and which: many times lie between the same two.
    arc: Option<(usize, Arc)>,
    /// Scratch for weights.
    weights: Vec<f64>,
}

impl<'a> Player<'a> {
    pub(crate) fn new(channel: &'a Channel) -> Self {
        let values = match channel.interpolation {
            Interpolation::Cubic => 3,
            _ => 1,
        };
        let width = channel.values.len() / (channel.times.len() * values).max(1);
        Self {
            channel,
            width,
            at: 0,
            arc: None,
            weights: Vec::new(),
        }
    }

    /// It has one key, of what moves a node.
    pub(crate) fn stands(&self) -> bool {
        self.channel.times.len() == 1 && self.channel.property != Property::Weights
    }

    /// Numbers of a value.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// The channel's value at `time`, seconds from the clip's start; `out` takes [`Player::width`]
    /// numbers. Fast where times grow.
    pub(crate) fn at(&mut self, time: f64, out: &mut [f64]) {
        let times = &self.channel.times;
        let at = self.seek(time);
        let begin = f64::from(times[at]);
        if at + 1 == times.len()
            || time <= begin
            || self.channel.interpolation == Interpolation::Step
        {
            self.copy(at, out);
            return;
        }
        let length = f64::from(times[at + 1]) - begin;
        let share = (time - begin) / length;
        match self.channel.interpolation {
            Interpolation::Cubic => self.cubic(at, share, length, out),
            _ => self.linear(at, share, out),
        }
        if self.channel.property == Property::Rotation {
            let rotation = DQuat::from_slice(out).finish();
            out.copy_from_slice(&rotation.to_array());
        }
    }

    /// The last key that `time` is not before; the first one where it is before all. Fast where times grow.
    pub(crate) fn seek(&mut self, time: f64) -> usize {
        let times = &self.channel.times;
        let is_after = |at: usize| times.get(at).is_none_or(|&key| f64::from(key) > time);
        if is_after(self.at) || !is_after(self.at + 1) {
            // Mostly the next one.
            self.at = match is_after(self.at) || !is_after(self.at + 2) {
                true => times
                    .partition_point(|&key| f64::from(key) <= time)
                    .saturating_sub(1),
                false => self.at + 1,
            };
        }
        self.at
    }

    fn key(&self, index: usize) -> &'a [f32] {
        &self.channel.values[index * self.width..(index + 1) * self.width]
    }

    fn copy(&self, at: usize, out: &mut [f64]) {
        let index = match self.channel.interpolation {
            Interpolation::Cubic => at * 3 + 1,
            _ => at,
        };
        for (out, &value) in out.iter_mut().zip(self.key(index)) {
            *out = f64::from(value);
        }
        if self.channel.property == Property::Rotation {
            let rotation = DQuat::from_slice(out).finish();
            out.copy_from_slice(&rotation.to_array());
        }
    }

    /// Of a linear channel of rotations: the way from key `at` to the next one.
    pub(crate) fn arc(&mut self, at: usize) -> &Arc {
        let known = self.arc.take().filter(|(known, _)| *known == at);
        let (from, to) = (self.key(at), self.key(at + 1));
        let made = known.unwrap_or_else(|| {
            let quat =
                |k: &[f32]| DQuat::from_array([0, 1, 2, 3].map(|i| f64::from(k[i]))).finish();
            (at, DQuat::line(&quat(from), &quat(to)))
        });
        &self.arc.insert(made).1
    }

    fn linear(&mut self, at: usize, share: f64, out: &mut [f64]) {
        if self.channel.property == Property::Rotation {
            let mixed = DQuat::on_line(self.arc(at), share);
            out.copy_from_slice(&mixed.to_array());
            return;
        }
        let (from, to) = (self.key(at), self.key(at + 1));
        for (i, out) in out.iter_mut().enumerate() {
            let (from, to) = (f64::from(from[i]), f64::from(to[i]));
            *out = from + (to - from) * share;
        }
    }

    fn cubic(&self, at: usize, share: f64, length: f64, out: &mut [f64]) {
        let [a, b, c, d] = hermite(share);
        let (from, leave) = (self.key(at * 3 + 1), self.key(at * 3 + 2));
        let (arrive, to) = (self.key(at * 3 + 3), self.key(at * 3 + 4));
        for (i, out) in out.iter_mut().enumerate() {
            let [from, leave, arrive, to] = [from, leave, arrive, to].map(|key| f64::from(key[i]));
            *out = a * from + b * length * leave + c * to + d * length * arrive;
        }
    }
}

/// Lays what `players` say at `time` over `pose`; weights of morph targets are given to `morph`.
pub(crate) fn play(
    players: &mut [Player],
    time: f64,
    pose: &mut Pose,
    mut morph: impl FnMut(usize, &[f64]),
) {
    let mut numbers = [0.0; 4];
    for player in players {
        let node = player.channel.node;
        match player.channel.property {
            Property::Translation => {
                player.at(time, &mut numbers[..3]);
                pose[node].translation = DVec3::from_slice(&numbers);
            }
            Property::Rotation => {
                player.at(time, &mut numbers);
                pose[node].rotation = DQuat::from_slice(&numbers);
            }
            Property::Scale => {
                player.at(time, &mut numbers[..3]);
                pose[node].scale = DVec3::from_slice(&numbers);
            }
            Property::Weights => {
                let mut weights = std::mem::take(&mut player.weights);
                weights.resize(player.width(), 0.0);
                player.at(time, &mut weights);
                morph(node, &weights);
                player.weights = weights;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(property: Property, interpolation: Interpolation, values: &[f32]) -> Channel {
        Channel {
            node: 0,
            property,
            interpolation,
            times: vec![1.0, 2.0],
            values: values.to_vec(),
            short: false,
        }
    }

    fn at(channel: &Channel, time: f64) -> Vec<f64> {
        let mut player = Player::new(channel);
        let mut out = vec![0.0; player.width()];
        player.at(time, &mut out);
        out
    }

    #[test]
    fn steps_hold_and_lines_mix() {
        let values = [0.0, 0.0, 0.0, 2.0, 4.0, 6.0];
        let step = channel(Property::Translation, Interpolation::Step, &values);
        assert_eq!(at(&step, 1.999), [0.0, 0.0, 0.0]);
        assert_eq!(at(&step, 2.0), [2.0, 4.0, 6.0]);
        let linear = channel(Property::Translation, Interpolation::Linear, &values);
        assert_eq!(at(&linear, 1.5), [1.0, 2.0, 3.0]);
        assert_eq!(at(&linear, -1.0), [0.0, 0.0, 0.0]);
        assert_eq!(at(&linear, 9.0), [2.0, 4.0, 6.0]);
    }

    #[test]
    fn cubics_follow_their_tangents() {
        // x = (t - 1)^3: value 0 and slope 0 at 1, value 1 and slope 3 at 2.
        let values = [0.0, 0.0, 0.0, 3.0, 1.0, 0.0];
        let cubic = channel(Property::Weights, Interpolation::Cubic, &values);
        for time in [1.0, 1.25, 1.5, 1.75, 2.0] {
            let x: f64 = time - 1.0;
            assert!((at(&cubic, time)[0] - x * x * x).abs() < 1e-15);
        }
    }

    #[test]
    fn rotations_go_along_the_great_circle() {
        let quarter = DQuat::from_rotation_y(1.0);
        let mut values = DQuat::IDENTITY.as_quat().to_array().to_vec();
        values.extend(quarter.as_quat().to_array());
        let linear = channel(Property::Rotation, Interpolation::Linear, &values);
        let half = DQuat::from_slice(&at(&linear, 1.5));
        assert!(half.angle_between(DQuat::from_rotation_y(0.5)) < 1e-6);
    }
}
