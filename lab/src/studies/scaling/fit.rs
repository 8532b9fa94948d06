//! `t = a + bN + cL + dNL`, by least squares.

use serde_json::{Value, json};

/// A measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// N.
    pub objects: u32,
    /// L.
    pub lights: u32,
    /// Median, milliseconds.
    pub ms: f64,
}

impl Point {
    fn terms(self) -> [f64; 4] {
        let (n, l) = (f64::from(self.objects), f64::from(self.lights));
        [1.0, n, l, n * l]
    }
}

/// The coefficients, milliseconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit(pub [f64; 4]);

impl Fit {
    /// Of at least four points that tell the terms apart. Each is weighted by one over its time, so that errors are
    /// relative, and small frames count as large ones do.
    #[must_use]
    pub fn of(points: &[Point]) -> Option<Self> {
        // Columns in units of their largest, so that the system is well scaled.
        let largest = points.iter().fold([1.0_f64; 4], |most, point| {
            let terms = point.terms();
            std::array::from_fn(|k| most[k].max(terms[k]))
        });
        let mut system = [[0.0; 5]; 4];
        for point in points {
            let terms = point.terms();
            let weight = 1.0 / point.ms.max(1e-9);
            let row: [f64; 4] = std::array::from_fn(|k| terms[k] / largest[k] * weight);
            for (i, line) in system.iter_mut().enumerate() {
                for (j, cell) in line.iter_mut().take(4).enumerate() {
                    *cell += row[i] * row[j];
                }
                line[4] += row[i] * point.ms * weight;
            }
        }
        let solved = solve(system)?;
        Some(Self(std::array::from_fn(|k| solved[k] / largest[k])))
    }

    /// The model's time, milliseconds.
    #[must_use]
    pub fn at(&self, point: Point) -> f64 {
        let terms = point.terms();
        self.0.iter().zip(terms).map(|(c, t)| c * t).sum()
    }

    /// What the study says of it: coefficients, R², the largest share of the product's term in a measured time.
    #[must_use]
    pub fn json(&self, points: &[Point]) -> Value {
        let mean = points.iter().map(|p| p.ms).sum::<f64>() / points.len().max(1) as f64;
        let (mut left, mut all, mut share) = (0.0, 0.0, 0.0_f64);
        for point in points {
            let (rest, whole) = (point.ms - self.at(*point), point.ms - mean);
            left += rest * rest;
            all += whole * whole;
            share = share.max((self.0[3] * point.terms()[3] / point.ms).abs());
        }
        let [a, b, c, d] = self.0;
        json!({
            "a_ms": a,
            "b_us_an_object": 1e3 * b,
            "c_us_a_light": 1e3 * c,
            "d_ns_a_pair": 1e6 * d,
            "r_squared": 1.0 - left / all.max(1e-300),
            "product_share": share,
        })
    }
}

/// Gauss with the largest pivot; `None` if it is singular.
fn solve(mut system: [[f64; 5]; 4]) -> Option<[f64; 4]> {
    for k in 0..4 {
        let pivot = (k..4).max_by(|a, b| system[*a][k].abs().total_cmp(&system[*b][k].abs()))?;
        system.swap(k, pivot);
        if system[k][k].abs() < 1e-12 {
            return None;
        }
        let top = system[k];
        for line in system.iter_mut().skip(k + 1) {
            let factor = line[k] / top[k];
            for (cell, above) in line.iter_mut().zip(top) {
                *cell -= factor * above;
            }
        }
    }
    let mut solved = [0.0; 4];
    for k in (0..4).rev() {
        let known: f64 = (k + 1..4).map(|j| system[k][j] * solved[j]).sum();
        solved[k] = (system[k][4] - known) / system[k][k];
    }
    Some(solved)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(time: impl Fn(f64, f64) -> f64) -> Vec<Point> {
        let mut points = Vec::new();
        for objects in [64, 512, 4096] {
            for lights in [0, 64, 512, 2048] {
                let ms = time(f64::from(objects), f64::from(lights));
                points.push(Point {
                    objects,
                    lights,
                    ms,
                });
            }
        }
        points
    }

    #[test]
    fn coefficients_come_back() {
        let points = points(|n, l| 7.0 + 0.003 * n + 0.01 * l + 2e-6 * n * l);
        let fit = Fit::of(&points).expect("a fit");
        for (got, asked) in fit.0.iter().zip([7.0, 0.003, 0.01, 2e-6]) {
            assert!((got - asked).abs() <= 1e-9 * asked, "{got} {asked}");
        }
        let said = fit.json(&points);
        assert!(said["r_squared"].as_f64().is_some_and(|r| r > 0.999_999));
        // At most objects and lights: 16.8 of 56.5 ms.
        let share = said["product_share"].as_f64().expect("a number");
        assert!((share - 16.777_216 / 56.545_216).abs() < 1e-9, "{share}");
    }

    #[test]
    fn a_sum_has_no_product_and_too_few_points_no_fit() {
        let points = points(|n, l| 5.0 + 0.01 * n + 0.02 * l);
        let said = Fit::of(&points).expect("a fit").json(&points);
        assert!(
            said["product_share"]
                .as_f64()
                .is_some_and(|share| share < 1e-9)
        );
        assert_eq!(Fit::of(&points[..3]), None);
    }
}
