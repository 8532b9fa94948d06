//! Which kinds of keys, and which groups of channels, are smallest: tried out.

use super::alike::{self, Need};
use super::curve::Curve;
use super::{Plan, Spending};
use crate::clips::choose::Choice;
use crate::clips::parts::in_parts;
use crate::clips::work::Work;
use crate::model::Property;
use crate::options::{Budget, Options};

/// Shares of the bound that keys are thinned to; rounding gets the rest. With less, more keys stay, and
/// more rotations fit into 16 bits.
const SHARES: [f64; 2] = [0.97, 0.85];

/// The share for the tries that only tell how many keys each channel needs.
const TRIED: f64 = 0.9;

/// How many times the keys of its neediest member a group is thought to need: the more, the more curves
/// stay alone.
const MORE: [f64; 3] = [0.75, 1.0, 1.2];

/// Lines through all stops that are nearer than this share of the bound leave room to thin them.
const STRAIGHT: f64 = 0.3;

/// Clips with more keys than this, dense, are tried in one plan alone, with more than the second not at
/// all, for there are up to sixteen plans. Counted, not timed, so that the result does not depend on the machine.
const MOST: [usize; 2] = [16_000, 160_000];

/// Work of a key in a plan, in poses of nodes: some 17 microseconds (measured, trees of 18 and 35 joints).
const KEY: usize = 17;

/// Bytes that a sample of a moving node takes while a plan is tried: two poses, three matrices, two
/// rotations, an error.
const TRIAL: usize = 500;

/// Smaller keys for what `first` moves, with at most `bound` metres of error; `None` where there are
/// none, or no more work can be paid for.
pub(in crate::clips) fn spend(
    work: &Work,
    first: &[Choice],
    bound: f64,
    options: &Options,
    budget: &Budget,
) -> Option<Vec<Choice>> {
    let spending = Spending::new(work, first, bound)?;
    let dense = spending.open.len() * work.samples.stops.len();
    if dense > MOST[1] {
        return None;
    }
    let trial = work.truth.len() * TRIAL;
    let affordable = budget.limits.memory / 2 / trial.max(1);
    let threads = options.thread_count().min(affordable.max(1));
    let search = Search {
        spending,
        threads,
        budget,
    };
    search.best()
}

struct Search<'a> {
    spending: Spending<'a>,
    threads: usize,
    budget: &'a Budget,
}

impl Search<'_> {
    fn best(&self) -> Option<Vec<Choice>> {
        let count = self.spending.open.len();
        let straight = self.may_be_straight();
        let alone = |cubic: Vec<bool>| Plan {
            cubic,
            groups: (0..count).map(|number| vec![number]).collect(),
        };
        let lines = alone(straight.iter().map(|straight| !straight).collect());
        let cubics = alone(vec![true; count]);
        let tried = self.run(&[(&lines, TRIED), (&cubics, TRIED)]);
        let mut plans = vec![lines, cubics];
        if let [Some(lines), Some(cubics)] = &tried[..] {
            let pairs = lines.iter().zip(cubics);
            let cubic: Vec<bool> = pairs
                .map(|(a, b)| a.cubic || alone_bytes(b) < alone_bytes(a))
                .collect();
            let needs: Vec<Need> = lines.iter().zip(cubics).map(need).collect();
            let mut groupings = match self.is_long() {
                true => vec![alike::groups(&needs, MORE[1])],
                false => MORE.map(|more| alike::groups(&needs, more)).to_vec(),
            };
            if self.is_long() {
                plans.clear();
            } else {
                let all = (0..count).filter(|&number| needs[number].keys > 0);
                groupings.extend([vec![all.collect()], Vec::new()]);
            }
            groupings.dedup();
            let groupings = groupings.into_iter();
            plans.extend(groupings.map(|groups| self.plan(&cubic, groups)));
        }
        let jobs: Vec<(&Plan, f64)> = plans
            .iter()
            .flat_map(|plan| SHARES.map(|share| (plan, share)))
            .skip(usize::from(self.is_long()))
            .collect();
        let made = self.run(&jobs).into_iter().chain(tried);
        let sized = made
            .flatten()
            .map(|curves| (self.spending.bytes(&curves), curves));
        let best = sized.min_by_key(|(bytes, _)| *bytes);
        best.map(|(_, curves)| self.spending.choices(&curves))
    }

    fn is_long(&self) -> bool {
        self.dense() > MOST[0]
    }

    /// Keys where every stop has one.
    fn dense(&self) -> usize {
        self.spending.open.len() * self.spending.work.samples.stops.len()
    }

    /// `groups` of straight curves, and everything else alone.
    fn plan(&self, cubic: &[bool], mut groups: Vec<Vec<usize>>) -> Plan {
        groups.retain(|group| !group.is_empty());
        let grouped: Vec<usize> = groups.concat();
        let others = (0..cubic.len()).filter(|number| !grouped.contains(number));
        groups.extend(others.map(|number| vec![number]));
        let mut cubic = cubic.to_vec();
        for number in grouped {
            cubic[number] = false;
        }
        Plan { cubic, groups }
    }

    /// As many of `jobs` as can be paid for.
    fn run(&self, jobs: &[(&Plan, f64)]) -> Vec<Option<Vec<Curve>>> {
        let each = KEY * self.dense();
        let paid = jobs.iter().take_while(|_| self.budget.pays(each)).count();
        let made = in_parts(paid, self.threads, |range| {
            jobs[range]
                .iter()
                .map(|(plan, share)| self.spending.run(plan, *share))
                .collect::<Vec<_>>()
        });
        made.into_iter().flatten().collect()
    }

    /// For each channel whether lines through all stops are near enough.
    fn may_be_straight(&self) -> Vec<bool> {
        let spending = &self.spending;
        let count = spending.open.len();
        let plan = Plan {
            cubic: vec![false; count],
            groups: Vec::new(),
        };
        let one = |(number, curve): (usize, Curve)| {
            let lever = spending.work.leverage[curve.target.node];
            // An angle is twice the distance of its quaternions.
            let lever = match curve.target.property {
                Property::Rotation => 2.0 * lever.rotation,
                Property::Scale => lever.scale,
                _ => lever.translation,
            };
            let played = curve.played(&spending.work.times);
            let off = played.iter().zip(&spending.wanted[number]);
            let off = off.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            off * lever <= STRAIGHT * spending.bound
        };
        spending
            .dense(&plan)
            .into_iter()
            .enumerate()
            .map(one)
            .collect()
    }
}

/// Bytes of a curve with times of its own.
fn alone_bytes(curve: &Curve) -> usize {
    curve.at.len() * (4 + curve.width())
}

/// What a curve needs, as straight lines and as cubics.
fn need((line, cubic): (&Curve, &Curve)) -> Need {
    Need {
        keys: match line.cubic || line.at.len() == 1 {
            true => 0,
            false => line.at.len(),
        },
        width: line.width(),
        alone: alone_bytes(line).min(alone_bytes(cubic)),
    }
}
