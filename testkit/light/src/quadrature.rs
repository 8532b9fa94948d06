//! Integrals of smooth functions.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// Nodes and weights of the Gauss-Legendre rule with `n` points on −1..1, exact for polynomials of degree `2n − 1`.
/// Newton's method on the Legendre polynomial from Tricomi's first guess (Abramowitz and Stegun 22.16.6); each node and
/// weight is right to some 1e-15.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let count = n as f64;
    let node = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (count + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..100 {
            // (k + 1) P_{k+1} = (2k + 1) x P_k − k P_{k−1}.
            let (mut p, mut before) = (1.0, 0.0);
            for k in 0..n {
                let k = k as f64;
                (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
            }
            slope = count * (x * p - before) / (x * x - 1.0);
            let step = p / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(node).collect()
}

/// ∫ `f` from `a` to `b` by `n` Gauss-Legendre points.
pub fn integrate(a: f64, b: f64, n: usize, f: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let sum: f64 = gauss_legendre(n)
        .iter()
        .map(|(x, w)| w * f(middle + half * x))
        .sum();
    half * sum
}

/// ∫ f(l) dω over the hemisphere about +Z: Gauss-Legendre in the polar angle, whose cosine is `cos θ`, and the trapezium
/// rule in the azimuth, which converges as fast for a periodic function.
pub fn hemisphere(polar: usize, azimuths: usize, f: impl Fn(DVec3) -> DVec3) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for (x, w) in gauss_legendre(polar) {
        let (sin, cos) = (0.25 * PI * (x + 1.0)).sin_cos();
        let ring: DVec3 = (0..azimuths)
            .map(|k| {
                let (s, c) = (TAU * (k as f64 + 0.5) / azimuths as f64).sin_cos();
                f(DVec3::new(sin * c, sin * s, cos))
            })
            .sum();
        sum += w * 0.25 * PI * sin * (TAU / azimuths as f64) * ring;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_of_n_points_is_exact_to_degree_2n_minus_1() {
        for n in [1, 2, 5, 16, 64] {
            let degree = 2 * n - 1;
            let integral = integrate(0.0, 1.0, n, |x| {
                x.powi(degree as i32) + x.powi(degree as i32 - 1)
            });
            let exact = 1.0 / (degree as f64 + 1.0) + 1.0 / degree as f64;
            assert!((integral / exact - 1.0).abs() < 1e-13, "{n}: {integral}");
            // One degree more is not exact for the small rules.
            if n <= 5 {
                let integral = integrate(0.0, 1.0, n, |x| x.powi(degree as i32 + 1));
                assert!((integral * (degree as f64 + 2.0) - 1.0).abs() > 1e-8);
            }
        }
    }

    #[test]
    fn the_hemisphere_has_2_pi_and_its_cosine_pi() {
        let all = hemisphere(32, 8, |l| DVec3::new(1.0, l.z, l.x * l.x));
        let exact = DVec3::new(TAU, PI, TAU / 3.0);
        assert!((all / exact - 1.0).abs().max_element() < 1e-13, "{all}");
    }
}
