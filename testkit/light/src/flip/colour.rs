//! Colour spaces. Linear RGB has the primaries of Rec. 709.

use glam::{DMat3, DVec3};

/// CIE XYZ of white, to the digits that FLIP gives.
pub const WHITE: DVec3 = DVec3::new(0.950_428_545, 1.0, 1.088_900_371);

/// The matrices between linear RGB and XYZ over [`WHITE`].
#[derive(Debug, Clone, Copy)]
pub struct Spaces {
    to_xyz: DMat3,
    from_xyz: DMat3,
}

impl Spaces {
    /// From the chromaticities of Rec. 709: R (0.64, 0.33), G (0.30, 0.60), B (0.15, 0.06). Each primary is scaled so that
    /// their sum is white.
    pub fn new() -> Self {
        let primary = |x: f64, y: f64| DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
        let columns = DMat3::from_cols(
            primary(0.64, 0.33),
            primary(0.30, 0.60),
            primary(0.15, 0.06),
        );
        let to_xyz = columns * DMat3::from_diagonal(columns.inverse() * WHITE);
        // Divided by white, so that (1, 1, 1) becomes (1, 1, 1).
        let to_xyz = DMat3::from_diagonal(WHITE.recip()) * to_xyz;
        Self {
            to_xyz,
            from_xyz: to_xyz.inverse(),
        }
    }

    /// The opponent space `Y Cx Cz`: `116 Y − 16`, `500 (X − Y)`, `200 (Y − Z)` of XYZ over white.
    pub fn opponent(&self, rgb: DVec3) -> DVec3 {
        let xyz = self.to_xyz * rgb;
        DVec3::new(
            116.0 * xyz.y - 16.0,
            500.0 * (xyz.x - xyz.y),
            200.0 * (xyz.y - xyz.z),
        )
    }

    /// Back.
    pub fn linear_of(&self, ycc: DVec3) -> DVec3 {
        let y = (ycc.x + 16.0) / 116.0;
        self.from_xyz * DVec3::new(y + ycc.y / 500.0, y, y - ycc.z / 200.0)
    }

    /// CIE L*a*b*, with a and b times L/100: Hunt's effect, that colours are weaker in the dark.
    pub fn hunt_lab(&self, rgb: DVec3) -> DVec3 {
        let xyz = self.to_xyz * rgb;
        let d: f64 = 6.0 / 29.0;
        let f = |t: f64| {
            if t > d * d * d {
                t.cbrt()
            } else {
                t / (3.0 * d * d) + 4.0 / 29.0
            }
        };
        let (x, y, z) = (f(xyz.x), f(xyz.y), f(xyz.z));
        let l = 116.0 * y - 16.0;
        DVec3::new(l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z))
    }
}

/// HyAB (Abasi et al. 2020): city blocks in lightness, Euclidean in the two others.
pub fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_no_colour_and_the_way_back_is_the_same() {
        let spaces = Spaces::new();
        let white = spaces.opponent(DVec3::ONE);
        assert!((white - DVec3::new(100.0, 0.0, 0.0)).abs().max_element() < 1e-12);
        let lab = spaces.hunt_lab(DVec3::splat(0.2));
        assert!(lab.y.abs() < 1e-12 && lab.z.abs() < 1e-12);
        // L* of 20 % grey: 116 ∛0.2 − 16.
        assert!((lab.x - (116.0 * 0.2_f64.cbrt() - 16.0)).abs() < 1e-12);
        let rgb = DVec3::new(0.1, 0.7, 0.3);
        let back = spaces.linear_of(spaces.opponent(rgb));
        assert!((back - rgb).abs().max_element() < 1e-14);
    }
}
