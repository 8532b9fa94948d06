//! `StandardMaterial` as Bevy 0.19 documents it: the equations of Filament (Guy and Agopian, "Physically based rendering
//! in Filament", 2018), in f64.
//!
//! ```text
//! α     = clamp(perceptual roughness, 0.089, 1)²
//! f     = f_d + f_r · k
//! f_d   = c_d / π · (1 + (f₉₀ − 1)(1 − n·l)⁵) (1 + (f₉₀ − 1)(1 − n·v)⁵),   f₉₀ = ½ + 2 α (l·h)²         (Burley 2012)
//! f_r   = D V F
//! D     = α² / (π ((n·h)² (α² − 1) + 1)²)                                                        (Walter et al. 2007)
//! V     = ½ / ((n·l) √((n·v)² (1 − α²) + α²) + (n·v) √((n·l)² (1 − α²) + α²))                      (Heitz 2014)
//! F     = F₀ + (F₉₀ − F₀)(1 − l·h)⁵,   F₉₀ = min(50 · 0.33 · (F₀.r + F₀.g + F₀.b), 1)            (Schlick 1994)
//! k     = 1 + F₀ (1/E − 1)            light that is reflected more than once; E: reflected share for F₀ = 1
//! c_d   = base colour · (1 − metallic)
//! F₀    = 0.16 reflectance² · (1 − metallic) + base colour · metallic
//! ```
//!
//! As in Bevy, `n·v` is at least 10⁻⁴ and the other cosines are cut to 0..1. `f₉₀` takes α where Burley took the
//! perceptual roughness. The only difference is in `D`, where `1 − (n·h)²` is `|n × h|²`, so that nothing cancels.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::microfacets::{ggx, smith};
use super::{SplitSum, directional_albedo};
use crate::scene::Standard;

/// The least perceptual roughness.
pub const LEAST_ROUGHNESS: f64 = 0.089;

/// The least cosine between normal and eye.
pub const LEAST_COSINE: f64 = 1e-4;

/// α of the perceptual roughness.
pub fn alpha(perceptual_roughness: f64) -> f64 {
    let clamped = perceptual_roughness.clamp(LEAST_ROUGHNESS, 1.0);
    clamped * clamped
}

/// Reflectance at normal incidence.
pub fn f0(base_colour: DVec3, metallic: f64, reflectance: f64) -> DVec3 {
    DVec3::splat(0.16 * reflectance * reflectance).lerp(base_colour, metallic)
}

/// Reflectance at grazing incidence.
pub fn f90(f0: DVec3) -> f64 {
    (50.0 * 0.33 * f0.element_sum()).clamp(0.0, 1.0)
}

/// `F`, of the cosine between the light and the half vector.
pub fn schlick(f0: DVec3, f90: f64, cos: f64) -> DVec3 {
    f0 + (f90 - f0) * (1.0 - cos).powi(5)
}

/// Burley's diffuse term without the colour.
pub fn burley(alpha: f64, n_v: f64, n_l: f64, l_h: f64) -> f64 {
    let f90 = 0.5 + 2.0 * alpha * l_h * l_h;
    let scatter = |c: f64| 1.0 + (f90 - 1.0) * (1.0 - c).powi(5);
    FRAC_1_PI * scatter(n_l) * scatter(n_v)
}

/// The polynomial of Karis, "Physically based shading on mobile" (2014): `[A, B]`, of which a surface with `F₀` reflects
/// the share `F₀ A + B` of light from everywhere. Not below 5·10⁻⁵, as in Bevy.
pub fn karis(perceptual_roughness: f64, n_v: f64) -> [f64; 2] {
    let r = perceptual_roughness;
    let [x, y, z, w] = [
        1.0 - r,
        0.0425 - 0.0275 * r,
        1.04 - 0.572 * r,
        -0.04 + 0.022 * r,
    ];
    let a004 = (x * x).min((-9.28 * n_v).exp2()) * x + y;
    [-1.04 * a004 + z, 1.04 * a004 + w].map(|x| x.max(5e-5))
}

/// A standard material at a point, seen from a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    n: DVec3,
    v: DVec3,
    n_v: f64,
    alpha: f64,
    diffuse: DVec3,
    f0: DVec3,
    f90: f64,
    /// `k` of the module.
    again: DVec3,
    /// `[A, B]` for this roughness, and for roughness 1.
    split: [[f64; 2]; 2],
}

impl Response {
    /// `n` and `v` are unit vectors.
    pub fn new(m: &Standard, n: DVec3, v: DVec3, split_sum: SplitSum) -> Self {
        let n_v = n.dot(v).max(LEAST_COSINE);
        let split = [m.perceptual_roughness, 1.0].map(|roughness| match split_sum {
            SplitSum::Karis => karis(roughness, n_v),
            SplitSum::Integral => directional_albedo::split_sum(alpha(roughness), n_v),
        });
        let f0 = f0(m.base_colour, m.metallic, m.reflectance);
        let reflected = split[0][0] + split[0][1];
        Self {
            n,
            v,
            n_v,
            alpha: alpha(m.perceptual_roughness),
            diffuse: m.base_colour * (1.0 - m.metallic),
            f0,
            f90: f90(f0),
            again: 1.0 + f0 * (1.0 / reflected - 1.0),
            split,
        }
    }

    /// `f (n·l)⁺`.
    pub fn reflected(&self, l: DVec3) -> DVec3 {
        let n_l = self.n.dot(l).min(1.0);
        let sum = l + self.v;
        // The eye looks exactly along the light: it is on the far side of the surface, and there is no half vector.
        if n_l <= 0.0 || sum == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let h = sum.normalize();
        let n_h = self.n.dot(h);
        let (n_h, sin_squared) = if n_h > 0.0 {
            (n_h, self.n.cross(h).length_squared())
        } else {
            (0.0, 1.0)
        };
        let l_h = l.dot(h).clamp(0.0, 1.0);
        let specular = ggx(self.alpha, n_h, sin_squared)
            * smith(self.alpha, self.n_v, n_l)
            * schlick(self.f0, self.f90, l_h)
            * self.again;
        n_l * (self.diffuse * burley(self.alpha, self.n_v, n_l, l_h) + specular)
    }

    /// What leaves for light of luminance 1 from everywhere, as Bevy has it: `c_d A(1) + B(1) + F₉₀ (F₀ A + B)`, where
    /// `A(1)` and `B(1)` are those of a surface of roughness 1.
    pub fn ambient(&self) -> DVec3 {
        let [[a, b], [a1, b1]] = self.split;
        self.diffuse * a1 + b1 + self.f90 * (self.f0 * a + b)
    }
}
