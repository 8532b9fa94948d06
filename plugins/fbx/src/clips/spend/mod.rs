//! Spends what the first choice of keys left of the bound.
//!
//! Keys that are chosen channel by channel keep to the bound at the worst moment of a clip, at the joint
//! where the errors of all above it add up worst. Everywhere else they are more exact than was
//! asked. Here keys go from all channels together, held to the error at the skin where they go.

mod curve;
mod round;
mod state;
mod thin;

use super::choose::Choice;
use super::play::Player;
use super::reduce::Work;
use crate::model::{Channel, Interpolation, Property};
use curve::{Curve, Samples, Target, Widened};
use glam::DVec4;
use state::{Played, State};
use std::collections::BTreeSet;
use thin::Thinning;

/// Smaller keys for what `first` moves, with at most `bound` metres of error.
pub(super) fn spend(work: &Work, first: &[Choice], bound: f64) -> Option<Vec<Choice>> {
    Spending::new(work, first, bound)?.best()
}

struct Spending<'a> {
    work: &'a Work<'a>,
    first: &'a [Choice],
    bound: f64,
    /// Numbers of choices that change, and what they are to be.
    open: Vec<usize>,
    targets: Vec<Target>,
    wanted: Vec<Vec<DVec4>>,
    morph: Vec<f64>,
}

#[derive(Clone, Default)]
struct Plan {
    cubic: Vec<bool>,
    groups: Vec<Vec<usize>>,
}

impl<'a> Spending<'a> {
    fn new(work: &'a Work<'a>, first: &'a [Choice], bound: f64) -> Option<Self> {
        let tracks = &work.samples.tracks;
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
            let moves = channel.times.len() > 1
                && channel.interpolation != Interpolation::Step
                && channel.property != Property::Weights;
            if !moves {
                continue;
            }
            let track = tracks.iter().position(|track| track.node == channel.node)?;
            let columns = &work.columns[track];
            out.open.push(number);
            out.targets.push(Target {
                track,
                node: channel.node,
                property: channel.property,
            });
            out.wanted.push(match channel.property {
                Property::Rotation => columns.rotations.iter().map(Widened::widened).collect(),
                Property::Scale => columns.scales.iter().map(Widened::widened).collect(),
                _ => columns.translations.iter().map(Widened::widened).collect(),
            });
        }
        (!out.open.is_empty()).then_some(out)
    }

    fn samples(&self) -> Samples<'_> {
        Samples {
            times: &self.work.times,
            jumps: &self.work.samples.grid.jumps,
            stops: &self.work.samples.stops,
        }
    }

    /// The poses that the channels which do not change play.
    fn state(&self) -> State<'_> {
        let mut state = State::new(self.work, self.morph.clone());
        for (number, choice) in self.first.iter().enumerate() {
            let channel = &choice.channel;
            if self.open.contains(&number) || channel.property == Property::Weights {
                continue;
            }
            let Some(track) = self.work.samples.tracks.iter().position(|t| t.node == channel.node)
            else {
                continue;
            };
            let target = Target {
                track,
                node: channel.node,
                property: channel.property,
            };
            let mut player = Player::new(channel);
            let values: Vec<DVec4> = self
                .work
                .times
                .iter()
                .map(|&time| {
                    let mut out = [0.0; 4];
                    let width = player.width();
                    player.at(time, &mut out[..width]);
                    DVec4::from_array(out)
                })
                .collect();
            state.hold(&Played {
                target,
                from: 0,
                values: &values,
            });
        }
        state
    }

    fn is_short(&self, number: usize) -> bool {
        let target = self.targets[number];
        target.property == Property::Rotation
    }

    /// Straight lines through all stops are near enough.
    fn may_be_straight(&self) -> Vec<bool> {
        let samples = self.samples();
        let one = |number: usize| {
            let target = self.targets[number];
            let lever = self.work.leverage[target.node];
            let lever = match target.property {
                Property::Rotation => 2.0 * lever.rotation,
                Property::Scale => lever.scale,
                _ => lever.translation,
            };
            let wanted = &self.wanted[number];
            let curve = Curve::through(target, false, false, samples.stops, wanted, samples);
            let played = curve.played(samples.times);
            let off = played.iter().zip(wanted).map(|(a, b)| a.distance(*b));
            off.fold(0.0, f64::max) * lever <= 0.3 * self.bound
        };
        (0..self.open.len()).map(one).collect()
    }

    fn rest(&self, curve: &Curve) -> DVec4 {
        let rest = self.work.rest[curve.target.node];
        match curve.target.property {
            Property::Rotation => rest.rotation.widened(),
            Property::Scale => rest.scale.widened(),
            _ => rest.translation.widened(),
        }
    }

    fn run(&self, plan: &Plan, theta: f64) -> Option<Vec<Curve>> {
        let samples = self.samples();
        let curves = (0..self.open.len())
            .map(|number| {
                let wanted = &self.wanted[number];
                let make = |short| {
                    Curve::through(
                        self.targets[number],
                        plan.cubic[number],
                        short,
                        samples.stops,
                        wanted,
                        samples,
                    )
                };
                let short = make(self.is_short(number));
                match short.fits_short(samples.times) {
                    true => short,
                    false => make(false),
                }
            })
            .collect();
        let wanted = self.wanted.iter().map(Vec::as_slice).collect();
        let mut thinning = Thinning::new(
            self.state(),
            curves,
            wanted,
            plan.groups.clone(),
            samples,
            theta * self.bound,
        )?;
        thinning.run();
        thinning.settle(|curve| self.rest(curve));
        thinning.round(self.bound)?;
        Some(thinning.curves)
    }

    fn best(&self) -> Option<Vec<Choice>> {
        let count = self.open.len();
        let alone: Vec<Vec<usize>> = (0..count).map(|number| vec![number]).collect();
        let trace = std::env::var_os("SPEND_TRACE").is_some();
        if trace {
            eprintln!("  first: {}", super::reduce::bytes_of(self.first));
        }
        let mut best: Option<(usize, Vec<Curve>)> = None;
        let consider = |best: &mut Option<(usize, Vec<Curve>)>, name: &str, plan: &Plan| {
            let mut smallest: Option<(usize, Vec<Curve>)> = None;
            for theta in [0.97, 0.85, 0.65, 0.45] {
                let Some(curves) = self.run(plan, theta) else {
                    continue;
                };
                let size = self.bytes(&curves);
                if trace {
                    let keys = curves.iter().map(|c| c.at.len()).sum::<usize>();
                    eprintln!("  {name} {theta}: {size} bytes, {keys} keys, {} cubic, {} short of {}", curves.iter().filter(|c| c.cubic).count(), curves.iter().filter(|c| c.short).count(), curves.len());
                }
                if smallest.as_ref().is_none_or(|(least, _)| size < *least) {
                    smallest = Some((size, curves));
                }
            }
            if let Some((size, curves)) = &smallest
                && best.as_ref().is_none_or(|(least, _)| size < least)
            {
                *best = Some((*size, curves.clone()));
            }
            smallest.map(|(_, curves)| curves)
        };
        let straight: Vec<bool> = self.may_be_straight();
        let lines = Plan {
            cubic: straight.iter().map(|straight| !straight).collect(),
            groups: alone.clone(),
        };
        let lines = consider(&mut best, "straight", &lines);
        let cubics = Plan {
            cubic: vec![true; count],
            groups: alone.clone(),
        };
        let cubics = consider(&mut best, "cubics", &cubics);
        let cost = |c: &Curve| c.at.len() * (4 + c.width());
        let cubic: Vec<bool> = match (&lines, &cubics) {
            (Some(lines), Some(cubics)) => lines.iter().zip(cubics).map(|(a, b)| a.cubic || cost(b) < cost(a)).collect(),
            _ => straight.iter().map(|straight| !straight).collect(),
        };
        let mixed = Plan {
            cubic: cubic.clone(),
            groups: alone.clone(),
        };
        consider(&mut best, "mixed", &mixed);
        if let Some(lines) = &lines {
            for all in [false, true] {
                let mut together: Vec<usize> = (0..count)
                    .filter(|&n| straight[n] && (all || !cubic[n]) && lines[n].at.len() > 1)
                    .collect();
                for _ in 0..3 {
                    if together.len() < 2 {
                        break;
                    }
                    let is_cubic: Vec<bool> = (0..count).map(|n| cubic[n] && !together.contains(&n)).collect();
                    let mut groups: Vec<Vec<usize>> = (0..count)
                        .filter(|n| !together.contains(n))
                        .map(|n| vec![n])
                        .collect();
                    groups.push(together.clone());
                    let plan = Plan { cubic: is_cubic, groups };
                    let Some(made) = consider(&mut best, "together", &plan) else { break };
                    // Those that would do with few keys of their own leave.
                    let before = together.len();
                    let keys = made[together[0]].at.len();
                    together.retain(|&n| {
                        let width = made[n].width();
                        let own = if cubic[n] { cubics.as_ref().map_or(usize::MAX, |c| cost(&c[n])) } else { lines[n].at.len() * (4 + width) };
                        own > keys * width
                    });
                    if trace { eprintln!("    {} of {before} stay", together.len()); }
                    if together.len() == before {
                        break;
                    }
                }
            }
        }
        let (_, curves) = best?;
        let mut out: Vec<Choice> = self
            .first
            .iter()
            .map(|choice| Choice {
                channel: choice.channel.clone(),
                at_rest: choice.at_rest,
            })
            .collect();
        for (&number, curve) in self.open.iter().zip(&curves) {
            let rest = self.rest(curve);
            out[number].at_rest = curve.at.len() == 1 && curve.values[0].distance(rest) < 1e-7;
            out[number].channel = curve.channel(&self.work.times);
        }
        Some(out)
    }

    fn bytes(&self, curves: &[Curve]) -> usize {
        let mut known = BTreeSet::new();
        let of = |curve: &Curve| -> Channel { curve.channel(&self.work.times) };
        let fixed = (0..self.first.len()).filter(|number| !self.open.contains(number));
        let fixed: usize = fixed
            .map(|number| self.first[number].channel.bytes(&mut known))
            .sum();
        fixed + curves.iter().map(|curve| of(curve).bytes(&mut known)).sum::<usize>()
    }
}
