//! From samples to keys that keep to a bound.

use super::choose::{Choice, Kinds};
use super::grid::Grid;
use super::metric::{Leverage, Shells};
use super::pack::{Packed, pack};
use super::play::Pose;
use super::refine::{KNOWN_TO, Source};
use super::sample::Samples;
use super::spend::spend;
use super::work::Work;
use crate::model::{Clip, Interpolation, Model};
use crate::options::{Budget, Compression, Effort, Options};
use crate::report::ClipReport;
use std::collections::BTreeSet;

/// Tries at a share of the bound for each joint. Errors of joints along a chain add up, and by how
/// much is only known once they are measured.
const TRIES: usize = 3;

/// The first try's share.
const FIRST_SHARE: f64 = 0.4;

/// An error above this share of the bound is near enough to it: twice the error is one key in five less.
const ENOUGH: f64 = 0.3;

/// The share of the bound that keys get where nothing that counts lies between samples; f32 gets the rest.
const ON_SAMPLES: f64 = 0.98;

/// Shares of the bound that keys are searched with where their values are rounded afterwards.
const SPARSE_SHARES: [f64; 2] = [0.75, 0.4];

/// Shares of the bound that each channel by itself gets for straight keys, which cost a third of cubic ones there.
const LINE_SHARES: [f64; 4] = [0.6, 0.35, 0.2, 0.1];

/// Poses that the leverage of joints is taken over.
const LEVER_POSES: usize = 8;

/// A clip with keys, and what to say of it.
pub(crate) struct Reduced {
    pub(crate) clip: Clip,
    /// For each channel of the clip: it never leaves its value at rest.
    pub(crate) at_rest: Vec<bool>,
    pub(crate) report: ClipReport,
    pub(crate) bytes: KeyBytes,
}

/// Bytes of a clip's keys and times, without those of what never leaves its rest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KeyBytes {
    /// Those that a plain file would have.
    pub(crate) plain: usize,
    /// Those of the keys that were chosen, coded where that is less.
    pub(crate) chosen: usize,
    /// The chosen keys are those of a plain file.
    pub(crate) same: bool,
}

/// Keys for a clip, or a part of one, with at most `bound` metres of error at the skin over its samples.
/// `kinds` says for a part what the other parts have.
pub(super) fn reduce(
    samples: &Samples,
    source: &Source,
    shells: &Shells,
    leverage: Vec<Leverage>,
    bound: f64,
    kinds: &[Kinds],
) -> Reduced {
    let Source {
        take,
        model,
        options,
        budget,
        ..
    } = *source;
    let work = Work::new(samples, model, shells, leverage, options);
    let bound = for_keys(&samples.grid) * bound;
    let (mut error, mut choices) = keys(&work, bound, kinds, options, budget);
    let plain = moving_bytes(&choices);
    let mut bytes = KeyBytes {
        plain,
        chosen: plain,
        same: true,
    };
    // Parts of a clip have to have the same kinds of keys.
    if options.compress == Compression::Meshopt && kinds.is_empty() {
        // The purse is the search's: what it pays for must not be taken from the keys of a later clip, which would be more.
        let packed = budget.search(|purse| packed(&work, (error, &choices), bound, options, purse));
        if let Some(packed) = packed {
            (error, choices) = (packed.error, packed.choices);
            bytes.chosen = packed.bytes;
            bytes.same = packed.same;
        }
    }
    let keys = choices
        .iter()
        .map(|choice| choice.channel.times.len())
        .sum();
    let moving = choices
        .iter()
        .filter(|choice| choice.channel.times.len() > 1)
        .count();
    let at_rest = choices.iter().map(|choice| choice.at_rest).collect();
    let last = samples.grid.labels.last().copied().unwrap_or(0.0);
    Reduced {
        at_rest,
        bytes,
        report: ClipReport {
            name: take.stack().element.name.to_string(),
            seconds: f64::from(last),
            keys,
            baked: moving * samples.first,
            error,
            keyed_error: error,
            samples: samples.grid.len(),
            unseen: 1.0,
        },
        clip: Clip {
            name: take.stack().element.name.to_string(),
            begin: take.plan.begin,
            duration: f64::from(last),
            channels: choices.into_iter().map(|choice| choice.channel).collect(),
        },
    }
}

/// Keys for the codec, from those of a plain file and their error.
fn packed(
    work: &Work,
    (error, plain): (f64, &[Choice]),
    bound: f64,
    options: &Options,
    purse: &Budget,
) -> Option<Packed> {
    // Rounding takes its share of the bound, so that keys have to leave some.
    let mut sparse = vec![plain.to_vec()];
    for share in SPARSE_SHARES {
        sparse.push(keys(work, share * bound, &[], options, purse).1);
    }
    let lines = vec![Kinds::Linear; work.samples.tracks.len() * 3];
    for share in LINE_SHARES {
        sparse.push(work.choose(share * bound, &lines, options));
    }
    pack(work, &sparse, error, bound, options, purse)
}

/// Keys for a clip, with their error. The tries that a first one leaves to be made end with the budget's work.
fn keys(
    work: &Work,
    bound: f64,
    kinds: &[Kinds],
    options: &Options,
    budget: &Budget,
) -> (f64, Vec<Choice>) {
    let mut best: Option<(usize, f64, Vec<Choice>)> = None;
    let mut share = FIRST_SHARE;
    let is_part = !kinds.is_empty();
    let mut kinds = kinds.to_vec();
    for attempt in 0..TRIES + 8 {
        // A try takes about as long as the poses of its samples.
        if attempt > 0 && !budget.pays(work.samples.tracks.len() * work.times.len()) {
            break;
        }
        let choices = work.choose(share * bound, &kinds, options);
        if kinds.is_empty() {
            kinds = choices.iter().map(kind).collect();
        }
        let error = work.error(&choices, options);
        let size = bytes_of(&choices);
        let good = error <= bound;
        if good && best.as_ref().is_none_or(|(smallest, ..)| size < *smallest) {
            best = Some((size, error, choices));
        }
        let enough = good && error > ENOUGH * bound;
        if enough || (best.is_some() && (attempt + 1 >= TRIES || error == 0.0)) {
            break;
        }
        // A twelfth of leave, since errors do not grow quite in proportion.
        share *= (bound / error.max(1e-12) * 0.92).clamp(0.05, 4.0);
    }
    let (error, choices) = match best {
        Some((_, error, choices)) => (error, choices),
        // What is left is the rounding of f32: every sample is a key.
        None => {
            let choices = work.choose(0.0, &kinds, options);
            (work.error(&choices, options), choices)
        }
    };
    let (error, choices) = match options.effort {
        _ if is_part => (error, choices),
        Effort::Quick => (error, choices),
        Effort::Thorough => {
            let spent = budget.search(|purse| spend(work, &choices, bound, options, purse));
            let spent = spent.map(|spent| (work.error(&spent, options), spent));
            let better = spent.filter(|(error, spent)| {
                *error <= bound && moving_bytes(spent) < moving_bytes(&choices)
            });
            better.unwrap_or((error, choices))
        }
    };
    (error, choices)
}

/// The share of the bound that keys get; what lies between samples is known to the rest of it.
fn for_keys(grid: &Grid) -> f64 {
    let mut gaps = 0..grid.len().saturating_sub(1);
    match gaps.all(|gap| grid.within[gap] || grid.jumps[gap]) {
        true => ON_SAMPLES,
        false => 1.0 - KNOWN_TO,
    }
}

/// Bytes of all channels; equal times are kept once.
fn bytes_of(choices: &[Choice]) -> usize {
    let mut known = BTreeSet::new();
    choices
        .iter()
        .map(|choice| choice.channel.bytes(&mut known))
        .sum()
}

/// The same without those that never leave their rest, which need no keys where that is so in all clips.
pub(super) fn moving_bytes(choices: &[Choice]) -> usize {
    let mut known = BTreeSet::new();
    let moving = choices.iter().filter(|choice| !choice.at_rest);
    moving.map(|choice| choice.channel.bytes(&mut known)).sum()
}

impl Reduced {
    /// What every part of the clip is to have, channel by channel.
    pub(super) fn kinds(&self) -> Vec<Kinds> {
        let of = |channel: &crate::model::Channel| match channel.interpolation {
            Interpolation::Cubic => Kinds::OnlyCubic,
            _ => Kinds::OnlyLinear,
        };
        self.clip.channels.iter().map(of).collect()
    }
}

/// The kind of keys that a try found smallest, for the tries after it.
fn kind(choice: &Choice) -> Kinds {
    match choice.channel.interpolation {
        Interpolation::Cubic => Kinds::Cubic,
        Interpolation::Linear if choice.channel.times.len() > 2 => Kinds::Linear,
        _ => Kinds::Any,
    }
}

/// What an error of each node comes to, over poses of a clip.
pub(super) fn leverage(samples: &Samples, model: &Model, shells: &Shells) -> Vec<Leverage> {
    let rest: Pose = model.nodes.iter().map(|node| node.rest).collect();
    let count = samples.grid.len();
    let picked = (0..count).step_by(count.div_ceil(LEVER_POSES).max(1));
    let poses: Vec<Pose> = picked
        .map(|i| {
            let mut pose = rest.clone();
            for track in &samples.tracks {
                pose[track.node] = track.poses[i];
            }
            pose
        })
        .chain([rest.clone()])
        .collect();
    shells.leverage(poses.iter())
}
