//! The fewest keys that pass within a tolerance of every sample.
//!
//! Keys stand on samples (not on predicted middles) and are exact there. From each key the next one is taken as far away as all
//! samples between stay within tolerance: found by doubling the distance, then halving the gap. A
//! cubic's two tangents are fitted to the samples between its keys (least squares), each stretch by
//! itself, which glTF allows: a key's tangents on its two sides are two values.

use super::value::{Value, cubic, hermite};

/// Stretches of fewer samples than this are fitted only where these are spread evenly.
const CROWD: usize = 6;

/// Samples of one property.
pub(crate) struct Signal<'a, V, D> {
    /// Seconds, as f32 has them.
    pub(crate) times: &'a [f64],
    /// Values may jump after this sample.
    pub(crate) jumps: &'a [bool],
    /// Samples that keys may stand on; the first and the last are among them.
    pub(crate) stops: &'a [usize],
    pub(crate) values: &'a [V],
    /// How far two values are apart, in the unit of the tolerance.
    pub(crate) distance: D,
}

/// Numbers of samples that became keys, and tangents for the stretch after each, per stretch.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Keys<V> {
    pub(crate) at: Vec<usize>,
    /// Out of the key and into the next; empty where the keys are linear or steps.
    pub(crate) tangents: Vec<(V, V)>,
}

impl<V: Value, D: Fn(&V, &V) -> f64> Signal<'_, V, D> {
    /// One value within `tolerance` of all samples: `wanted` if it is, else one of the signal's own.
    pub(crate) fn constant(&self, wanted: &V, tolerance: f64) -> Option<V> {
        let near = |value: &V| {
            self.values
                .iter()
                .all(|v| (self.distance)(v, value) <= tolerance)
        };
        if near(wanted) {
            return Some(wanted.clone());
        }
        let first = self.values.first()?;
        // Cheap to refuse: most signals that move leave the tolerance at once.
        if !self
            .values
            .iter()
            .all(|v| (self.distance)(v, first) <= 2.0 * tolerance)
        {
            return None;
        }
        let mut mean = first.zero();
        for value in self.values {
            V::add(&mut mean, value, 1.0 / self.values.len() as f64);
        }
        let mean = mean.finish();
        [mean, first.clone()].into_iter().find(near)
    }

    /// Keys of a signal that stands still but for its jumps; `None` if it does not.
    pub(crate) fn steps(&self, tolerance: f64) -> Option<Keys<V>> {
        let mut at = vec![0];
        for i in 1..self.values.len() {
            let key = at[at.len() - 1];
            if (self.distance)(&self.values[i], &self.values[key]) <= tolerance {
                continue;
            }
            if !self.jumps[i - 1] {
                return None;
            }
            at.push(i);
        }
        Some(Keys {
            at,
            tangents: Vec::new(),
        })
    }

    /// Keys on all of `wanted`, with straight lines between them; `None` where these are not near enough.
    pub(crate) fn linear_on(&self, wanted: &[usize], tolerance: f64) -> Option<Keys<V>> {
        let fits = |pair: &[usize]| self.is_straight(pair[0], pair[1], tolerance);
        wanted.windows(2).all(fits).then(|| Keys {
            at: wanted.to_vec(),
            tangents: Vec::new(),
        })
    }

    /// Keys with straight lines between them; `None` where none are near enough.
    pub(crate) fn linear(&self, tolerance: f64) -> Option<Keys<V>> {
        let (at, found) = self.walk(|from, to| self.is_straight(from, to, tolerance).then_some(()));
        (found.len() + 1 == at.len()).then_some(Keys {
            at,
            tangents: Vec::new(),
        })
    }

    fn is_straight(&self, from: usize, to: usize, tolerance: f64) -> bool {
        if to == from + 1 {
            return true;
        }
        let line = V::line(&self.values[from], &self.values[to]);
        let per_second = 1.0 / (self.times[to] - self.times[from]);
        (from + 1..to).all(|i| {
            let share = (self.times[i] - self.times[from]) * per_second;
            (self.distance)(&V::on_line(&line, share), &self.values[i]) <= tolerance
        })
    }

    /// Keys with cubics between them.
    pub(crate) fn cubic(&self, tolerance: f64) -> Keys<V> {
        let (at, tangents) = self.walk(|from, to| {
            let nothing_between = self
                .stops
                .binary_search(&from)
                .is_ok_and(|i| self.stops.get(i + 1) == Some(&to));
            // Between neighbours there is nothing nearer than what the fit gives.
            self.stretch(
                from,
                to,
                if nothing_between {
                    f64::INFINITY
                } else {
                    tolerance
                },
            )
        });
        Keys { at, tangents }
    }

    /// The farthest next key for which `try_stretch` gives something, again and again. Neighbours
    /// follow each other whatever it gives.
    fn walk<T>(&self, try_stretch: impl Fn(usize, usize) -> Option<T>) -> (Vec<usize>, Vec<T>) {
        let last = self.stops.len() - 1;
        let attempt = |from: usize, to: usize| try_stretch(self.stops[from], self.stops[to]);
        // No stretch goes across a jump: where the next one is, from each stop on.
        let mut walls = vec![last; last + 1];
        for i in (0..last).rev() {
            walls[i] = if self.jumps[self.stops[i]] {
                i
            } else {
                walls[i + 1]
            };
        }
        let (mut at, mut found) = (vec![0], Vec::new());
        let (mut from, mut stride) = (0, 4);
        while from < last {
            let wall = walls[from].max(from + 1);
            let mut good = from + 1;
            let mut best = attempt(from, good);
            let mut bad = wall + 1;
            let mut step = stride;
            while good < wall {
                let to = (from + step).min(wall);
                if to > good {
                    match attempt(from, to) {
                        Some(stretch) => (good, best) = (to, Some(stretch)),
                        None => {
                            bad = to;
                            break;
                        }
                    }
                }
                step += step.div_ceil(2);
            }
            // An eighth of a stretch is not worth another look.
            while bad - good > 1 + (good - from) / 8 && good < wall {
                let to = (good + bad) / 2;
                match attempt(from, to) {
                    Some(stretch) => (good, best) = (to, Some(stretch)),
                    None => bad = to,
                }
            }
            // Signals are alike along the way: the next search starts near this one's end.
            stride = ((good - from) * 4 / 5).max(2);
            found.extend(best);
            at.push(self.stops[good]);
            from = good;
        }
        (at, found)
    }

    /// Tangents with which a cubic from one sample to another keeps to those between.
    fn stretch(&self, from: usize, to: usize, tolerance: f64) -> Option<(V, V)> {
        let (p, q) = (&self.values[from], &self.values[to]);
        // The straight line's tangents, which the fit changes.
        let mut line = q.clone();
        V::add(&mut line, p, -1.0);
        if to == from + 1 {
            return Some((line.clone(), line));
        }
        let length = self.times[to] - self.times[from];
        let per_second = 1.0 / length;
        let share = |i: usize| (self.times[i] - self.times[from]) * per_second;
        // Few samples that crowd together would let the cubic swing between the others.
        if to - from < CROWD && tolerance.is_finite() {
            let even = length / (to - from) as f64;
            if (from..to).any(|i| self.times[i + 1] - self.times[i] < 0.4 * even) {
                return None;
            }
        }
        let (mut bb, mut bd, mut dd) = (0.0, 0.0, 0.0);
        let (mut rb, mut rd) = (p.zero(), p.zero());
        for i in from + 1..to {
            let [_, b, c, d] = hermite(share(i));
            bb += b * b;
            bd += b * d;
            dd += d * d;
            // What the line's own tangents leave: the sample less `p`, less what the cubic with
            // them comes to, which is the share itself.
            let mut rest = self.values[i].clone();
            V::add(&mut rest, p, -1.0);
            V::add(&mut rest, &line, -(b + c + d));
            V::add(&mut rb, &rest, b);
            V::add(&mut rd, &rest, d);
        }
        // One sample says too little for two tangents: the smaller change is taken.
        let ridge = 1e-12 * (bb + dd);
        let (bb, dd) = (bb + ridge, dd + ridge);
        let det = bb * dd - bd * bd;
        let (mut out, mut into) = (line.clone(), line);
        V::add(&mut out, &rb, dd / det);
        V::add(&mut out, &rd, -bd / det);
        V::add(&mut into, &rd, bb / det);
        V::add(&mut into, &rb, -bd / det);
        let fits = (from + 1..to).all(|i| {
            let value = cubic(p, &out, q, &into, share(i));
            (self.distance)(&value, &self.values[i]) <= tolerance
        });
        fits.then_some((out, into))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn signal<'a>(
        times: &'a [f64],
        jumps: &'a [bool],
        values: &'a [DVec3],
    ) -> Signal<'a, DVec3, impl Fn(&DVec3, &DVec3) -> f64> {
        let distance = |a: &DVec3, b: &DVec3| (*a - *b).length();
        let stops: &[usize] = Box::leak((0..times.len()).collect());
        Signal {
            times,
            jumps,
            stops,
            values,
            distance,
        }
    }

    fn sampled(of: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<bool>, Vec<DVec3>) {
        let times: Vec<f64> = (0..=100).map(|i| f64::from(i) / 100.0).collect();
        let values = times.iter().map(|&t| DVec3::new(of(t), 1.0, -t)).collect();
        (times, vec![false; 101], values)
    }

    #[test]
    fn one_cubic_is_one_stretch() {
        let (times, jumps, values) = sampled(|t| 4.0 * t * t * t - 3.0 * t * t + t);
        let keys = signal(&times, &jumps, &values).cubic(1e-9);
        assert_eq!(keys.at, [0, 100]);
        let (out, into) = keys.tangents[0];
        assert!((out - DVec3::new(1.0, 0.0, -1.0)).length() < 1e-6, "{out}");
        assert!(
            (into - DVec3::new(7.0, 0.0, -1.0)).length() < 1e-6,
            "{into}"
        );
    }

    #[test]
    fn a_bent_line_is_two_lines() {
        let (times, jumps, values) = sampled(|t| (t - 0.4).max(0.0));
        assert_eq!(
            signal(&times, &jumps, &values).linear(1e-9).unwrap().at,
            [0, 40, 100]
        );
    }

    #[test]
    fn keys_keep_to_the_tolerance() {
        let (times, jumps, values) = sampled(|t| (9.0 * t * t).fract());
        for tolerance in [1e-1, 1e-2, 1e-3] {
            let keys = signal(&times, &jumps, &values).cubic(tolerance);
            for (pair, (out, into)) in keys.at.windows(2).zip(&keys.tangents) {
                for i in pair[0]..=pair[1] {
                    let share = (times[i] - times[pair[0]]) / (times[pair[1]] - times[pair[0]]);
                    let value = cubic(&values[pair[0]], out, &values[pair[1]], into, share);
                    assert!((value - values[i]).length() <= tolerance);
                }
            }
        }
    }

    #[test]
    fn keys_stand_on_stops_alone() {
        let (times, jumps, values) = sampled(|t| 9.0 * t * t);
        let stops: Vec<usize> = (0..=100).step_by(4).collect();
        let signal = Signal {
            stops: &stops,
            ..signal(&times, &jumps, &values)
        };
        let keys = signal.linear(0.02).unwrap();
        assert!(keys.at.iter().all(|at| at % 4 == 0));
        // Neighbours are farther off the arc than this: 9 * (0.02)^2.
        assert_eq!(signal.linear(0.003), None);
        assert_eq!(signal.cubic(0.003).at, [0, 100]);
    }

    #[test]
    fn a_jump_is_between_two_keys_and_never_inside_a_stretch() {
        let (times, mut jumps, values) = sampled(|t| if t > 0.305 { 5.0 } else { 1.0 });
        jumps[30] = true;
        let signal = signal(&times, &jumps, &values);
        let linear = signal.linear(1e-9).unwrap().at;
        assert_eq!(linear, [0, 30, 31, 100]);
        // Z falls all the while: no steps.
        assert_eq!(signal.steps(1e-9), None);
        let still: Vec<DVec3> = values.iter().map(|v| v.with_z(0.0)).collect();
        let steps = Signal {
            values: &still,
            ..signal
        }
        .steps(1e-9)
        .unwrap();
        assert_eq!(steps.at, [0, 31]);
    }

    #[test]
    fn what_stands_still_prefers_its_rest() {
        let values = [DVec3::X * 1.0, DVec3::X * 1.01, DVec3::X * 0.99];
        let (times, jumps) = ([0.0, 1.0, 2.0], [false; 3]);
        let signal = signal(&times, &jumps, &values);
        let rest = DVec3::X * 1.005;
        assert_eq!(signal.constant(&rest, 0.1), Some(rest));
        let mean = signal.constant(&DVec3::ZERO, 0.011).unwrap();
        assert!((mean - DVec3::X).length() < 1e-12);
        assert_eq!(signal.constant(&DVec3::ZERO, 0.009), None);
    }
}
