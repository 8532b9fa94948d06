//! Which share of the light from everywhere a rough surface reflects to one direction.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

use super::microfacets::{ggx, smith};
use crate::quadrature::{gauss_legendre, integrate};

/// Points of each part of the two integrals: right to 1e-12 for an eye whose cosine is 0.01 or more, to 4e-10 at the least
/// roughness, and to 1e-6 at the least cosine (measured against the closed form at α = 1 and the white furnace).
const POINTS: usize = 48;

static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(POINTS));

/// `[A, B]` of the split sum (Karis 2013): a surface with the microfacets of [`super::microfacets`] and Fresnel's term
/// `F₀ + (1 − F₀)(1 − l·h)⁵` reflects the share `F₀ A + B` of light from everywhere to an eye at the cosine `n_v`.
///
/// ```text
/// A = ∫ D V (n·l) (1 − (1 − l·h)⁵) dl,     B = ∫ D V (n·l) (1 − l·h)⁵ dl
/// ```
///
/// The integral over `l` is taken over the half vector, `dl = 4 (l·h) dh`, and over `tan θ_h = α tan s`, which makes the
/// distribution `D (n·h) dh` flat in `sin² s`; beyond the angle whose tangent is `√α`, where the distribution has
/// become a power, over the logarithm of the tangent. It is cut where the reflected light begins to go below the
/// surface, at the angles (π/2 ∓ θ_v) / 2 of `h`, and between them the azimuth ends where it does.
pub fn split_sum(alpha: f64, n_v: f64) -> [f64; 2] {
    let eye = n_v.clamp(0.0, 1.0).acos();
    let (first, last) = (0.5 * (FRAC_PI_2 - eye), 0.5 * (FRAC_PI_2 + eye));
    let middle = alpha.sqrt().atan().min(first);
    let (from, to) = (middle.tan().ln(), first.tan().ln());
    let end = (middle.tan() / alpha).atan();
    let mut sum = [0.0; 2];
    // D (n·h) dh = p dφ / 2π.
    let mut add = |theta: f64, p: f64| {
        let [a, b] = ring(alpha, eye, theta);
        sum[0] += p * a;
        sum[1] += p * b;
    };
    // d(sin² s) / dθ.
    let density = |theta: f64| {
        let (sin, cos) = theta.sin_cos();
        let d = alpha * alpha * cos * cos + sin * sin;
        2.0 * alpha * alpha * sin * cos / (d * d)
    };
    for (x, w) in RULE.iter() {
        let s = 0.5 * end * (x + 1.0);
        add((alpha * s.tan()).atan(), w * 0.5 * end * (2.0 * s).sin());
        if to > from {
            let theta = (from + 0.5 * (to - from) * (x + 1.0)).exp().atan();
            let slope = theta.sin() * theta.cos();
            add(theta, w * 0.5 * (to - from) * slope * density(theta));
        }
        // Beyond the first angle the azimuths end as a square root does, at both ends: a squared sine takes that away.
        let (sin, cos) = (0.25 * PI * (x + 1.0)).sin_cos();
        let theta = first + (last - first) * sin * sin;
        add(
            theta,
            w * (last - first) * 0.5 * PI * sin * cos * density(theta),
        );
    }
    sum
}

/// The mean over the azimuths of the half vector at one polar angle, of what `D (n·h)` is a factor of.
fn ring(alpha: f64, eye: f64, theta: f64) -> [f64; 2] {
    let (sin, cos) = theta.sin_cos();
    let (sin_v, cos_v) = eye.sin_cos();
    // n·l = 2 (v·h)(n·h) − n·v is above 0 where the cosine of the azimuth exceeds this.
    let least = cos_v * (0.5 / cos - cos) / (sin_v * sin);
    let end = if least.is_nan() {
        PI
    } else {
        least.clamp(-1.0, 1.0).acos()
    };
    let (mut a, mut b) = (0.0, 0.0);
    for (x, w) in RULE.iter() {
        let azimuth = 0.5 * end * (x + 1.0);
        let v_h = sin_v * sin * azimuth.cos() + cos_v * cos;
        let n_l = 2.0 * v_h * cos - cos_v;
        if v_h <= 0.0 || n_l <= 0.0 {
            continue;
        }
        let value = 4.0 * smith(alpha, cos_v, n_l) * n_l * v_h / cos;
        let fresnel = (1.0 - v_h).max(0.0).powi(5);
        // Half of the azimuths stand for all.
        let weight = w * 0.5 * end / PI;
        a += weight * value * (1.0 - fresnel);
        b += weight * value * fresnel;
    }
    [a, b]
}

/// ∫ D (n·h) dh over the hemisphere, by the substitution of [`split_sum`]: 1 for each roughness.
pub fn distribution_integral(alpha: f64) -> f64 {
    integrate(0.0, 1.0, 32, |x| {
        let tan_squared = alpha * alpha * x / (1.0 - x);
        let cos_squared = (1.0 + tan_squared).recip();
        let sin_squared = tan_squared * cos_squared;
        // dh = 2π sinθ dθ and d(tan²θ) = 2 tanθ / cos²θ dθ, so (n·h) dh = π cos⁴θ d(tan²θ).
        let slope = alpha * alpha / ((1.0 - x) * (1.0 - x));
        ggx(alpha, cos_squared.sqrt(), sin_squared) * PI * cos_squared * cos_squared * slope
    })
}
