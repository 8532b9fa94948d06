//! Majorants of one curve over a span between keys.

use super::cubic::{cubic, cubic_over_time, part};
use super::curve::{Curve, solve};
use super::majorant::Majorant;
use super::number::Number;
use super::over::Over;
use super::tangents::reach;
use ufbx::{ExtrapolationMode, Interpolation};

impl Curve<'_> {
    /// Over a span on the file's clock.
    pub(crate) fn over(&mut self, over: Over) -> Number {
        let middle = over.middle();
        let value = self.at(middle);
        let (Some(first), Some(last)) = (self.keys.first(), self.keys.last()) else {
            return Number::still(0.0);
        };
        if self.keys.len() == 1 {
            return Number::still(value);
        }
        if middle >= first.time && middle <= last.time {
            return self.between(over, value);
        }
        let is_before = middle < first.time;
        let is_beyond = match is_before {
            true => over.to <= first.time + over.slack,
            false => over.from >= last.time - over.slack,
        };
        if !is_beyond {
            return self.anywhere(over, value);
        }
        let (how, key) = match is_before {
            true => (self.before, first),
            false => (self.after, last),
        };
        match how.mode {
            ExtrapolationMode::Constant => return Number::still(value),
            ExtrapolationMode::Slope => {
                let slope = (value - key.value) / (middle - key.time);
                return line(value, slope * (over.to - over.from));
            }
            _ => {}
        }
        let Some((inner, _)) = self.folded(middle) else {
            return Number::still(value);
        };
        let slack = over.slack + 1e-9 * (1.0 + middle.abs());
        // Behind the last of so many repetitions it stands where that one ends.
        let past = match is_before {
            true => first.time - over.to,
            false => over.from - last.time,
        };
        let all = f64::from(how.repeats) * (last.time - first.time);
        if how.repeats > 0 && past >= all - slack {
            return Number::still(value);
        }
        // Seams are keys, so that a span lies within one repetition.
        let half = (over.to - over.from) / 2.0;
        let inner = Over {
            from: inner - half,
            to: inner + half,
            slack,
        };
        self.between(inner, value)
    }

    /// The same of how it moves alone: what its size is said to be may be less than it is.
    pub(super) fn moves_over(&mut self, over: Over) -> Majorant {
        let middle = over.middle();
        let (Some(first), Some(last)) = (self.keys.first(), self.keys.last()) else {
            return Majorant::ZERO;
        };
        if self.keys.len() == 1 {
            return Majorant::ZERO;
        }
        if middle >= first.time && middle <= last.time {
            let at = self.segment(middle);
            if let (Some(key), Some(next)) = (self.keys.get(at), self.keys.get(at + 1))
                && over.from >= key.time - over.slack
                && over.to <= next.time + over.slack
            {
                return self.piece_over(at, over).unwrap_or(Majorant::ZERO);
            }
        }
        self.over(over).moves
    }

    fn between(&mut self, over: Over, value: f64) -> Number {
        let at = self.segment(over.middle());
        let (Some(key), Some(next)) = (self.keys.get(at), self.keys.get(at + 1)) else {
            return Number::still(value);
        };
        if over.from < key.time - over.slack || over.to > next.time + over.slack {
            return self.anywhere(over, value);
        }
        match self.piece_over(at, over) {
            None => Number::still(value),
            Some(moves) if key.interpolation == Interpolation::Linear => line(value, moves.0[1]),
            Some(moves) => Number::of(value, moves),
        }
    }

    /// What lies between key `at` and the next one, over a part of it, but for the size of lines; `None` where it stands.
    fn piece_over(&mut self, at: usize, over: Over) -> Option<Majorant> {
        let (key, next) = (self.keys.get(at)?, self.keys.get(at + 1)?);
        let length = next.time - key.time;
        let share = |time: f64| ((time - key.time) / length).clamp(0.0, 1.0);
        let (s, e) = (share(over.from), share(over.to));
        match key.interpolation {
            Interpolation::ConstantPrev | Interpolation::ConstantNext => None,
            Interpolation::Linear => {
                Some(Majorant::moving(0.0, (next.value - key.value) * (e - s)))
            }
            Interpolation::Cubic => {
                let piece = self.piece(at, key, next);
                let values = piece.values;
                Some(match piece.is_even() {
                    true => cubic(part(values, s, e)),
                    false => {
                        let (a, b) = (piece.out, 1.0 - piece.into);
                        let (p, q) = (solve(a, b, s), solve(a, b, e));
                        let time = part([0.0, a, b, 1.0], p, q);
                        let time = time.map(|x| (x - time[0]) / (time[3] - time[0]));
                        cubic_over_time(time, part(values, p, q))
                    }
                })
            }
        }
    }

    /// Over a span with keys in it: between the least and the greatest point of all that it touches.
    fn anywhere(&mut self, over: Over, value: f64) -> Number {
        let (Some(first), Some(last)) = (self.keys.first(), self.keys.last()) else {
            return Number::still(value);
        };
        let (begin, end) = (first.time, last.time);
        let is_inside = over.from >= begin && over.to <= end;
        let touched = match is_inside {
            true => self.segment(over.from)..self.segment(over.to) + 1,
            false => 0..self.keys.len(),
        };
        let mut all = (value, value);
        let mut take = |x: f64| all = (all.0.min(x), all.1.max(x));
        for at in touched {
            let Some(key) = self.keys.get(at) else { break };
            take(key.value);
            let Some(next) = self.keys.get(at + 1) else {
                break;
            };
            take(next.value);
            if key.interpolation == Interpolation::Cubic {
                let length = next.time - key.time;
                let (out, out_slope) = reach(key.right, length);
                let (into, into_slope) = reach(next.left, length);
                take(key.value + out_slope * out);
                take(next.value - into_slope * into);
            }
        }
        if !is_inside {
            // Repetitions that climb, and lines, go beyond all keys: by no more than they do at the ends, and one climb.
            let climb = (last.value - first.value).abs();
            let ends = [over.from, over.to].map(|time| self.at(time));
            for end in ends {
                take(end - climb);
                take(end + climb);
            }
            let modes = [self.before.mode, self.after.mode];
            if modes.contains(&ExtrapolationMode::RepeatRelative) {
                let whole = all.1 - all.0;
                all = (all.0 - whole, all.1 + whole);
            }
        }
        let (low, high) = all;
        Number::within(value, low, high)
    }
}

/// A number that goes `way` along a line, at `value` in the middle.
pub(super) fn line(value: f64, way: f64) -> Number {
    let most = value.abs() + way.abs() / 2.0;
    Number::of(value, Majorant::moving(most, way))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::curve::Beyond;
    use crate::curves::holds;
    use ufbx::{Keyframe, Tangent};

    #[test]
    fn weighted_tangents_hold() {
        for (out, into) in [(0.2, 0.4), (0.05, 0.9), (0.333, 0.1)] {
            let key = |time: f64, value: f64, dx: f32| Keyframe {
                time,
                value,
                interpolation: Interpolation::Cubic,
                left: Tangent { dx, dy: 3.0 * dx },
                right: Tangent { dx, dy: -7.0 * dx },
            };
            let keys = [key(1.0, 2.0, 2.0 * out), key(3.0, 5.0, 2.0 * into)];
            let mut curve = Curve::with_keys(&keys);
            for (from, to) in [(1.0, 3.0), (1.0, 1.4), (1.9, 2.3), (2.9, 3.0)] {
                let over = Over {
                    from,
                    to,
                    slack: 0.0,
                };
                let number = curve.over(over);
                let other = curve.clone();
                assert!(
                    number.moves.0[1].is_finite() || to - from > 1.0,
                    "{number:?}"
                );
                holds(&number.moves, over, |time| [other.clone().at(time)]);
            }
        }
    }

    #[test]
    fn behind_the_last_repetition_nothing_moves() {
        let key = |time: f64, value: f64| Keyframe {
            time,
            value,
            interpolation: Interpolation::Linear,
            left: Tangent { dx: 0.333, dy: 0.0 },
            right: Tangent { dx: 0.333, dy: 0.0 },
        };
        let keys = [key(1.0, 2.0), key(3.0, 5.0)];
        for mode in [
            ExtrapolationMode::Repeat,
            ExtrapolationMode::Mirror,
            ExtrapolationMode::RepeatRelative,
        ] {
            let mut curve = Curve::with_keys(&keys);
            curve.after = Beyond { mode, repeats: 2 };
            curve.before = Beyond { mode, repeats: 3 };
            // Two repetitions end at 7 s, three begin at -5 s.
            for (from, to, stands) in [
                (7.0, 9.0, true),
                (20.0, 80.0, true),
                (-9.0, -5.0, true),
                (6.5, 7.0, false),
                (-5.0, -4.0, false),
            ] {
                let slack = 0.0;
                let over = Over { from, to, slack };
                let number = curve.over(over);
                assert!(number.moves.1.is_finite(), "{mode:?}: {number:?}");
                let is_still = number.moves == Majorant::still(number.middle);
                assert_eq!(is_still, stands, "{mode:?} {from}");
                let other = curve.clone();
                holds(&number.moves, over, |time| [other.clone().at(time)]);
            }
        }
    }

    #[test]
    fn what_lies_on_both_sides_of_keys_stays_within() {
        let key = |time: f64, value: f64| Keyframe {
            time,
            value,
            interpolation: Interpolation::Cubic,
            left: Tangent { dx: 0.333, dy: 2.0 },
            right: Tangent {
                dx: 0.333,
                dy: -1.0,
            },
        };
        let keys = [key(1.0, 2.0), key(2.0, -1.0), key(3.0, 5.0)];
        let mut curve = Curve::with_keys(&keys);
        curve.after.mode = ExtrapolationMode::RepeatRelative;
        for (from, to) in [(1.5, 2.2), (0.0, 1.8), (1.1, 2.9), (2.5, 3.2), (3.5, 8.0)] {
            let over = Over {
                from,
                to,
                slack: 0.0,
            };
            let number = curve.over(over);
            assert!(number.moves.0[1].is_infinite() && number.moves.1 < 60.0);
            let other = curve.clone();
            holds(&number.moves, over, |time| [other.clone().at(time)]);
        }
    }
}
