//! Keys go, one after another, as long as the error at the skin stays within the bound: each time the
//! one that adds the least to it for the bytes it saves.

use super::curve::{Change, Curve, Samples};
use super::round::round;
use super::state::{Below, Played, State};
use glam::DVec4;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Curves that have their keys at the same times.
struct Group {
    curves: Vec<usize>,
    below: Below,
}

/// A key that may go.
#[derive(Debug, PartialEq)]
struct Candidate {
    /// Error for bytes.
    cost: f64,
    group: usize,
    /// Its sample.
    at: usize,
}

impl Eq for Candidate {}

impl Ord for Candidate {
    /// The cheapest is the greatest.
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .cost
            .total_cmp(&self.cost)
            .then_with(|| (other.group, other.at).cmp(&(self.group, self.at)))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Which curves are tried as one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Still {
    /// Those with which nothing is off by more than [`HARDLY`] of the bound.
    Hardly,
    /// Those that have no keys but the first and the last.
    Ends,
}

/// See [`Still::Hardly`].
const HARDLY: f64 = 0.1;

/// Curves and the poses that they play.
pub(super) struct Thinning<'a> {
    state: State<'a>,
    curves: Vec<Curve>,
    groups: Vec<Group>,
    /// The values that each curve is to have.
    wanted: Vec<&'a [DVec4]>,
    samples: Samples<'a>,
    bound: f64,
    changes: Vec<Change>,
}

impl<'a> Thinning<'a> {
    /// `groups` are numbers of curves with equal keys; nothing where the curves are off by more than
    /// `bound` already.
    pub(super) fn new(
        mut state: State<'a>,
        curves: Vec<Curve>,
        wanted: Vec<&'a [DVec4]>,
        groups: Vec<Vec<usize>>,
        samples: Samples<'a>,
        bound: f64,
    ) -> Option<Self> {
        let below = state.below(curves.iter().map(|curve| curve.target));
        let played: Vec<Vec<DVec4>> = curves.iter().map(|c| c.played(samples.times)).collect();
        let parts: Vec<Played> = curves
            .iter()
            .zip(&played)
            .map(|(curve, values)| Played::from_start(curve.target, values))
            .collect();
        state.measure(&below, &parts, (0, samples.times.len() - 1), bound)?;
        state.take(&below);
        let groups = groups
            .into_iter()
            .map(|numbers| Group {
                below: state.below(numbers.iter().map(|&number| curves[number].target)),
                curves: numbers,
            })
            .collect();
        Some(Self {
            state,
            curves,
            groups,
            wanted,
            samples,
            bound,
            changes: Vec::new(),
        })
    }

    /// Rounds all values. Where that takes more than the bound leaves, the rotation with the longest
    /// lever above the worst place is not kept in 16 bits.
    pub(super) fn round(&mut self, bound: f64) -> Option<()> {
        let below = self
            .state
            .below(self.curves.iter().map(|curve| curve.target));
        let last = self.samples.times.len() - 1;
        loop {
            let mut curves = self.curves.clone();
            round(&self.state, &mut curves, self.samples);
            let played: Vec<Vec<DVec4>> = curves
                .iter()
                .map(|c| c.played(self.samples.times))
                .collect();
            let parts: Vec<Played> = curves
                .iter()
                .zip(&played)
                .map(|(curve, values)| Played::from_start(curve.target, values))
                .collect();
            if self
                .state
                .measure(&below, &parts, (0, last), bound)
                .is_some()
            {
                self.curves = curves;
                return Some(());
            }
            self.state.measure(&below, &parts, (0, last), f64::INFINITY);
            let worst = self.state.worst(&below);
            let levers = (0..self.curves.len()).filter(|&n| {
                self.curves[n].short && self.state.is_above(self.curves[n].target.node, worst)
            });
            let culprit = levers.max_by(|&a, &b| {
                let reach = |n: usize| self.state.reach(self.curves[n].target.node);
                reach(a).total_cmp(&reach(b))
            })?;
            self.curves[culprit].short = false;
        }
    }

    /// Takes out keys until none can go.
    pub(super) fn run(&mut self) {
        loop {
            let mut heap = BinaryHeap::new();
            for group in 0..self.groups.len() {
                let keys = self.curves[self.groups[group].curves[0]].at.clone();
                for at in keys {
                    let cost = self.measure(group, at);
                    heap.extend(cost.map(|cost| Candidate { cost, group, at }));
                }
            }
            let mut gone = 0;
            while let Some(next) = heap.pop() {
                let Some(cost) = self.measure(next.group, next.at) else {
                    continue;
                };
                // What went since may have made it dearer than others.
                if cost > next.cost && heap.peek().is_some_and(|other| cost > other.cost) {
                    heap.push(Candidate { cost, ..next });
                    continue;
                }
                self.take(next.group);
                gone += 1;
            }
            if gone == 0 {
                return;
            }
        }
    }

    /// Tries a group without its key at a sample.
    fn measure(&mut self, group: usize, at: usize) -> Option<f64> {
        let group = &self.groups[group];
        let first = &self.curves[group.curves[0]];
        let key = first.at.binary_search(&at).ok()?;
        if key == 0 || key + 1 == first.at.len() {
            return None;
        }
        let mut bytes = 4;
        self.changes
            .resize_with(group.curves.len().max(self.changes.len()), Change::default);
        let (mut from, mut to) = (usize::MAX, 0);
        for (&number, change) in group.curves.iter().zip(&mut self.changes) {
            let curve = &self.curves[number];
            curve.without(key, self.wanted[number], self.samples.times, change);
            if change.steep {
                return None;
            }
            bytes += curve.width();
            from = from.min(change.from);
            to = to.max(change.from + change.played.len() - 1);
        }
        let played: Vec<Played> = group
            .curves
            .iter()
            .zip(&self.changes)
            .map(|(&number, change)| Played {
                target: self.curves[number].target,
                from: change.from,
                values: &change.played,
            })
            .collect();
        let cost = self
            .state
            .measure(&group.below, &played, (from, to), self.bound)?;
        Some(cost / bytes as f64)
    }

    /// Takes what was measured last.
    fn take(&mut self, group: usize) {
        let group = &self.groups[group];
        self.state.take(&group.below);
        for (&number, change) in group.curves.iter().zip(&self.changes) {
            self.curves[number].take(change);
        }
    }

    pub(super) fn into_curves(self) -> Vec<Curve> {
        self.curves
    }

    #[cfg(test)]
    pub(super) fn parts(&mut self) -> (&State<'a>, &mut Vec<Curve>) {
        (&self.state, &mut self.curves)
    }

    /// Curves become one value that may be: at first those that hardly move, which would else have to
    /// share with all others what is left of the bound; then, once they are down to two keys, all.
    pub(super) fn settle(&mut self, rest: impl Fn(&Curve) -> DVec4, still: Still) {
        let last = self.samples.times.len() - 1;
        for number in 0..self.curves.len() {
            let curve = &self.curves[number];
            let bound = match still {
                Still::Hardly => HARDLY * self.bound,
                Still::Ends if curve.at.len() == 2 => self.bound,
                Still::Ends => continue,
            };
            let wanted = self.wanted[number];
            let mean =
                wanted.iter().fold(DVec4::ZERO, |sum, value| sum + *value) / wanted.len() as f64;
            for value in [rest(curve), mean] {
                let constant = self.curves[number].constant(value);
                let values = constant.played(self.samples.times);
                let played = [Played::from_start(constant.target, &values)];
                let below = self.state.below([constant.target].into_iter());
                let cost = self.state.measure(&below, &played, (0, last), bound);
                if cost.is_some() {
                    self.state.take(&below);
                    self.curves[number] = constant;
                    break;
                }
            }
        }
        for group in &mut self.groups {
            group
                .curves
                .retain(|&number| self.curves[number].at.len() > 1);
        }
        self.groups.retain(|group| !group.curves.is_empty());
    }
}
