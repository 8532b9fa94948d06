//! The fewest keys that pass within a tolerance of every sample.
//!
//! Keys stand on samples and are exact there. From each key the next one is taken as far away as all
//! samples between stay within tolerance: found by doubling the distance, then halving the gap. A
//! cubic's two tangents are fitted to the samples between its keys (least squares), each stretch by
//! itself, which glTF allows: a key's tangents on its two sides are two values.

use super::value::{Value, cubic, hermite};

/// Samples of one property.
pub(crate) struct Signal<'a, V, D> {
    /// Seconds.
    pub(crate) times: &'a [f32],
    /// Values may jump after this sample.
    pub(crate) jumps: &'a [bool],
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
        let near = |value: &V| self.values.iter().all(|v| (self.distance)(v, value) <= tolerance);
        if near(wanted) {
            return Some(wanted.clone());
        }
        let first = self.values.first()?;
        // Cheap to refuse: most signals that move leave the tolerance at once.
        if !self.values.iter().all(|v| (self.distance)(v, first) <= 2.0 * tolerance) {
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
        Some(Keys { at, tangents: Vec::new() })
    }

    /// Keys with straight lines between them.
    pub(crate) fn linear(&self, tolerance: f64) -> Keys<V> {
        let fits = |from: usize, to: usize| {
            (from + 1..to).all(|i| {
                let mixed = V::mix(&self.values[from], &self.values[to], self.share(from, i, to));
                (self.distance)(&mixed, &self.values[i]) <= tolerance
            })
        };
        Keys {
            at: self.walk(|from, to| fits(from, to).then_some(())).0,
            tangents: Vec::new(),
        }
    }

    /// Keys with cubics between them.
    pub(crate) fn cubic(&self, tolerance: f64) -> Keys<V> {
        let (at, tangents) = self.walk(|from, to| self.stretch(from, to, tolerance));
        Keys { at, tangents }
    }

    fn share(&self, from: usize, at: usize, to: usize) -> f64 {
        let [from, at, to] = [from, at, to].map(|i| f64::from(self.times[i]));
        (at - from) / (to - from)
    }

    /// The farthest next key for which `try_stretch` gives something, again and again.
    fn walk<T>(&self, try_stretch: impl Fn(usize, usize) -> Option<T>) -> (Vec<usize>, Vec<T>) {
        let last = self.values.len() - 1;
        let (mut at, mut found) = (vec![0], Vec::new());
        let mut stride = 4;
        while let Some(&from) = at.last().filter(|&&from| from < last) {
            // No stretch goes across a jump.
            let wall = (from..last).find(|&i| self.jumps[i]).map_or(last, |i| i.max(from + 1));
            let mut good = from + 1;
            let mut best = try_stretch(from, good);
            let mut bad = wall + 1;
            let mut step = stride;
            while good < wall {
                let to = (from + step).min(wall);
                if to <= good {
                    step *= 2;
                    continue;
                }
                match try_stretch(from, to) {
                    Some(stretch) => (good, best) = (to, Some(stretch)),
                    None => {
                        bad = to;
                        break;
                    }
                }
                step *= 2;
            }
            while bad - good > 1 && good < wall {
                let to = (good + bad) / 2;
                match try_stretch(from, to) {
                    Some(stretch) => (good, best) = (to, Some(stretch)),
                    None => bad = to,
                }
            }
            // Signals are alike along the way: the next search starts near this one's end.
            stride = ((good - from) / 2).max(2);
            found.extend(best);
            at.push(good);
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
        let (mut bb, mut bd, mut dd) = (0.0, 0.0, 0.0);
        let (mut rb, mut rd) = (p.zero(), p.zero());
        for i in from + 1..to {
            let [a, b, c, d] = hermite(self.share(from, i, to));
            bb += b * b;
            bd += b * d;
            dd += d * d;
            let mut rest = self.values[i].clone();
            V::add(&mut rest, p, -a - 0.0);
            V::add(&mut rest, q, -c);
            V::add(&mut rest, &line, -b - d);
            V::add(&mut rb, &rest, b);
            V::add(&mut rd, &rest, d);
        }
        // One sample says too little for two tangents: the smaller change is taken.
        let ridge = 1e-9 * (bb + dd);
        let (bb, dd) = (bb + ridge, dd + ridge);
        let det = bb * dd - bd * bd;
        let (mut out, mut into) = (line.clone(), line);
        V::add(&mut out, &rb, dd / det);
        V::add(&mut out, &rd, -bd / det);
        V::add(&mut into, &rd, bb / det);
        V::add(&mut into, &rb, -bd / det);
        let fits = (from + 1..to).all(|i| {
            let value = cubic(p, &out, q, &into, self.share(from, i, to));
            (self.distance)(&value, &self.values[i]) <= tolerance
        });
        fits.then_some((out, into))
    }
}
