//! Values of two neighbouring keys with which a curve comes nearest to its samples, in least squares.
//!
//! The keys before and after the two stay as they are. Rotations are fitted as the four numbers that they
//! are: keys stand near enough to each other that a slerp and a chord are alike, and what comes
//! of it is measured before it is taken. (Weighing samples by how far they were missed, for the largest miss in
//! place of the squares, was tried on straight lines: no fewer bytes.)

use crate::clips::value::hermite;
use glam::DVec4;

/// Tangents of a stretch, out of its first key and into its second, for the whole of its length.
pub(super) type Tangents = (DVec4, DVec4);

/// Keys, and the samples that they are to come near.
#[derive(Clone, Copy)]
pub(super) struct Keys<'a> {
    /// Their samples.
    pub(super) at: &'a [usize],
    pub(super) values: &'a [DVec4],
    pub(super) wanted: &'a [DVec4],
    /// Seconds of all samples.
    pub(super) times: &'a [f64],
}

/// Sums over the samples inside of a stretch. A value is `p * (1 - s) + q * s + d * b + e * c`, where `p`
/// and `q` are its keys, `s` is the share of its length, and `d` and `e` are what its tangents
/// differ by from the straight line's.
#[derive(Default)]
struct Sums {
    pp: f64,
    pq: f64,
    qq: f64,
    py: DVec4,
    qy: DVec4,
    bends: Option<Bends>,
}

/// The same with the tangents.
#[derive(Default)]
struct Bends {
    bb: f64,
    bc: f64,
    cc: f64,
    /// Of `b` and `c` with the keys' shares and with the samples.
    bp: [f64; 2],
    bq: [f64; 2],
    by: [DVec4; 2],
}

impl Bends {
    /// The pair of which the sums are `right`.
    fn solve<T>(&self, right: [T; 2]) -> [T; 2]
    where
        T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Sub<Output = T>,
    {
        // One sample says too little for two tangents: the smaller change is taken.
        let ridge = 1e-12 * (self.bb + self.cc);
        let (bb, cc) = (self.bb + ridge, self.cc + ridge);
        let per_det = 1.0 / (bb * cc - self.bc * self.bc);
        [
            (right[0] * cc - right[1] * self.bc) * per_det,
            (right[1] * bb - right[0] * self.bc) * per_det,
        ]
    }
}

impl Sums {
    fn of(keys: &Keys, stretch: usize, cubic: bool) -> Self {
        let (from, to) = (keys.at[stretch], keys.at[stretch + 1]);
        let per_second = 1.0 / (keys.times[to] - keys.times[from]);
        let mut sums = Self::default();
        let mut bends = Bends::default();
        for i in from + 1..to {
            let share = (keys.times[i] - keys.times[from]) * per_second;
            let (p, q, y) = (1.0 - share, share, keys.wanted[i]);
            sums.pp += p * p;
            sums.pq += p * q;
            sums.qq += q * q;
            sums.py += y * p;
            sums.qy += y * q;
            if cubic {
                let [_, b, _, c] = hermite(share);
                bends.bb += b * b;
                bends.bc += b * c;
                bends.cc += c * c;
                for (slot, weight) in [b, c].into_iter().enumerate() {
                    bends.bp[slot] += weight * p;
                    bends.bq[slot] += weight * q;
                    bends.by[slot] += y * weight;
                }
            }
        }
        if cubic && to > from + 1 {
            sums.take_out(&bends);
            sums.bends = Some(bends);
        }
        sums
    }

    /// Leaves in the sums what the best tangents cannot follow.
    fn take_out(&mut self, bends: &Bends) {
        let (p, q) = (bends.solve(bends.bp), bends.solve(bends.bq));
        let with = |pair: [f64; 2], other: [f64; 2]| pair[0] * other[0] + pair[1] * other[1];
        self.pp -= with(p, bends.bp);
        self.pq -= with(p, bends.bq);
        self.qq -= with(q, bends.bq);
        self.py -= bends.by[0] * p[0] + bends.by[1] * p[1];
        self.qy -= bends.by[0] * q[0] + bends.by[1] * q[1];
    }

    /// The best tangents between two values.
    fn tangents(&self, p: DVec4, q: DVec4) -> Tangents {
        let way = q - p;
        let Some(bends) = &self.bends else {
            return (way, way);
        };
        let rest = [0, 1].map(|i| bends.by[i] - p * bends.bp[i] - q * bends.bq[i]);
        let [out, into] = bends.solve(rest);
        (way + out, way + into)
    }
}

/// The best values of keys number `a` and `a + 1` of a few.
pub(super) fn pair(keys: &Keys, a: usize, cubic: bool) -> [DVec4; 2] {
    let b = a + 1;
    // Each of the two has its own sample, so that there is always an answer.
    let (mut aa, mut ab, mut bb) = (1.0, 0.0, 1.0);
    let (mut ra, mut rb) = (keys.wanted[keys.at[a]], keys.wanted[keys.at[b]]);
    for stretch in a.saturating_sub(1)..(b + 1).min(keys.at.len() - 1) {
        let sums = Sums::of(keys, stretch, cubic);
        if stretch == a {
            aa += sums.pp;
            ab += sums.pq;
            bb += sums.qq;
            ra += sums.py;
            rb += sums.qy;
        } else if stretch == b {
            bb += sums.pp;
            rb += sums.py - keys.values[stretch + 1] * sums.pq;
        } else {
            aa += sums.qq;
            ra += sums.qy - keys.values[stretch] * sums.pq;
        }
    }
    let det = aa * bb - ab * ab;
    [(ra * bb - rb * ab) / det, (rb * aa - ra * ab) / det]
}

/// The best tangents of the stretch after key number `stretch`.
pub(super) fn tangents(keys: &Keys, stretch: usize) -> Tangents {
    let sums = Sums::of(keys, stretch, true);
    sums.tangents(keys.values[stretch], keys.values[stretch + 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: [usize; 4] = [0, 7, 15, 24];

    fn times() -> Vec<f64> {
        (0..=24)
            .map(|i| f64::from(i) * 0.04 + f64::from(i % 3) * 0.003)
            .collect()
    }

    #[test]
    fn what_is_cubic_is_found_from_wrong_keys() {
        let times = times();
        let of = |t: f64| DVec4::new(2.0 * t * t * t - t * t, 1.0 - t, t * t, 0.5);
        let wanted: Vec<DVec4> = times.iter().map(|&t| of(t)).collect();
        let mut values: Vec<DVec4> = AT.iter().map(|&at| wanted[at]).collect();
        values[1] += DVec4::ONE;
        values[2] -= DVec4::ONE;
        let keys = Keys {
            at: &AT,
            values: &values,
            wanted: &wanted,
            times: &times,
        };
        let [a, b] = pair(&keys, 1, true);
        assert!(
            a.distance(wanted[7]) < 1e-9 && b.distance(wanted[15]) < 1e-9,
            "{a} {b}"
        );
        let exact: Vec<DVec4> = AT.iter().map(|&at| wanted[at]).collect();
        let (out, into) = tangents(
            &Keys {
                values: &exact,
                ..keys
            },
            1,
        );
        let slope = |t: f64| DVec4::new(6.0 * t * t - 2.0 * t, -1.0, 2.0 * t, 0.0);
        let length = times[15] - times[7];
        assert!(out.distance(slope(times[7]) * length) < 1e-9, "{out}");
        assert!(into.distance(slope(times[15]) * length) < 1e-9, "{into}");
    }

    /// No other values are nearer in the squares.
    #[test]
    fn the_squares_are_least() {
        let times = times();
        let noise = |i: usize| f64::from((i * 37 % 11) as u32) * 0.1 - 0.5;
        let wanted: Vec<DVec4> = (0..25)
            .map(|i| DVec4::new(noise(i), noise(i + 3), 0.0, 1.0))
            .collect();
        for cubic in [false, true] {
            let squares = |a: DVec4, b: DVec4| -> f64 {
                let values = [wanted[0], a, b, wanted[24]];
                let keys = Keys {
                    at: &AT,
                    values: &values,
                    wanted: &wanted,
                    times: &times,
                };
                let inside = |stretch: usize| {
                    let (from, to) = (AT[stretch], AT[stretch + 1]);
                    let (p, q) = (values[stretch], values[stretch + 1]);
                    let (out, into) = match cubic {
                        true => tangents(&keys, stretch),
                        false => (q - p, q - p),
                    };
                    let times = &times;
                    let wanted = &wanted;
                    (from + 1..to).map(move |i| {
                        let share = (times[i] - times[from]) / (times[to] - times[from]);
                        let [h, b, g, c] = hermite(share);
                        (p * h + out * b + q * g + into * c).distance_squared(wanted[i])
                    })
                };
                let keys = a.distance_squared(wanted[7]) + b.distance_squared(wanted[15]);
                (0..3).flat_map(inside).sum::<f64>() + keys
            };
            let values = [wanted[0], DVec4::ZERO, DVec4::ZERO, wanted[24]];
            let keys = Keys {
                at: &AT,
                values: &values,
                wanted: &wanted,
                times: &times,
            };
            let [a, b] = pair(&keys, 1, cubic);
            let least = squares(a, b);
            for aside in [DVec4::X, DVec4::Y, -DVec4::X, -DVec4::Y] {
                let aside = aside * 1e-3;
                assert!(squares(a + aside, b) > least && squares(a, b + aside) > least);
            }
        }
    }
}
