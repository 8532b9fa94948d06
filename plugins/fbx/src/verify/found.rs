//! What a search for the largest error at any time is of, and what it found so far; the search itself is [`bound`](super::bound).

use crate::curves::Majorant;
use std::collections::BinaryHeap;

/// What is stated may be above what was found by this factor: at keys and between them, and where it lies within frames, which
/// nothing is held to.
pub(super) const SLACK: [f64; 2] = [1.06, 1.5];

/// Halvings of a span at most.
const DEPTH: u32 = 30;

/// Peaks that are kept.
const PEAKS: usize = 512;

/// What is held: a largest error at each time, and how fast it may change.
pub(crate) trait Subject {
    /// The largest error at a time; what is less than `floor` may be said to be `floor`.
    fn look(&mut self, time: f64, floor: f64) -> f64;
    /// What the last look saw, about, also where that is less than its floor.
    fn about(&self) -> f64 {
        f64::INFINITY
    }
    /// Keeps what the last look saw, as number `index` of a span's.
    fn keep(&mut self, _index: usize) {}
    /// What was kept as number `index` is that of the next span's begin too.
    fn keep_end(&mut self, _index: usize) {}
    /// What the last span's end kept becomes number 0.
    fn keep_again(&mut self) {}
    /// The largest error of the polynomials through what was kept, for each row of weights; `None` where errors are no
    /// polynomials of that.
    fn mixed(&mut self, _rows: &[Vec<f64>], _floor: f64) -> Option<f64> {
        None
    }
    /// The majorant of all errors over a span between keys.
    fn rate(&mut self, from: f64, to: f64) -> Majorant;
    /// What all that was asked so far cost, in poses of nodes.
    fn work(&self) -> usize;
}

/// A time between neighbouring keys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// So much of it at its begin is before a key that is taken to be there, seconds.
    pub(crate) skew: f64,
    /// It lies within frames.
    pub(crate) within: bool,
    /// Nothing jumps at its ends.
    pub(crate) ends: bool,
    pub(crate) depth: u32,
}

impl Span {
    pub(super) fn halves(&self) -> [Self; 2] {
        let middle = f64::midpoint(self.from, self.to);
        let depth = self.depth + 1;
        [
            Self {
                to: middle,
                depth,
                ..*self
            },
            Self {
                from: middle,
                depth,
                ..*self
            },
        ]
    }

    pub(super) fn can_be_halved(&self) -> bool {
        let middle = f64::midpoint(self.from, self.to);
        let length = self.to - self.from;
        self.depth < DEPTH && length > 1e-13 * (1.0 + middle.abs()) * 64.0
    }
}

/// A span that is to be looked at again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Open {
    pub(super) bound: f64,
    /// Of it, what lies between places; the rest is what the majorant leaves.
    pub(super) seen: f64,
    pub(super) span: Span,
    pub(super) rate: Majorant,
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.bound
            .total_cmp(&other.bound)
            .then_with(|| other.span.from.total_cmp(&self.span.from))
    }
}

/// What a search found of times that count as keyed, or of those within frames.
#[derive(Debug, Clone, Default)]
pub(super) struct Kind {
    /// The largest error at a time that was looked at.
    pub(super) found: f64,
    /// No error of spans that are done with is above this.
    pub(super) bound: f64,
    /// What keys beside each other may add to it.
    pub(super) skewed: f64,
    pub(super) open: BinaryHeap<Open>,
}

/// What was found, and what that proves.
#[derive(Debug, Clone, Default)]
pub(crate) struct Found {
    pub(super) kinds: [Kind; 2],
    /// An error that is expected, which steers how finely spans are looked at, and one that does not matter.
    pub(super) expected: f64,
    pub(super) nothing: f64,
    /// Times that were looked at.
    pub(crate) looks: usize,
    /// What the look at the end of the last span found.
    pub(super) end: Option<End>,
    /// The largest error in the span before, about.
    pub(super) before: f64,
    /// How what is off may change in the span before, and how long that is, seconds; `None` where there is none.
    pub(super) changed: Option<(Majorant, f64)>,
    /// Seconds of spans whose bounds stand because work came to its limit.
    pub(crate) loose: f64,
    /// Times whose errors are above this are kept.
    pub(super) high: f64,
    pub(crate) peaks: Vec<f64>,
}

/// A look at the end of a span.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) time: f64,
    /// The error, or `floor` where it is less.
    pub(super) error: f64,
    pub(super) floor: f64,
}

impl Found {
    /// `nothing` is an error that does not matter; times of errors above `high` are kept as peaks.
    pub(crate) fn new(expected: f64, nothing: f64, high: f64) -> Self {
        Self {
            expected,
            nothing,
            high,
            ..Self::default()
        }
    }

    /// A search of its own that knows what was found so far.
    pub(crate) fn apart(&self) -> Self {
        let mut out = Self::new(self.expected, self.nothing, self.high);
        for (kind, known) in out.kinds.iter_mut().zip(&self.kinds) {
            kind.found = known.found;
        }
        out
    }

    /// The largest error that was seen at keys and between them, and that with what lies within frames.
    pub(crate) fn seen(&self) -> [f64; 2] {
        let [keyed, within] = &self.kinds;
        [keyed.found, keyed.found.max(within.found)]
    }

    /// The largest error that was seen at keys and between them, or of those within frames.
    pub(super) fn seen_of(&self, within: bool) -> f64 {
        self.kinds[usize::from(within)].found
    }

    /// No error is above these: the same two.
    pub(crate) fn bounds(&self) -> [f64; 2] {
        let [keyed, within] = [0, 1].map(|i| {
            let kind = &self.kinds[i];
            kind.bound.max(kind.found) + kind.skewed
        });
        [keyed, keyed.max(within)]
    }

    /// What a span's bound may be.
    pub(super) fn enough(&self, within: bool) -> f64 {
        let seen = self.seen()[usize::from(within)];
        let stated = match within {
            true => self.kinds[1].bound.max(self.kinds[0].bound),
            false => self.kinds[0].bound,
        };
        (seen * SLACK[usize::from(within)])
            .max(seen + self.nothing)
            .max(stated)
    }

    /// One time by itself.
    pub(crate) fn look(
        &mut self,
        subject: &mut impl Subject,
        time: f64,
        within: bool,
        floor: f64,
    ) -> f64 {
        self.looks += 1;
        let error = subject.look(time, floor);
        let kind = &mut self.kinds[usize::from(within)];
        if error > floor {
            kind.found = kind.found.max(error);
            if !within && error > self.high && self.peaks.len() < PEAKS {
                self.peaks.push(time);
            }
        }
        match error.is_nan() {
            true => f64::INFINITY,
            false => error,
        }
    }

    /// Both sides of a jump, or a key.
    pub(crate) fn key(&mut self, subject: &mut impl Subject, time: f64) {
        let floor = self.seen_of(false);
        self.look(subject, time, false, floor);
    }

    pub(super) fn prove(&mut self, within: bool, bound: f64) {
        let kind = &mut self.kinds[usize::from(within)];
        kind.bound = kind.bound.max(bound);
    }

    /// With what was found in another part of the clip.
    pub(crate) fn join(&mut self, part: Self) {
        self.looks += part.looks;
        self.loose += part.loose;
        self.peaks.extend(part.peaks);
        self.peaks.truncate(PEAKS);
        for (kind, part) in self.kinds.iter_mut().zip(part.kinds) {
            kind.found = kind.found.max(part.found);
            kind.bound = kind.bound.max(part.bound);
            kind.skewed = kind.skewed.max(part.skewed);
            kind.open.extend(part.open);
        }
    }
}
