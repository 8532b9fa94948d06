//! Phong's family (Phong 1975, Blinn 1977), normalised.
//!
//! ```text
//! f = c_d / π + c_s · N(m) · x^m
//! Blinn:  x = (n·h)⁺,   N(m) = (m + 2)(m + 4) / (8π (2^(−m/2) + m))          (Giesen 2009)
//! Phong:  x = (r·v)⁺,   N(m) = (m + 2) / 2π,   r = 2 (n·l) n − l             (Lafortune and Willems 1994)
//! ```
//!
//! With these factors a surface reflects exactly the share `c_s` of light from everywhere to an eye on its normal, and
//! less to any other, so `c_d + c_s ≤ 1` never gives light away.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use crate::scene::{BlinnPhong, Lobe};

/// `N(m)`.
pub fn normalisation(lobe: Lobe, exponent: f64) -> f64 {
    let m = exponent;
    match lobe {
        Lobe::Blinn => (m + 2.0) * (m + 4.0) / (8.0 * PI * ((-0.5 * m).exp2() + m)),
        Lobe::Phong => (m + 2.0) / (2.0 * PI),
    }
}

/// Such a material at a point, seen from a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    n: DVec3,
    v: DVec3,
    diffuse: DVec3,
    specular: DVec3,
    exponent: f64,
    lobe: Lobe,
    ambient: DVec3,
}

impl Response {
    /// `n` and `v` are unit vectors. An exponent below 0 is 0.
    pub fn new(m: &BlinnPhong, n: DVec3, v: DVec3) -> Self {
        let exponent = m.exponent.max(0.0);
        Self {
            n,
            v,
            diffuse: m.diffuse * FRAC_1_PI,
            specular: m.specular * normalisation(m.lobe, exponent),
            exponent,
            lobe: m.lobe,
            ambient: m.diffuse,
        }
    }

    /// `f (n·l)⁺`.
    pub fn reflected(&self, l: DVec3) -> DVec3 {
        let n_l = self.n.dot(l);
        if n_l <= 0.0 {
            return DVec3::ZERO;
        }
        let x = match self.lobe {
            Lobe::Blinn => (l + self.v).try_normalize().map_or(0.0, |h| self.n.dot(h)),
            Lobe::Phong => (2.0 * n_l * self.n - l).dot(self.v),
        };
        // The highlight belongs to the side of the surface that the eye is on.
        let lobe = if x > 0.0 && self.n.dot(self.v) > 0.0 {
            x.min(1.0).powf(self.exponent)
        } else {
            0.0
        };
        n_l * (self.diffuse + self.specular * lobe)
    }

    /// The diffuse albedo: these models have no term for the mirror image of light from everywhere.
    pub fn ambient(&self) -> DVec3 {
        self.ambient
    }
}
