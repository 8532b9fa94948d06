//! One curve.

use super::tangents::{mended, reach};
use ufbx::{AnimCurve, Extrapolation, ExtrapolationMode, Interpolation, Keyframe};

/// Times beyond a curve's keys that are told apart: more are as good as none.
const MOST_REPEATS: f64 = 1e6;

/// Ticks of the file's clock in a second, where the file's own number is none.
pub(crate) const TICKS: f64 = 46_186_158_000.0;

/// How a curve goes on beyond its keys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Beyond {
    pub(super) mode: ExtrapolationMode,
    /// Below 0 without end.
    pub(super) repeats: i32,
}

impl From<&Extrapolation> for Beyond {
    fn from(how: &Extrapolation) -> Self {
        Self {
            mode: how.mode,
            repeats: how.repeat_count,
        }
    }
}

/// A curve, and the key that the last time was after.
#[derive(Clone)]
pub(crate) struct Curve<'a> {
    pub(super) keys: &'a [Keyframe],
    pub(super) before: Beyond,
    pub(super) after: Beyond,
    /// Ticks of the file's clock in a second.
    ticks: f64,
    at: usize,
    /// What lies between the key of this number and the next one: many times do.
    piece: Option<(usize, Piece)>,
    /// The same of the last time that was asked for, whatever it is.
    last: Option<Stretch>,
}

/// What lies between two keys.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    from: f64,
    to: f64,
    how: How,
}

#[derive(Debug, Clone, Copy)]
enum How {
    Stands(f64),
    /// From a value by so much.
    Line(f64, f64),
    Bends(Piece),
}

impl Stretch {
    /// At a time between the keys.
    fn at(&self, time: f64) -> f64 {
        let share = || (time - self.from) / (self.to - self.from);
        match &self.how {
            How::Stands(value) => *value,
            How::Line(value, way) => value + way * share(),
            How::Bends(piece) => piece.at(share()),
        }
    }
}

/// A Bézier curve from one key to the next: its four values, and where in time the two between lie, as shares of the way from
/// their own ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) values: [f64; 4],
    pub(super) out: f64,
    pub(super) into: f64,
}

impl Piece {
    /// From key `at` to the next one.
    fn of(keys: &[Keyframe], at: usize, key: &Keyframe, next: &Keyframe) -> Self {
        let length = next.time - key.time;
        let (out, out_slope) = reach(key.right, length);
        let (into, into_slope) = reach(next.left, length);
        let out_slope = out_slope * mended(keys, at, key.right);
        let into_slope = into_slope * mended(keys, at + 1, next.left);
        let (a, d) = (key.value, next.value);
        Self {
            values: [a, a + out_slope * out, d - into_slope * into, d],
            out,
            into,
        }
    }

    /// Time goes evenly along it.
    pub(super) fn is_even(&self) -> bool {
        self.out == 1.0 / 3.0 && self.into == 1.0 / 3.0
    }

    fn at(&self, share: f64) -> f64 {
        let t = match self.is_even() {
            true => share,
            false => solve(self.out, 1.0 - self.into, share),
        };
        let u = 1.0 - t;
        let [a, b, c, d] = self.values;
        u * u * u * a + 3.0 * u * t * (u * b + t * c) + t * t * t * d
    }
}

impl<'a> Curve<'a> {
    /// `None` where it has no keys.
    pub(crate) fn of(curve: &'a AnimCurve) -> Option<Self> {
        let keys: &[Keyframe] = &curve.keyframes;
        let ticks = curve.element.scene.metadata.ktime_second as f64;
        let stands = stands(keys, [&curve.pre_extrapolation, &curve.post_extrapolation]);
        let keys = if stands { &keys[..1] } else { keys };
        (!keys.is_empty()).then_some(Self {
            keys,
            before: Beyond::from(&curve.pre_extrapolation),
            after: Beyond::from(&curve.post_extrapolation),
            ticks: if ticks > 0.0 { ticks } else { TICKS },
            at: 0,
            piece: None,
            last: None,
        })
    }

    /// It never leaves one value.
    pub(super) fn stands(&self) -> bool {
        self.keys.len() == 1
    }

    #[cfg(test)]
    pub(super) fn with_keys(keys: &'a [Keyframe]) -> Self {
        let stays = Beyond {
            mode: ExtrapolationMode::Constant,
            repeats: -1,
        };
        Self {
            keys,
            before: stays,
            after: stays,
            ticks: 46_186_158_000.0,
            at: 0,
            piece: None,
            last: None,
        }
    }

    /// Its value at `time`, seconds on the file's clock. Fast where times grow.
    pub(crate) fn at(&mut self, time: f64) -> f64 {
        if let Some(last) = &self.last
            && time > last.from
            && time < last.to
        {
            return last.at(time);
        }
        let (Some(first), Some(last)) = (self.keys.first(), self.keys.last()) else {
            return 0.0;
        };
        if self.keys.len() == 1 {
            return first.value;
        }
        if time < first.time || time > last.time {
            return self.beyond(time, first, last);
        }
        self.inside(time)
    }

    fn inside(&mut self, time: f64) -> f64 {
        let at = self.segment(time);
        let Some(key) = self.keys.get(at) else {
            return 0.0;
        };
        let Some(next) = self.keys.get(at + 1) else {
            return key.value;
        };
        if time <= key.time {
            return key.value;
        }
        let last = Stretch {
            from: key.time,
            to: next.time,
            how: match key.interpolation {
                Interpolation::ConstantPrev => How::Stands(key.value),
                Interpolation::ConstantNext => How::Stands(next.value),
                Interpolation::Linear => How::Line(key.value, next.value - key.value),
                Interpolation::Cubic => How::Bends(*self.piece(at, key, next)),
            },
        };
        self.last.insert(last).at(time)
    }

    /// What lies between key `at` and the next one, where it is cubic.
    pub(super) fn piece(&mut self, at: usize, key: &Keyframe, next: &Keyframe) -> &Piece {
        if self.piece.as_ref().is_none_or(|(known, _)| *known != at) {
            self.piece = None;
        }
        let keys = self.keys;
        let made = || (at, Piece::of(keys, at, key, next));
        &self.piece.get_or_insert_with(made).1
    }

    /// The last key that `time` is not before.
    pub(super) fn segment(&mut self, time: f64) -> usize {
        let is_before = |at: usize| self.keys.get(at).is_none_or(|key| key.time > time);
        if !is_before(self.at) {
            for at in self.at..self.at + 3 {
                if is_before(at + 1) {
                    self.at = at;
                    return at;
                }
            }
        }
        self.at = self
            .keys
            .partition_point(|key| key.time <= time)
            .saturating_sub(1);
        self.at
    }

    /// Before the first key or after the last.
    fn beyond(&mut self, time: f64, first: &Keyframe, last: &Keyframe) -> f64 {
        let is_before = time < first.time;
        let (key, how) = match is_before {
            true => (first, self.before),
            false => (last, self.after),
        };
        match how.mode {
            ExtrapolationMode::Constant => return key.value,
            ExtrapolationMode::Slope => {
                let tangent = if is_before { key.right } else { key.left };
                let slope = f64::from(tangent.dy) / f64::from(tangent.dx);
                let slope = if slope.is_finite() { slope } else { 0.0 };
                return key.value + slope * (time - key.time);
            }
            _ if how.repeats == 0 => return key.value,
            _ => {}
        }
        let Some((inner, number)) = self.folded(time) else {
            return key.value;
        };
        let value = self.inside(inner);
        let climb = match how.mode {
            ExtrapolationMode::RepeatRelative => (last.value - first.value) * (number + 1.0),
            _ => 0.0,
        };
        if is_before {
            value - climb
        } else {
            value + climb
        }
    }

    /// Where within the keys a time beyond them is that a repetition reaches, and in which repetition.
    pub(super) fn folded(&self, time: f64) -> Option<(f64, f64)> {
        let (first, last) = (self.keys.first()?, self.keys.last()?);
        let is_before = time < first.time;
        let how = if is_before { self.before } else { self.after };
        // On the file's clock, so that seams fall on whole ticks.
        let (begin, end) = (
            (first.time * self.ticks).round(),
            (last.time * self.ticks).round(),
        );
        let length = end - begin;
        if length < 1.0 || how.repeats == 0 {
            return None;
        }
        let now = time * self.ticks;
        let past = if is_before { begin - now } else { now - end };
        let mut number = (past / length).floor();
        let mut rest = past - number * length;
        if how.repeats > 0 && number >= f64::from(how.repeats) {
            number = f64::from(how.repeats - 1);
            rest = length;
        }
        // The first repetition of a mirrored curve runs backwards.
        let backwards = how.mode == ExtrapolationMode::Mirror && number.rem_euclid(2.0) < 0.5;
        if backwards != is_before {
            rest = length - rest;
        }
        let inner = ((begin + rest) / self.ticks).clamp(first.time, last.time);
        Some((inner, number))
    }
}

/// Whether a curve never leaves the value of its first key.
fn stands(keys: &[Keyframe], beyond: [&Extrapolation; 2]) -> bool {
    let Some(first) = keys.first() else {
        return true;
    };
    let lies = |pair: &[Keyframe]| {
        let bent = pair[0].right.dy != 0.0 || pair[1].left.dy != 0.0;
        pair[1].value == first.value && !(bent && pair[0].interpolation == Interpolation::Cubic)
    };
    // Lines beyond the keys have the slopes of tangents.
    let climbs = beyond
        .iter()
        .any(|how| how.mode == ExtrapolationMode::Slope);
    let level = |key: &Keyframe| key.left.dy == 0.0 && key.right.dy == 0.0;
    keys.windows(2).all(lies) && (!climbs || keys.iter().all(level))
}

/// Where a Bézier curve's time, through 0, `a`, `b` and 1, is `x`.
pub(super) fn solve(a: f64, b: f64, x: f64) -> f64 {
    let time = |t: f64| {
        let u = 1.0 - t;
        3.0 * u * t * (u * a + t * b) + t * t * t
    };
    let speed = |t: f64| {
        let u = 1.0 - t;
        3.0 * (u * u * a + 2.0 * u * t * (b - a) + t * t * (1.0 - b))
    };
    let (mut low, mut high, mut t) = (0.0_f64, 1.0_f64, x);
    for _ in 0..60 {
        let off = time(t) - x;
        if off.abs() < 1e-15 {
            break;
        }
        if off > 0.0 {
            high = t;
        } else {
            low = t;
        }
        let newton = t - off / speed(t);
        t = match newton > low && newton < high {
            true => newton,
            false => f64::midpoint(low, high),
        };
        if high - low < 1e-16 {
            break;
        }
    }
    t
}

/// How many repetitions of `curve` begin before `begin` or end after `end`, before its keys and after
/// them: seconds of the file's clock.
pub(crate) fn repeats(curve: &AnimCurve, begin: f64, end: f64) -> (f64, f64) {
    let length = curve.max_time - curve.min_time;
    let count = |how: &Extrapolation, past: f64| {
        let repeats = !matches!(
            how.mode,
            ExtrapolationMode::Constant | ExtrapolationMode::Slope
        );
        if !repeats || past.is_nan() || past <= 0.0 || length <= 0.0 {
            return 0.0;
        }
        let wanted = (past / length).ceil().min(MOST_REPEATS);
        match how.repeat_count {
            ..0 => wanted,
            most => wanted.min(f64::from(most)),
        }
    };
    (
        count(&curve.pre_extrapolation, curve.min_time - begin),
        count(&curve.post_extrapolation, end - curve.max_time),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use ufbx::Tangent;

    fn key(time: f64, value: f64, interpolation: Interpolation) -> Keyframe {
        Keyframe {
            time,
            value,
            interpolation,
            ..Keyframe::default()
        }
    }

    fn curve(keys: &[Keyframe], before: ExtrapolationMode, after: ExtrapolationMode) -> Curve<'_> {
        let how = |mode| Beyond { mode, repeats: -1 };
        Curve {
            keys,
            before: how(before),
            after: how(after),
            ticks: 46_186_158_000.0,
            at: 0,
            piece: None,
            last: None,
        }
    }

    #[test]
    fn steps_lines_and_their_ends() {
        use ExtrapolationMode::Constant;
        let keys = [
            key(0.0, 1.0, Interpolation::ConstantPrev),
            key(1.0, 2.0, Interpolation::ConstantNext),
            key(2.0, 5.0, Interpolation::Linear),
            key(4.0, 9.0, Interpolation::Linear),
        ];
        let mut curve = curve(&keys, Constant, Constant);
        let wanted = [
            (-1.0, 1.0),
            (0.999, 1.0),
            (1.0, 2.0),
            (1.001, 5.0),
            (2.0, 5.0),
            (3.0, 7.0),
            (4.0, 9.0),
            (9.0, 9.0),
            (0.5, 1.0),
        ];
        for (time, value) in wanted {
            assert_eq!(curve.at(time), value, "{time}");
        }
    }

    #[test]
    fn cubics_are_those_of_hermite() {
        // Slopes of 3 and -2 a second over two seconds, no weights.
        let dx = (f64::from(crate::curves::tangents::THIRD) * 2.0) as f32;
        let mut keys = [
            key(1.0, 10.0, Interpolation::Cubic),
            key(3.0, 14.0, Interpolation::Cubic),
        ];
        keys[0].right = Tangent { dx, dy: dx * 3.0 };
        keys[1].left = Tangent { dx, dy: dx * -2.0 };
        let mut curve = curve(&keys, ExtrapolationMode::Slope, ExtrapolationMode::Constant);
        for step in 0..=16 {
            let s = f64::from(step) / 16.0;
            let (s2, s3) = (s * s, s * s * s);
            let wanted = 10.0 * (2.0 * s3 - 3.0 * s2 + 1.0)
                + 6.0 * (s3 - 2.0 * s2 + s)
                + 14.0 * (3.0 * s2 - 2.0 * s3)
                - 4.0 * (s3 - s2);
            let off = curve.at(1.0 + 2.0 * s) - wanted;
            assert!(off.abs() < 1e-6, "{s}: {off:e}");
        }
        assert!((curve.at(0.0) - 7.0).abs() < 1e-6);
    }

    #[test]
    fn weighted_tangents_bend_time() {
        for (a, b) in [
            (0.9, 0.1),
            (0.01, 0.99),
            (0.0, 0.5),
            (0.99, 0.01),
            (1.0, 0.0),
        ] {
            for step in 0..=20 {
                let t = f64::from(step) / 20.0;
                let u = 1.0 - t;
                let x = 3.0 * u * u * t * a + 3.0 * u * t * t * b + t * t * t;
                let found = solve(a, b, x);
                // At a vertical tangent a place is known to a cube root only.
                let off = (found - t).abs();
                assert!(off < 1e-4, "{a} {b} at {t}: {off:e}");
            }
        }
    }

    #[test]
    fn repetitions_go_on_as_they_say() {
        use ExtrapolationMode::{Mirror, Repeat, RepeatRelative};
        let keys = [
            key(0.0, 0.0, Interpolation::Linear),
            key(2.0, 6.0, Interpolation::Linear),
        ];
        for (mode, after, before) in [
            (Repeat, [1.5, 1.5, 4.5], [4.5, 4.5]),
            (Mirror, [4.5, 1.5, 4.5], [1.5, 4.5]),
            (RepeatRelative, [7.5, 13.5, 16.5], [-1.5, -7.5]),
        ] {
            let mut curve = curve(&keys, mode, mode);
            let got = [2.5, 4.5, 5.5].map(|time| curve.at(time));
            for (got, wanted) in got.iter().zip(after) {
                assert!(
                    (got - wanted).abs() < 1e-9,
                    "{mode:?} after: {got} {wanted}"
                );
            }
            let got = [-0.5, -2.5].map(|time| curve.at(time));
            for (got, wanted) in got.iter().zip(before) {
                assert!(
                    (got - wanted).abs() < 1e-9,
                    "{mode:?} before: {got} {wanted}"
                );
            }
        }
    }
}
