//! Rough surfaces as mirrors too small to see: how many face a direction (Walter et al. 2007), and how many of those are
//! neither shadowed nor hidden (Heitz 2014).

use std::f64::consts::FRAC_1_PI;

/// `D`, of the cosine and the squared sine between the normal and the half vector. Its integral over the hemisphere,
/// weighted by the cosine, is 1.
pub fn ggx(alpha: f64, cos: f64, sin_squared: f64) -> f64 {
    let a2 = alpha * alpha;
    let s = sin_squared + a2 * cos * cos;
    FRAC_1_PI * a2 / (s * s)
}

/// `V`, of the cosines between the normal and the eye, and the normal and the light.
pub fn smith(alpha: f64, n_v: f64, n_l: f64) -> f64 {
    let a2 = alpha * alpha;
    let lambda = |c: f64| (c * c * (1.0 - a2) + a2).sqrt();
    0.5 / (n_l * lambda(n_v) + n_v * lambda(n_l))
}
