//! The largest error at any time, not at some: branch and bound.
//!
//! # What is proved
//! Between two neighbouring times out of all keys, those of the file and those of the result, where each is on the file's
//! clock, both motions are smooth (analytic: polynomials, sines of polynomials, square roots of what stays above 0 and
//! products of these down the chain). Let `D` be by how much a point is off over such a span, taken to be one long,
//! and let no Taylor coefficient of order `n` of it be longer than `c` there ([`Majorant`]). Then:
//!
//! 1. The polynomial `q` of degree `n - 1` through `D` at `n` places of the span is within `r` of it: `|D - q| <= c |(t - t1) ...
//!    (t - tn)|`, whose most is known ([`places`](super::places)). Where nothing jumps at the ends of spans these are two of
//!    the places (Lobatto's), so that a span has a look in common with the next; else all lie within.
//! 2. No value of `q` is longer than the longest at these `n` times by more than their Lebesgue constant `L(n)`. So
//!    `|D| <= L(n) e + r`, where `e` is the largest error at the `n` times.
//! 3. A polynomial is nowhere longer than the longest of the Bézier points of its pieces, which are mixtures of what it is at the
//!    places: matrices that are known already. So `|D| <= h + r`, where `h` is the longest of these.
//! 4. At `N > n - 1` zeros of Chebyshev's polynomial a polynomial of degree
//!    `n - 1` is at most `1 / cos(pi (n - 1) / 2 N)` times as long as the longest at these (Ehlich and Zeller, "Schwankung von
//!    Polynomen zwischen Gitterpunkten", 1964). So `|D| <= C p + r`, where `p` is the longest of `q` at `N` times, with `C` = 1.0353 for
//!    `N = 6 (n - 1)`. Where what is off is no mixture (morph targets) that is at most the largest error there and `r`.
//!
//! All hold for vectors, since they hold along each direction, and so for the farthest of many points. With `n = 1` `r`
//! is how far anything goes from where it is in the middle, which is known across kinks and keys too, near poles of angles and
//! where a power of nothing begins: spans that have one are halved until it lies in a short one.
//!
//! Times of glTF are in f32, so that a key of the result stands some nanoseconds beside the file's. Both are taken to be at the first of them:
//! over the nanoseconds one motion is then off its continuation by no more than its two pieces, before and after, go there, which is
//! added ([`Span::skew`]), once more for looks that stand there, or where that is too much they are a span of their own. So they are where
//! more than one key of each lies there, where spans beside them are not far longer, and where keys jump ([`times`](super::times)).
//!
//! A span is done with where its bound is no more than [`SLACK`](super::found) above the largest error that was found anywhere: the largest of all bounds is
//! what is stated, so that no error is above it, and some error is below it by no more than that. What is not done with by the second
//! is by the third, or put aside and looked at more finely when the largest error of all is about known, the largest bound first. What jumps (steps of
//! curves) is no part of any span; both sides of it are looked at.
//!
//! Work is counted, not timed ([`Subject::work`]): where it comes to the given limit, the bounds stand as they are. They are true then too, but
//! how far above the errors they are is not known; [`Found::loose`] says for how long.
//!
//! # What it costs
//! Expected before it was built: spans of a frame turn by some tenths of a radian down a chain, where `r` is below a
//! hundredth of a bound of 0.1 mm for `n = 4` (0.3^4 / 24 / 64 = 5e-6 m a metre), so three looks for most spans, and two to
//! eight mixtures of these for those whose error is above half of the largest.

use super::found::{End, Found, Open, Span, Subject};
use super::places::{Places, dense, within};
use crate::curves::Majorant;
use std::collections::VecDeque;

/// A first look has as many times as bring the rest below this share of the largest error, the same two.
const ROUGH: [f64; 2] = [0.15, 0.3];

/// Fewer times do first where the rest is below this share of what lies between the largest error and [`ALIKE`] times the
/// largest of the span before.
const FEW: f64 = 0.8;

/// By how much more a span may be off than the one before it is taken to be.
const ALIKE: f64 = 1.25;

/// The same for a second look.
const FINE: f64 = 0.01;

/// Before that the rest may be so much of what a first look left between what it saw and what is enough.
const NEARER: f64 = 0.7;

/// By how much keys beside each other may be off is no more than this share.
const SKEWED: f64 = 0.004;

/// How much longer a polynomial may be than at dense places: 1 / cos(pi / 12).
const RIPPLE: f64 = 1.035_277;

/// Lebesgue constants of places are below this.
const SKEWED_LOOKS: f64 = 2.2;

impl Found {
    /// The largest of a span's places, the middle first: what the majorant is of is there.
    fn largest(
        &mut self,
        subject: &mut impl Subject,
        span: &Span,
        places: &Places,
        floor: f64,
    ) -> f64 {
        let (count, mut most) = (places.count(), floor.max(0.0));
        let last = count - 1;
        let middle = (count % 2 == 1).then_some(last / 2);
        let others = (0..count).filter(|index| Some(*index) != middle);
        for index in middle.into_iter().chain(others) {
            let time = places.time(index, span.from, span.to);
            if index == 0 && places.ends {
                let end = self.end.take();
                // What was less than its floor may have been less than this one.
                let known = |end: &End| end.error > end.floor || end.floor <= most;
                if let Some(end) = end.filter(|end| end.time == time && known(end)) {
                    most = most.max(end.error);
                    subject.keep_again();
                    continue;
                }
            }
            let floor = most;
            let error = self.look(subject, time, span.within, floor);
            self.before = self.before.max(subject.about());
            most = most.max(error);
            subject.keep(index);
            if index == last && places.ends {
                self.end = Some(End { time, error, floor });
                subject.keep_end(index);
            }
        }
        most
    }

    /// The bound after looks at some places, by the second and the third of the module's, or where it is a last one the fourth.
    fn bound(
        &mut self,
        subject: &mut impl Subject,
        span: &Span,
        places: &Places,
        rest: f64,
        is_last: bool,
    ) -> f64 {
        let enough = self.enough(span.within);
        let most = self.largest(subject, span, places, (enough - rest) / places.lebesgue);
        let bound = places.lebesgue * most + rest;
        if places.hull.is_empty() || bound <= self.enough(span.within) {
            return bound;
        }
        let (rows, longer) = match is_last {
            true => (places.dense(), RIPPLE),
            false => (&places.hull[..], 1.0),
        };
        let floor = ((self.enough(span.within) - rest) / longer).max(0.0);
        match subject.mixed(rows, floor) {
            Some(mixed) => bound.min(longer * mixed.max(floor).max(most) + rest),
            None => bound,
        }
    }

    /// Bounds a span, or puts it aside.
    fn settle(&mut self, span: Span, rate: Majorant, bound: f64, rest: f64) {
        let bound = if bound.is_nan() { f64::INFINITY } else { bound };
        let done = bound <= self.enough(span.within);
        let kind = &mut self.kinds[usize::from(span.within)];
        match done {
            true => kind.bound = kind.bound.max(bound),
            false => kind.open.push(Open {
                bound,
                seen: bound - rest,
                span,
                rate,
            }),
        }
    }

    /// A first look at a span, after the one before it.
    /// No more than `most` work is done.
    pub(crate) fn first(&mut self, subject: &mut impl Subject, mut span: Span, most: usize) {
        let mut rate = subject.rate(span.from, span.to);
        let length = span.to - span.from;
        let before = self.changed.replace((rate, length));
        if span.skew > 0.0 {
            let by = span.skew / length;
            // The majorant may be of what begins at the second of both keys.
            let longer = rate.longer(by);
            let skewed = before.map_or(f64::INFINITY, |(rate, length)| {
                rate.beyond(span.skew / length)
            }) + longer.0[1] * by;
            // Looks there are off by that too.
            let counts = 1.0 + SKEWED_LOOKS;
            if skewed <= SKEWED * self.enough(span.within).max(self.expected) {
                let kind = &mut self.kinds[usize::from(span.within)];
                kind.skewed = kind.skewed.max(counts * skewed);
                self.changed = Some((longer, length));
                rate = longer;
            } else {
                let key = span.from + span.skew;
                let aside = Span {
                    to: key,
                    skew: 0.0,
                    ..span
                };
                self.split(subject, aside, None, most);
                (span.from, span.skew) = (key, 0.0);
                self.split(subject, span, None, most);
                return;
            }
        }
        self.split(subject, span, Some(rate), most);
    }

    fn split(
        &mut self,
        subject: &mut impl Subject,
        span: Span,
        rate: Option<Majorant>,
        most: usize,
    ) {
        let mut queue = VecDeque::from([(span, rate)]);
        while let Some((span, known)) = queue.pop_front() {
            let rate = known.unwrap_or_else(|| subject.rate(span.from, span.to));
            let kind = usize::from(span.within);
            let before = std::mem::take(&mut self.before);
            let rough = ROUGH[kind] * self.enough(span.within).max(self.expected);
            // Where less was seen in the span before, few places may show that this one is below what was seen elsewhere.
            let few = FEW * (self.seen()[kind] - ALIKE * before);
            let all = Places::all(span.ends);
            let of = |near: f64| all.iter().find(|places| places.rest(&rate) <= near);
            let tried = of(rough.max(few)).map(|places| {
                let rest = places.rest(&rate);
                (self.bound(subject, &span, places, rest, false), rest)
            });
            if let Some((bound, rest)) = tried
                && (rest <= rough || bound <= self.enough(span.within))
            {
                self.settle(span, rate, bound, rest);
                continue;
            }
            let places = match of(rough) {
                Some(places) => places,
                // Where no derivative is known, and where there is no work left, it is the way from the middle that counts.
                None if !rate.0[1].is_finite()
                    || !span.can_be_halved()
                    || subject.work() >= most =>
                {
                    &all[0]
                }
                None => {
                    self.before = self.before.max(before);
                    let known = of_half(&rate, all, rough);
                    queue.extend(span.halves().map(|half| (half, known)));
                    continue;
                }
            };
            let rest = places.rest(&rate);
            let bound = self.bound(subject, &span, places, rest, false);
            self.settle(span, rate, bound, rest);
        }
    }

    /// Looks again at all that is not done with, until `most` work is done.
    pub(crate) fn finish(&mut self, subject: &mut impl Subject, most: usize) {
        for within in [false, true] {
            let kind = usize::from(within);
            while let Some(open) = self.kinds[kind].open.pop() {
                let is_last = open.bound <= self.enough(within);
                if is_last || subject.work() >= most {
                    // All others are below it.
                    self.prove(within, open.bound);
                    if !is_last {
                        let others = self.kinds[kind].open.drain();
                        self.loose += others
                            .chain([open])
                            .map(|open| open.span.to - open.span.from)
                            .sum::<f64>();
                    }
                    break;
                }
                self.second(subject, &open, most);
            }
            self.kinds[kind].open.clear();
        }
    }

    /// The largest error at dense places, where what is off is no mixture of what was kept.
    fn dense(&mut self, subject: &mut impl Subject, span: &Span, degree: usize, floor: f64) -> f64 {
        let mut far = floor;
        for x in dense(degree) {
            let time = within(x, span.from, span.to);
            far = far.max(self.look(subject, time, span.within, far));
        }
        far
    }

    fn second(&mut self, subject: &mut impl Subject, open: &Open, most: usize) {
        let Open { span, rate, .. } = open;
        let mut best = open.bound;
        let fine = FINE * self.seen()[usize::from(span.within)] + self.nothing / 4.0;
        // Where what was seen is well below what is enough, less will do first.
        let near = NEARER * (self.enough(span.within) - open.seen);
        let all = Places::all(span.ends);
        let of = |near: f64| all.iter().find(|places| places.rest(rate) <= near);
        let (first, last) = (of(near).filter(|_| near > fine), of(fine));
        if let Some(places) = first
            && last.is_none_or(|last| last.count() > places.count())
        {
            best = best.min(self.bound(subject, span, places, places.rest(rate), false));
            if best <= self.enough(span.within) {
                self.prove(span.within, best);
                return;
            }
        }
        let Some(places) = last else {
            match span.can_be_halved() {
                true => {
                    let known = of_half(rate, all, fine);
                    let halves = span.halves().into_iter();
                    halves.for_each(|half| self.split(subject, half, known, most));
                }
                false => self.prove(span.within, best),
            }
            return;
        };
        let rest = places.rest(rate);
        best = best.min(self.bound(subject, span, places, rest, true));
        let degree = places.count() - 1;
        let is_mixture = subject.mixed(&[], 0.0).is_some();
        if degree > 0 && !is_mixture && best > self.enough(span.within) {
            let floor = ((self.enough(span.within) - rest) / RIPPLE - rest).max(0.0);
            let far = self.dense(subject, span, degree, floor);
            best = best.min(RIPPLE * (far + rest) + rest);
        }
        self.prove(span.within, best);
    }
}

/// What the majorant of a span says of each of its halves, where that is enough for places of these, or of their halves, to leave
/// no more than `near`: it is known, while another costs as much as some looks.
fn of_half(rate: &Majorant, all: &[Places], near: f64) -> Option<Majorant> {
    let half = rate.halved();
    let is_enough = |rate: &Majorant| all.iter().any(|places| places.rest(rate) <= near);
    (is_enough(&half) || is_enough(&half.halved())).then_some(half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::found::SLACK;

    /// A point that goes around on an ellipse, in units of time that are seconds.
    struct Swing {
        speed: f64,
        kink: f64,
        looks: usize,
    }

    impl Swing {
        fn at(&self, time: f64) -> f64 {
            let p = glam::DVec2::from_angle(self.speed * time);
            (p * glam::DVec2::new(3.0, 2.0)).length() + (time - self.kink).abs()
        }
    }

    impl Subject for Swing {
        fn look(&mut self, time: f64, floor: f64) -> f64 {
            self.looks += 1;
            self.at(time).max(floor)
        }

        fn rate(&mut self, from: f64, to: f64) -> Majorant {
            // The length itself is that of a vector with a third axis of its own.
            let angle = Majorant::moving(0.0, self.speed * (to - from));
            let line = Majorant::moving(10.0, to - from);
            let out = angle.rotation().scaled(3.0).plus(&line);
            match from < self.kink && to > self.kink {
                true => out.bent(),
                false => out,
            }
        }

        fn work(&self) -> usize {
            self.looks
        }
    }

    fn largest(speed: f64, kink: f64, most: usize, ends: bool) -> (f64, f64, Found) {
        let mut swing = Swing {
            speed,
            kink,
            looks: 0,
        };
        let mut found = Found::new(1.0, 1e-9, 3.0);
        for i in 0..4 {
            let span = Span {
                from: f64::from(i) * 0.5,
                to: f64::from(i + 1) * 0.5,
                skew: 0.0,
                within: false,
                ends,
                depth: 0,
            };
            found.first(&mut swing, span, most);
        }
        found.finish(&mut swing, most);
        let truth = (0..=200_000)
            .map(|i| swing.at(f64::from(i) * 1e-5))
            .fold(0.0, f64::max);
        (truth, found.bounds()[0], found)
    }

    #[test]
    fn what_is_stated_is_never_below_and_little_above() {
        let all = [(0.1, 9.0), (3.0, 9.0), (40.0, 9.0), (3.0, 0.7), (0.0, 1.3)];
        for ((speed, kink), ends) in all
            .into_iter()
            .zip([true, false].into_iter().cycle())
            .chain(all.into_iter().zip([false, true].into_iter().cycle()))
        {
            let (truth, stated, found) = largest(speed, kink, 10_000, ends);
            assert!(stated >= truth, "{speed} {kink}: {stated} of {truth}");
            assert!(
                stated <= (SLACK[0] + 1e-6) * truth,
                "{speed} {kink}: {stated} of {truth}"
            );
            assert_eq!(found.loose, 0.0);
        }
    }

    #[test]
    fn what_is_stated_without_work_is_true_and_said_to_be_loose() {
        for (most, ends) in [(0, true), (5, false), (40, true), (60, false)] {
            let (truth, stated, found) = largest(40.0, 0.7, most, ends);
            assert!(stated >= truth, "{most}: {stated} of {truth}");
            assert!(
                stated > 1.06 * truth && found.loose > 0.0,
                "{most}: {found:?}"
            );
        }
        let (_, _, found) = largest(3.0, 9.0, 10_000, true);
        assert!(!found.peaks.is_empty());
    }
}
