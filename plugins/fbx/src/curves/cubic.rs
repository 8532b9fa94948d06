//! Majorants of cubics by their Bézier points.

use super::majorant::{Majorant, ORDERS};

/// A part of a Bézier curve of third degree between two of its parameters, as its four points.
pub(crate) fn part(points: [f64; 4], from: f64, to: f64) -> [f64; 4] {
    if from == 0.0 && to == 1.0 {
        return points;
    }
    // The curve's polar form, which its points are values of.
    let polar = |a: f64, b: f64, c: f64| {
        let mix = |x: f64, y: f64, t: f64| x + (y - x) * t;
        let [p, q, r, s] = points;
        let (pq, qr, rs) = (mix(p, q, a), mix(q, r, a), mix(r, s, a));
        mix(mix(pq, qr, b), mix(qr, rs, b), c)
    };
    [
        polar(from, from, from),
        polar(from, from, to),
        polar(from, to, to),
        polar(to, to, to),
    ]
}

/// Of a cubic by its Bézier points.
pub(crate) fn cubic([a, b, c, d]: [f64; 4]) -> Majorant {
    let most = |list: &[f64]| list.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut out = Majorant::ZERO;
    out.0[0] = most(&[a, b, c, d]);
    out.0[1] = 3.0 * most(&[b - a, c - b, d - c]);
    out.0[2] = 3.0 * most(&[c - 2.0 * b + a, d - 2.0 * c + b]);
    out.0[3] = (d - 3.0 * c + 3.0 * b - a).abs();
    let middle = (a + 3.0 * (b + c) + d) / 8.0;
    out.1 = most(&[a - middle, b - middle, c - middle, d - middle]).min(out.0[1] / 2.0);
    out
}

/// Of a cubic over its own time, both by their Bézier points: time goes from 0 to 1.
pub(crate) fn cubic_over_time(time: [f64; 4], value: [f64; 4]) -> Majorant {
    let [a, b, c, d] = time;
    let slowest = 3.0 * (b - a).min(c - b).min(d - c);
    let whole = cubic(value);
    let ends = |of: fn(f64, f64) -> f64| value.into_iter().reduce(of).unwrap_or(0.0);
    let way = ends(f64::max) - ends(f64::min);
    if slowest.is_nan() || slowest <= 0.0 {
        return Majorant::within(whole.0[0], way);
    }
    let speed = cubic(time);
    // p(time) has the derivative 1 / speed(p).
    let mut place = Majorant::ZERO;
    let mut over = Majorant::still(1.0 / slowest);
    let mut there = Majorant::ZERO;
    place.0[1] = over.0[0];
    let squared =
        |place: &Majorant, k: usize| (1..k).map(|i| place.0[i] * place.0[k - i]).sum::<f64>();
    for k in 1..ORDERS - 1 {
        // The speed is the derivative of a cubic: its own derivatives are 2 and 3 times the cubic's next coefficients.
        there.0[k] = 2.0 * speed.0[2] * place.0[k] + 3.0 * speed.0[3] * squared(&place, k);
        over.0[k] = (1..=k).map(|i| there.0[i] * over.0[k - i]).sum::<f64>() / slowest;
        place.0[k + 1] = over.0[k] / (k + 1) as f64;
    }
    let twice = place.product(&place);
    let mut out = place
        .scaled(whole.0[1])
        .plus(&twice.scaled(whole.0[2]))
        .plus(&twice.product(&place).scaled(whole.0[3]));
    out.0[0] = whole.0[0];
    out.1 = way.min(out.0[1] / 2.0);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::{Over, holds};

    #[test]
    fn parts_of_cubics_are_cubics() {
        let points = [1.0, -2.0, 5.0, 0.5];
        let at = |points: [f64; 4], t: f64| part(points, t, t)[0];
        let cut = part(points, 0.2, 0.7);
        for t in [0.0, 0.3, 1.0] {
            assert!((at(cut, t) - at(points, 0.2 + 0.5 * t)).abs() < 1e-12);
        }
        holds(&cubic(cut), Over::WHOLE, |t| [at(cut, t)]);
    }
}
