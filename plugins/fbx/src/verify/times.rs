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
const TOGETHER: usize = 32;

/// What a span costs, in poses of samples that are chosen from: some seven looks of two poses each.
const LOOKS: usize = 16;

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
    let steps = step_times(clip);
    let spans = spans(
        take.plan.gaps(),
        &keys,
        &steps,
        clip.begin,
        steps.is_empty(),
    );
    let end = take.plan.end.max(take.plan.begin);
    let poses = spans.len() * take.moving.len().max(1);
    let left = usize::try_from(source.budget.left_for_checks()).unwrap_or(usize::MAX);
    let each = WORK.1.min(left / poses.max(1)).max(LEAST) * take.moving.len().max(1);
    let actors = || Actors::of(source, shells, clip, &moving, Reading::Usual);
    let mut found = Found::new(expected, NOTHING * bound, bound);
    let mut own = actors();
    for (span, _) in spans.iter().step_by(spans.len() / BEFORE + 1) {
        // What is more than is asked for is seen however much that is.
        let floor = found.seen_of(span.within).min(bound);
        let middle = f64::midpoint(span.from, span.to);
        found.look(&mut own, middle, span.within, floor);
    }
    let known = found.apart();
    let groups = spans.len().div_ceil(TOGETHER);
    let parts = in_parts(groups, threads(LOOKS * poses, source.options), |range| {
        let mut actors = actors();
        let of_group = |group: usize| {
            // What a group finds is not to depend on who was looked at before it.
            actors.forget();
            let mut found = known.apart();
            let spans = spans[group * TOGETHER..].iter().take(TOGETHER);
            let most = actors.work() + each * spans.len();
            for (span, key) in spans {
                if let Some(key) = key {
                    found.key(&mut actors, *key);
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

/// The keys' times of all channels that jump at them.
fn step_times(clip: &Clip) -> Vec<f32> {
    let steps = clip.channels.iter().filter(|c| is_step(c));
    let mut keys: Vec<f32> = steps.flat_map(|c| c.times.iter().copied()).collect();
    keys.sort_by(f32::total_cmp);
    keys.dedup();
    keys
}

fn is_step(channel: &Channel) -> bool {
    channel.interpolation == Interpolation::Step && channel.times.len() > 1
}

/// How many times as long the spans beside two keys are at least that are taken to be one.
const LONGER: f64 = 64.0;

/// What stands at a time: a key of the file's, or one of the result's.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Stands {
    file: bool,
    result: bool,
}

impl Stands {
    /// Nothing, or more than one key.
    fn is_alone(self) -> bool {
        self.file != self.result
    }
}

/// A time between two times at which anything stands.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    from: f64,
    to: f64,
    within: bool,
    /// A key of the file's that counts while what lies on one side of it does not.
    key: Option<f64>,
    /// f32 hardly tells its ends apart.
    short: bool,
    /// One of its ends is a key of the file's alone, the other one of the result's.
    aside: bool,
}

/// Times between keys, of the file's or of the result's, and for each the key of the file's at its begin that counts while
/// what lies on one side of it does not; `ends` says that the result has no steps, which `steps` are the times of.
fn spans(
    stretches: impl Iterator<Item = Stretch>,
    keys: &[f32],
    steps: &[f32],
    begin: f64,
    ends: bool,
) -> Vec<(Span, Option<f64>)> {
    let pieces = pieces(stretches, keys, steps, begin);
    let mut out: Vec<(Span, Option<f64>)> = Vec::new();
    let mut at = 0;
    while let Some(piece) = pieces.get(at) {
        let mut span = Span {
            from: piece.from,
            to: piece.to,
            skew: 0.0,
            within: piece.within,
            ends,
            depth: 0,
        };
        let mut key = piece.key;
        let skew = piece.to - piece.from;
        let is_far = |other: &Piece| !other.short && other.to - other.from >= LONGER * skew;
        let before = at.checked_sub(1).and_then(|at| pieces.get(at));
        // A key of the result stands where f32 has the file's.
        if piece.aside
            && before.is_some_and(|before| before.to == piece.from && is_far(before))
            && let Some(next) = pieces.get(at + 1)
            && next.from == piece.to
            && is_far(next)
        {
            (span.to, span.within, span.skew) = (next.to, next.within, skew);
            key = key.or(next.key);
            at += 1;
        }
        out.push((span, key));
        at += 1;
    }
    out
}

/// All times between neighbouring keys of either.
fn pieces(
    stretches: impl Iterator<Item = Stretch>,
    keys: &[f32],
    steps: &[f32],
    begin: f64,
) -> Vec<Piece> {
    // Times that f32 hardly tells apart are the two sides of a jump: a unit of f32 from it, and as far from there as the grid's sides
    // are apart, once more rounded. The way of the result from one to the other is no motion between keys.
    let side = |time: f64| {
        let label = (time - begin).abs();
        (label * 2.5e-7).max(1e-7 + label * 1.9e-7).max(1.5e-7)
    };
    let of = |key: f32| Stands {
        // A step is no key beside the file's that motion goes on over.
        file: steps.binary_search_by(|step| step.total_cmp(&key)).is_ok(),
        result: true,
    };
    let mut out: Vec<Piece> = Vec::new();
    let mut was_within = false;
    let mut next = 0;
    for stretch in stretches {
        let is_key = !stretch.jumps && (stretch.within || was_within);
        let mut key = is_key.then_some(stretch.begin);
        was_within = stretch.within;
        let mut from = stretch.begin;
        let mut stands = Stands {
            file: !stretch.jumps,
            result: false,
        };
        if stretch.jumps {
            from += side(from);
        }
        let high = match stretch.jumps_after {
            true => stretch.end - side(stretch.end),
            false => stretch.end,
        };
        loop {
            let label = |key: f32| begin + f64::from(key);
            let result = keys.get(next).copied();
            let inner = result.filter(|&key| label(key) < stretch.end);
            next += usize::from(inner.is_some());
            let end = inner.map_or(stretch.end, label).min(high);
            // A key that is cut off by a jump stands at no end.
            let here = result.filter(|&key| label(key) == end);
            let mut at_end = here.map_or_else(Stands::default, of);
            at_end.file |= inner.is_none() && !stretch.jumps_after;
            if end == from {
                stands.file |= at_end.file;
                stands.result |= at_end.result;
            } else if end > from {
                let both = (stands.file ^ at_end.file) && (stands.result ^ at_end.result);
                let short = end - from <= 7e-8 * (end - begin) + 1e-12;
                out.push(Piece {
                    from,
                    to: end,
                    within: stretch.within,
                    key: key.take(),
                    short,
                    aside: short && both && stands.is_alone(),
                });
                (from, stands) = (end, at_end);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn stretch(begin: f64, end: f64) -> Stretch {
        Stretch {
            begin,
            end,
            jumps: false,
            jumps_after: false,
            within: false,
        }
    }

    /// Where spans begin and end, and how much of each is before a key.
    fn found(stretches: &[Stretch], keys: &[f32], steps: &[f32]) -> Vec<[f64; 3]> {
        let spans = spans(
            stretches.iter().copied(),
            keys,
            steps,
            0.0,
            steps.is_empty(),
        );
        let each = spans
            .iter()
            .map(|(span, _)| [span.from, span.to, span.skew]);
        each.collect()
    }

    #[test]
    fn a_key_of_the_result_stands_beside_one_of_the_files() {
        let (key, end) = (4.1, 8.0);
        let stretches = [stretch(0.0, key), stretch(key, end)];
        let near = key as f32;
        let label = f64::from(near);
        let (first, second) = (key.min(label), key.max(label));
        let whole = [[0.0, first, 0.0], [first, end, second - first]];
        assert_eq!(found(&stretches, &[0.0, near, 8.0], &[]), whole);
        // What jumps there is not taken to be elsewhere.
        let apart = [[0.0, first, 0.0], [first, second, 0.0], [second, end, 0.0]];
        assert_eq!(found(&stretches, &[0.0, near, 8.0], &[near]), apart);
    }

    #[test]
    fn a_key_between_two_of_the_result_is_no_key_beside_one() {
        let (key, end) = (4.1, 8.0);
        let stretches = [stretch(0.0, key), stretch(key, end)];
        let near = key as f32;
        let (low, high) = match f64::from(near) < key {
            true => (near, near.next_up()),
            false => (near.next_down(), near),
        };
        let [below, above] = [low, high].map(f64::from);
        let apart = [
            [0.0, below, 0.0],
            [below, key, 0.0],
            [key, above, 0.0],
            [above, end, 0.0],
        ];
        assert_eq!(found(&stretches, &[0.0, low, high, 8.0], &[]), apart);
        // Nor is one whose neighbour is hardly longer.
        let close = above + 4.0 * (above - key);
        let stretches = [stretch(0.0, key), stretch(key, close)];
        let apart = [[0.0, key, 0.0], [key, above, 0.0], [above, close, 0.0]];
        assert_eq!(found(&stretches, &[0.0, high], &[]), apart);
    }
}
