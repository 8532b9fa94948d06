//! When a clip is looked at, and what that comes to.

use super::actors::Actors;
use super::found::{Found, Span, Subject};
use crate::clips::{Shells, Source, Stretch, in_parts, threads};
use crate::curves::Reading;
use crate::model::{Channel, Clip, Interpolation};

/// An error that does not matter beside the bound, as a share of it: by so much what is stated may be above what was seen,
/// however small that is. Two hundredths of a micrometre of a tenth of a millimetre, so that what is stated of clips that are far
/// nearer than they have to be is near to their errors too.
const NOTHING: f64 = 2e-4;

/// What a check found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Checked {
    /// No distance is larger than this, metres, at any time.
    pub(crate) error: f64,
    /// The same without what lies within frames.
    pub(crate) keyed_error: f64,
    /// Times that were looked at.
    pub(crate) times: usize,
    /// The share of the clip's time whose bound is loose: work came to its limit.
    pub(crate) loose: f64,
    /// Times at which more was seen than is asked for, on the file's clock, growing.
    pub(crate) peaks: Vec<f64>,
}

/// Work that a check may do, in poses of nodes: so much for all clips of a file together, and so many times each node that
/// moves for each span between keys.
const WORK: (usize, usize) = (1_000_000, 40);

/// The least of the second, where checks before it did much.
const LEAST: usize = 4;

/// Spans that are looked at by themselves, whoever looks at the others.
const TOGETHER: usize = 64;

/// Times of a clip that are looked at before all else.
const BEFORE: usize = 24;

/// Holds `clip` against the curves of the file; `expected` is how far it may be off, `bound` what it is held to, metres.
pub(crate) fn check(
    source: &Source,
    shells: &Shells,
    clip: &Clip,
    (expected, bound): (f64, f64),
) -> Checked {
    let take = source.take;
    let moving = shells.moved_by(take.moving.iter().copied());
    let keys = key_times(clip);
    let steps = |c: &Channel| c.interpolation == Interpolation::Step && c.times.len() > 1;
    let ends = !clip.channels.iter().any(steps);
    let spans = spans(take.plan.gaps(), &keys, clip.begin, ends);
    let end = take.plan.end.max(take.plan.begin);
    let poses = spans.len() * take.moving.len().max(1);
    let left = usize::try_from(source.budget.left_for_checks()).unwrap_or(usize::MAX);
    let each = WORK.1.min(left / poses.max(1)).max(LEAST) * take.moving.len().max(1);
    let actors = || Actors::of(source, shells, clip, &moving, Reading::Usual);
    let mut found = Found::new(expected, NOTHING * bound, bound);
    let mut own = actors();
    for (span, _) in spans.iter().step_by(spans.len() / BEFORE + 1) {
        found.look(
            &mut own,
            f64::midpoint(span.from, span.to),
            span.within,
            0.0,
        );
    }
    let known = found.apart();
    let groups = spans.len().div_ceil(TOGETHER);
    let parts = in_parts(groups, threads(4 * poses, source.options), |range| {
        let mut actors = actors();
        let of_group = |group: usize| {
            // What a group finds is not to depend on who was looked at before it.
            actors.forget();
            let mut found = known.apart();
            let spans = spans[group * TOGETHER..].iter().take(TOGETHER);
            let most = actors.work() + each * spans.len();
            for (span, key) in spans {
                if *key {
                    found.key(&mut actors, span.from + span.skew);
                }
                found.first(&mut actors, *span, most);
            }
            found
        };
        let found: Vec<Found> = range.map(of_group).collect();
        (found, actors.work())
    });
    let mut work = 0;
    for (parts, own) in parts {
        work += own;
        parts.into_iter().for_each(|part| found.join(part));
    }
    found.key(&mut own, end);
    let more = WORK.0 / source.take.scene.anim_stacks.len().max(1) + each * spans.len() / 4;
    let most = own.work() + more.min(left.saturating_sub(work));
    found.finish(&mut own, most);
    source.budget.pay_for_checks(work + own.work());
    let [keyed_error, error] = found.bounds();
    let length = end - take.plan.begin;
    let mut peaks = std::mem::take(&mut found.peaks);
    peaks.sort_by(f64::total_cmp);
    Checked {
        error,
        keyed_error,
        times: found.looks,
        loose: match length > 0.0 {
            true => (found.loose / length).min(1.0),
            false => 0.0,
        },
        peaks,
    }
}

/// The keys' times of all channels, growing, each once.
fn key_times(clip: &Clip) -> Vec<f32> {
    let mut keys: Vec<f32> = Vec::new();
    let mut last: &[f32] = &[];
    for channel in &clip.channels {
        // Many channels share their times.
        if channel.times != last {
            keys.extend(&channel.times);
            last = &channel.times;
        }
    }
    keys.sort_by(f32::total_cmp);
    keys.dedup();
    keys
}

/// Times between keys, of the file's or of the result's, and whether each begins with a key of the file's that counts while
/// what lies on one side of it does not; `ends` says that the result has no steps.
fn spans(
    stretches: impl Iterator<Item = Stretch>,
    keys: &[f32],
    begin: f64,
    ends: bool,
) -> Vec<(Span, bool)> {
    // Times that f32 hardly tells apart are the two sides of a jump.
    let side = |time: f64| ((time - begin).abs() * 2.5e-7).max(1.5e-7);
    let mut out: Vec<(Span, bool)> = Vec::new();
    let (mut skew, mut was_within) = (0.0, false);
    let mut next = 0;
    for stretch in stretches {
        let mut key = !stretch.jumps && (stretch.within || was_within);
        was_within = stretch.within;
        let mut from = stretch.begin;
        if stretch.jumps {
            (from, skew) = (from + side(from), 0.0);
        }
        let high = match stretch.jumps_after {
            true => stretch.end - side(stretch.end),
            false => stretch.end,
        };
        loop {
            let label = keys.get(next).map(|&key| begin + f64::from(key));
            let inner = label.filter(|&label| label < stretch.end);
            next += usize::from(inner.is_some());
            let end = inner.unwrap_or(stretch.end).min(high);
            if end > from {
                // A key of the result stands where f32 has the file's.
                if end - from <= 7e-8 * (end - begin) + 1e-12 {
                    skew += end - from;
                } else {
                    let span = Span {
                        from: from - skew,
                        to: end,
                        skew,
                        within: stretch.within,
                        ends,
                        depth: 0,
                    };
                    out.push((span, key));
                    (skew, key) = (0.0, false);
                }
                from = end;
            }
            if inner.is_none() {
                break;
            }
        }
    }
    out
}

/// Times at which readings of the same layers are held against each other.
const READINGS: usize = 65;

/// For each layer that can be read in two ways: its name, which they are, and how far what they show is
/// apart at most, metres at the shells.
pub(crate) fn doubts(source: &Source, shells: &Shells, clip: &Clip) -> Vec<(String, Reading, f64)> {
    let take = source.take;
    let layers = take.layers(Reading::Usual);
    let mut out = Vec::new();
    for (reading, layer) in layers.doubts() {
        let moving = shells.moved_by(take.moving.iter().copied());
        let mut usual = Actors::of(source, shells, clip, &moving, Reading::Usual);
        let mut other = Actors::of(source, shells, clip, &moving, reading);
        let length = take.plan.end - take.plan.begin;
        let apart = (0..READINGS)
            .map(|i| take.plan.begin + length * i as f64 / (READINGS - 1) as f64)
            .map(|time| usual.otherwise(&mut other, time))
            .fold(0.0, f64::max);
        out.push((layer.element.name.to_string(), reading, apart));
    }
    out
}
