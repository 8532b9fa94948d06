//! Spends what the first choice of keys left of the bound.
//!
//! Keys that are chosen channel by channel keep to the bound at the worst moment of a clip, at the joint
//! where the errors of all above it add up worst. Everywhere else they are more exact than was
//! asked. Here keys go from all channels together, each held to the error at the skin where and when it
//! goes ([`thin`]); rotations are rounded to 16 bits from the roots to the tips, so that joints make good
//! what those above them were rounded by ([`round`]); and channels that need about as many keys as each
//! other share their times ([`alike`]). Which kinds of keys and which groups are smallest is tried out
//! ([`plan`]).

mod alike;
mod curve;
mod fit;
mod plan;
mod round;
mod state;
#[cfg(test)]
mod tests;
mod thin;

use super::choose::Choice;
use super::play::Player;
use super::work::Work;
use crate::model::{Interpolation, Property};
use curve::{Curve, Samples, Target, Widened};
use glam::DVec4;
use state::{Played, State};
use std::collections::BTreeSet;
use thin::{Still, Thinning};

pub(super) use plan::spend;

/// Channels that are chosen anew, and what stays.
struct Spending<'a> {
    work: &'a Work<'a>,
    first: &'a [Choice],
    /// Metres.
    bound: f64,
    /// Numbers of choices that change, and what they are to be.
    open: Vec<usize>,
    targets: Vec<Target>,
    wanted: Vec<Vec<DVec4>>,
    /// What morph targets are off by at each sample, metres.
    morph: Vec<f64>,
}

/// For each channel that changes whether its keys are cubic, and which have their keys at the same
/// times; each is in one group.
#[derive(Debug, Clone, Default)]
struct Plan {
    cubic: Vec<bool>,
    groups: Vec<Vec<usize>>,
}

impl<'a> Spending<'a> {
    /// `None` where nothing moves but in steps.
    fn new(work: &'a Work<'a>, first: &'a [Choice], bound: f64) -> Option<Self> {
        let mut out = Self {
            work,
            first,
            bound,
            open: Vec::new(),
            targets: Vec::new(),
            wanted: Vec::new(),
            morph: work.morph_errors(first),
        };
        for (number, choice) in first.iter().enumerate() {
            let channel = &choice.channel;
            if channel.times.len() < 2 || channel.interpolation == Interpolation::Step {
                continue;
            }
            let Some(target) = out.target(number) else {
                continue;
            };
            let columns = &work.columns[target.track];
            out.open.push(number);
            out.targets.push(target);
            out.wanted.push(match channel.property {
                Property::Rotation => columns.rotations.iter().map(Widened::widened).collect(),
                Property::Scale => columns.scales.iter().map(Widened::widened).collect(),
                _ => columns.translations.iter().map(Widened::widened).collect(),
            });
        }
        (!out.open.is_empty()).then_some(out)
    }

    /// What a choice moves; `None` for weights of morph targets.
    fn target(&self, number: usize) -> Option<Target> {
        let channel = &self.first[number].channel;
        let mut tracks = self.work.samples.tracks.iter();
        let track = tracks.position(|track| track.node == channel.node)?;
        (channel.property != Property::Weights).then_some(Target {
            track,
            node: channel.node,
            property: channel.property,
        })
    }

    fn samples(&self) -> Samples<'_> {
        Samples {
            times: &self.work.times,
            stops: &self.work.samples.stops,
        }
    }

    /// The file's poses, and what the channels that stay play.
    fn state(&self) -> State<'_> {
        let mut state = State::new(self.work, self.morph.clone());
        for (number, choice) in self.first.iter().enumerate() {
            let Some(target) = self.target(number).filter(|_| !self.open.contains(&number)) else {
                continue;
            };
            let mut player = Player::new(&choice.channel);
            let value = |&time: &f64| {
                let mut out = [0.0; 4];
                let width = player.width();
                player.at(time, &mut out[..width]);
                DVec4::from_array(out)
            };
            let values: Vec<DVec4> = self.work.times.iter().map(value).collect();
            state.hold(&Played::from_start(target, &values));
        }
        state
    }

    /// Curves with keys on all stops.
    fn dense(&self, plan: &Plan) -> Vec<Curve> {
        let samples = self.samples();
        let one = |number: usize| {
            let (target, cubic) = (self.targets[number], plan.cubic[number]);
            let wanted = &self.wanted[number];
            let mut curve = Curve::through(target, cubic, samples.stops, wanted, samples);
            curve.short = curve.is_rotation() && curve.fits_short(samples.times);
            curve
        };
        (0..self.open.len()).map(one).collect()
    }

    /// Curves of a plan, thinned to `share` of the bound and rounded to within it; `None` where that
    /// cannot be.
    fn run(&self, plan: &Plan, share: f64) -> Option<Vec<Curve>> {
        let wanted = self.wanted.iter().map(Vec::as_slice).collect();
        let mut thinning = Thinning::new(
            self.state(),
            self.dense(plan),
            wanted,
            plan.groups.clone(),
            self.samples(),
            share * self.bound,
        )?;
        thinning.settle(|curve| self.rest(curve), Still::Hardly);
        thinning.run();
        thinning.settle(|curve| self.rest(curve), Still::Ends);
        thinning.round(self.bound)?;
        Some(thinning.into_curves())
    }

    fn rest(&self, curve: &Curve) -> DVec4 {
        let rest = self.work.rest[curve.target.node];
        match curve.target.property {
            Property::Rotation => rest.rotation.widened(),
            Property::Scale => rest.scale.widened(),
            _ => rest.translation.widened(),
        }
    }

    /// All choices, with `curves` in place of those that change.
    fn choices(&self, curves: &[Curve]) -> Vec<Choice> {
        let mut out: Vec<Choice> = self.first.to_vec();
        for (&number, curve) in self.open.iter().zip(curves) {
            out[number] = Choice {
                at_rest: curve.is_constant(self.rest(curve)),
                channel: curve.channel(&self.work.times),
            };
        }
        out
    }

    /// Bytes of all choices that are not at rest, with `curves` in place.
    fn bytes(&self, curves: &[Curve]) -> usize {
        let mut known = BTreeSet::new();
        let choices = self.choices(curves);
        let moving = choices.iter().filter(|choice| !choice.at_rest);
        moving.map(|choice| choice.channel.bytes(&mut known)).sum()
    }
}
