//! Values of curves between their keys.
//!
//! Between two keys of a cubic lies a Bézier curve in time and value. Its inner points are a weight of the time between
//! the keys away, a third where none is said, along the slope at each key: with two thirds that is a Hermite curve.

use super::Reading;
use crate::scene::{Beyond, Clamp, Curve, Key, TICKS, Way};

/// Ticks as seconds.
pub fn seconds(ticks: i64) -> f64 {
    ticks as f64 / TICKS as f64
}

/// A curve, ready to be asked.
#[derive(Debug, Clone)]
pub struct Line {
    times: Vec<f64>,
    values: Vec<f64>,
    pieces: Vec<Piece>,
    beyond: [Beyond; 2],
}

#[derive(Debug, Clone, Copy)]
enum Piece {
    Hold,
    Next,
    Straight,
    /// Inner points: shares of the time, and values.
    Cubic([f64; 2], [f64; 2]),
}

impl Line {
    /// Of a curve that has a key at least.
    pub fn of(curve: &Curve, reading: Reading) -> Self {
        let keys = &curve.keys;
        let pieces = (1..keys.len())
            .map(|i| piece(keys, i - 1, reading))
            .collect();
        Self {
            times: keys.iter().map(|key| seconds(key.time)).collect(),
            values: keys.iter().map(|key| f64::from(key.value)).collect(),
            pieces,
            beyond: curve.beyond,
        }
    }

    /// The value at a time on the file's clock, seconds.
    pub fn at(&self, time: f64) -> f64 {
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        match (time < first, time > last) {
            (true, _) => self.outside(self.beyond[0], first - time, true),
            (_, true) => self.outside(self.beyond[1], time - last, false),
            _ => self.inside(time),
        }
    }

    /// So many seconds before the first key or after the last.
    fn outside(&self, beyond: Beyond, past: f64, before: bool) -> f64 {
        let last = self.times.len() - 1;
        let end = if before { 0 } else { last };
        let length = self.times[last] - self.times[0];
        let (count, back, climb) = match beyond {
            Beyond::Stays => return self.values[end],
            Beyond::Line => {
                let slope = self.slope(before);
                return self.values[end] + if before { -slope * past } else { slope * past };
            }
            Beyond::Again(count) => (count, false, 0.0),
            Beyond::Back(count) => (count, true, 0.0),
            Beyond::Climbs(count) => (count, false, self.values[last] - self.values[0]),
        };
        if count == 0 || length <= 0.0 {
            return self.values[end];
        }
        // Which repetition, from 0, and how far into it, away from the keys.
        let (mut number, mut into) = ((past / length).floor(), past % length);
        if count > 0 && number >= f64::from(count) {
            (number, into) = (f64::from(count - 1), length);
        }
        // The first one backwards meets the curve at the end that it begins at.
        let turned = back && number % 2.0 == 0.0;
        let from_first = match before != turned {
            true => length - into,
            false => into,
        };
        let climbed = climb * (number + 1.0);
        let inside = (self.times[0] + from_first).clamp(self.times[0], self.times[last]);
        self.inside(inside) + if before { -climbed } else { climbed }
    }

    /// The slope into the curve at its first key, or out of it at its last.
    fn slope(&self, first: bool) -> f64 {
        let at = if first {
            0
        } else {
            self.pieces.len().saturating_sub(1)
        };
        let Some(piece) = self.pieces.get(at) else {
            return 0.0;
        };
        let (from, to) = (self.values[at], self.values[at + 1]);
        let length = self.times[at + 1] - self.times[at];
        let over = |rise: f64, share: f64| match share > 0.0 {
            true => rise / (share * length),
            false => 0.0,
        };
        match piece {
            Piece::Hold | Piece::Next => 0.0,
            Piece::Straight => over(to - from, 1.0),
            Piece::Cubic(x, y) if first => over(y[0] - from, x[0]),
            Piece::Cubic(x, y) => over(to - y[1], 1.0 - x[1]),
        }
    }

    fn inside(&self, time: f64) -> f64 {
        let next = self.times.partition_point(|&t| t <= time);
        if next == 0 {
            return self.values[0];
        }
        let at = next - 1;
        let from = self.values[at];
        if next == self.times.len() || self.times[at] == time {
            return from;
        }
        let share = (time - self.times[at]) / (self.times[next] - self.times[at]);
        let to = self.values[next];
        match self.pieces[at] {
            Piece::Hold => from,
            Piece::Next => to,
            Piece::Straight => from + (to - from) * share,
            Piece::Cubic(x, y) => {
                let s = solve(x, share);
                bezier(from, y[0], y[1], to, s)
            }
        }
    }
}

fn bezier(a: f64, b: f64, c: f64, d: f64, s: f64) -> f64 {
    let u = 1.0 - s;
    u * u * u * a + 3.0 * u * s * (u * b + s * c) + s * s * s * d
}

/// Where on the curve its time is `share`: times grow along it, so halving finds the place.
fn solve(x: [f64; 2], share: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let mut s = share;
    for _ in 0..100 {
        let off = bezier(0.0, x[0], x[1], 1.0, s) - share;
        if off.abs() < 1e-16 {
            return s;
        }
        if off > 0.0 {
            high = s
        } else {
            low = s
        }
        let u = 1.0 - s;
        let slope = 3.0 * (u * u * x[0] + 2.0 * u * s * (x[1] - x[0]) + s * s * (1.0 - x[1]));
        let newton = s - off / slope;
        // Newton's step, where it stays between what is known.
        s = match newton > low && newton < high {
            true => newton,
            false => f64::midpoint(low, high),
        };
        if high - low < 1e-17 {
            break;
        }
    }
    s
}

fn piece(keys: &[Key], at: usize, reading: Reading) -> Piece {
    let (from, to) = (&keys[at], &keys[at + 1]);
    match from.way {
        Way::Constant => return Piece::Hold,
        Way::ConstantNext => return Piece::Next,
        Way::Linear => return Piece::Straight,
        Way::User { .. } | Way::Auto { .. } | Way::Tcb(_) => {}
    }
    let time = seconds(to.time) - seconds(from.time);
    let weights = weights(from, reading);
    let slopes = [
        slopes(keys, at, reading)[1],
        slopes(keys, at + 1, reading)[0],
    ];
    let [a, b] = [0, 1].map(|i| {
        let across = reading.round(weights[i] * time);
        (
            across / time,
            reading.round(across * reading.round(slopes[i])),
        )
    });
    let (first, last) = (f64::from(from.value), f64::from(to.value));
    Piece::Cubic([a.0, 1.0 - b.0], [first + a.1, last - b.1])
}

/// Of a key's right tangent and the next key's left one.
fn weights(key: &Key, reading: Reading) -> [f64; 2] {
    match key.weights {
        Some(weights) if reading.single => weights.map(|w| f64::from(f32::from(w) * 1e-4_f32)),
        Some(weights) => weights.map(|w| f64::from(w) * 1e-4),
        None => [reading.third; 2],
    }
}

/// Slopes to the left and to the right of a key, a second.
fn slopes(keys: &[Key], at: usize, reading: Reading) -> [f64; 2] {
    let key = &keys[at];
    let before = at.checked_sub(1).map(|i| &keys[i]);
    let next = keys.get(at + 1);
    match key.way {
        // The left one stands with the key before.
        Way::User { right, .. } => [left_of(before), f64::from(right)],
        Way::Constant | Way::ConstantNext | Way::Linear => {
            // A cubic that ends at a key without tangents of its own arrives as the key before says.
            let chord = |a: &Key, b: &Key| chord(a, b);
            let right = match (key.way, next) {
                (Way::Linear, Some(next)) => chord(key, next),
                _ => 0.0,
            };
            [left_of(before), right]
        }
        Way::Tcb(tcb) => kochanek_bartels(before, key, next, tcb),
        Way::Auto {
            clamp,
            time_independent,
        } => {
            let slope = automatic(before, key, next, clamp, time_independent, reading);
            [slope; 2]
        }
    }
}

fn left_of(before: Option<&Key>) -> f64 {
    match before.map(|before| before.way) {
        Some(Way::User { next_left, .. }) => f64::from(next_left),
        _ => 0.0,
    }
}

/// The slope of the line between two keys.
fn chord(a: &Key, b: &Key) -> f64 {
    (f64::from(b.value) - f64::from(a.value)) / (seconds(b.time) - seconds(a.time))
}

/// Kochanek and Bartels, "Interpolating splines with local tension, continuity, and bias control", 1984, on slopes; at an
/// end of the curve there is one side only, which counts twice.
fn kochanek_bartels(
    before: Option<&Key>,
    key: &Key,
    next: Option<&Key>,
    tcb: [f32; 3],
) -> [f64; 2] {
    let [t, c, b] = tcb.map(f64::from);
    let half = if before.is_none() || next.is_none() {
        1.0
    } else {
        0.5
    };
    let left = before.map_or(0.0, |before| chord(before, key));
    let right = next.map_or(0.0, |next| chord(key, next));
    let mix =
        |c: f64| half * (1.0 - t) * ((1.0 + b) * (1.0 - c) * left + (1.0 - b) * (1.0 + c) * right);
    [mix(c), mix(-c)]
}

/// The mean of two slopes: that of the line between the neighbours, and that of the parabola through the three keys.
fn automatic(
    before: Option<&Key>,
    key: &Key,
    next: Option<&Key>,
    clamp: Clamp,
    time_independent: bool,
    reading: Reading,
) -> f64 {
    let flat = |other: &Key| {
        clamp == Clamp::Flat && (f64::from(other.value) - f64::from(key.value)).abs() <= 1e-3
    };
    let (before, next) = match (before, next) {
        (Some(before), Some(next)) => (before, next),
        (Some(other), None) | (None, Some(other)) => {
            return match clamp == Clamp::Progressive || flat(other) {
                true => 0.0,
                false => chord(other, key),
            };
        }
        (None, None) => return 0.0,
    };
    if flat(before) || flat(next) {
        return 0.0;
    }
    let (left, right) = (chord(before, key), chord(key, next));
    let mut slope = chord(before, next);
    if !time_independent {
        let share = (seconds(key.time) - seconds(before.time))
            / (seconds(next.time) - seconds(before.time));
        let parabola = left * (1.0 - share) + right * share;
        slope = f64::midpoint(slope, parabola);
    }
    if clamp == Clamp::Progressive {
        // An inner point may be as high as the key that it looks to.
        let most = |chord: f64, weight: f64| (slope.signum() * chord / weight).max(0.0);
        let most =
            most(left, weights(before, reading)[1]).min(most(right, weights(key, reading)[0]));
        slope = slope.signum() * slope.abs().min(most);
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(keys: &[(f64, f32, Way)]) -> Line {
        let key = |&(time, value, way): &(f64, f32, Way)| Key {
            time: (time * TICKS as f64) as i64,
            value,
            way,
            weights: None,
            velocity: false,
        };
        let keys = keys.iter().map(key).collect();
        Line::of(&Curve::of(keys), Reading::EXACT)
    }

    const AUTO: Way = Way::Auto {
        clamp: Clamp::Free,
        time_independent: false,
    };

    #[test]
    fn a_cubic_is_hermites() {
        // x³ over 0 to 2 has slopes 0 and 12.
        let user = Way::User {
            right: 0.0,
            next_left: 12.0,
            broken: true,
        };
        let line = line(&[(0.0, 0.0, user), (2.0, 8.0, Way::Linear)]);
        for x in [0.0, 0.3, 1.0, 1.7, 2.0] {
            assert!(
                (line.at(x) - x * x * x).abs() < 1e-12,
                "{x}: {}",
                line.at(x)
            );
        }
        assert_eq!((line.at(-1.0), line.at(3.0)), (0.0, 8.0));
    }

    #[test]
    fn automatic_slopes_follow_a_parabola() {
        // Both slopes of x² at a key in the middle of two are its own.
        let line = line(&[(1.0, 1.0, AUTO), (2.0, 4.0, AUTO), (3.0, 9.0, AUTO)]);
        let slope = (line.at(2.0 + 1e-6) - line.at(2.0 - 1e-6)) / 2e-6;
        assert!((slope - 4.0).abs() < 1e-5, "{slope}");
    }

    #[test]
    fn steps_are_on_their_side() {
        let line = line(&[
            (0.0, 1.0, Way::Constant),
            (1.0, 2.0, Way::ConstantNext),
            (2.0, 3.0, Way::Linear),
        ]);
        assert_eq!(
            [0.0, 0.999, 1.0, 1.001, 2.0].map(|t| line.at(t)),
            [1.0, 1.0, 2.0, 3.0, 3.0]
        );
    }

    #[test]
    fn curves_go_on_beyond_their_keys() {
        let ways = [
            (Beyond::Stays, [2.0, 2.0], [6.0, 6.0]),
            (Beyond::Line, [0.0, -8.0], [8.0, 16.0]),
            (Beyond::Again(-1), [4.0, 4.0], [4.0, 4.0]),
            (Beyond::Back(-1), [4.0, 4.0], [4.0, 4.0]),
            (Beyond::Climbs(-1), [0.0, -8.0], [8.0, 16.0]),
            // Once, and then as it ended.
            (Beyond::Again(1), [4.0, 2.0], [4.0, 6.0]),
            (Beyond::Back(1), [4.0, 6.0], [4.0, 2.0]),
            (Beyond::Climbs(1), [0.0, -2.0], [8.0, 10.0]),
            (Beyond::Climbs(0), [2.0, 2.0], [6.0, 6.0]),
        ];
        for (beyond, before, after) in ways {
            let mut line = line(&[(1.0, 2.0, Way::Linear), (3.0, 6.0, Way::Linear)]);
            line.beyond = [beyond; 2];
            // Halfway into the first repetition, and into the third.
            let got = [0.0, -4.0, 4.0, 8.0].map(|time| line.at(time));
            for (got, wanted) in got.iter().zip(before.iter().chain(&after)) {
                assert!((got - wanted).abs() < 1e-9, "{beyond:?}: {got} {wanted}");
            }
        }
    }

    #[test]
    fn weights_bend_time() {
        let keys = [(0, 0.0), (TICKS, 1.0)].map(|(time, value)| Key {
            time,
            value,
            way: Way::User {
                right: 0.0,
                next_left: 0.0,
                broken: true,
            },
            weights: Some([9000, 9000]),
            velocity: false,
        });
        let line = Line::of(&Curve::of(keys.to_vec()), Reading::EXACT);
        // Flat for long at both ends, so steep in the middle, which stays where it is.
        assert!((line.at(0.5) - 0.5).abs() < 1e-12);
        assert!(
            line.at(0.25) < 0.05 && line.at(0.75) > 0.95,
            "{}",
            line.at(0.25)
        );
    }
}
