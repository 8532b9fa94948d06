//! From degrees to metres, for elevation data on a geographic grid.

/// Length of one degree of longitude and of latitude on the WGS 84 ellipsoid, metres, at a
/// latitude in degrees (−90..=90).
///
/// Series in multiples of the latitude φ, error below 1 cm (J. Snyder, "Map Projections: A Working
/// Manual", USGS 1987, after eqs. 4-18 to 4-21, with the constants of WGS 84):
/// longitude 111412.84 cos φ − 93.5 cos 3φ + 0.118 cos 5φ,
/// latitude 111132.92 − 559.82 cos 2φ + 1.175 cos 4φ − 0.0023 cos 6φ.
#[must_use]
pub fn metres_per_degree(latitude: f64) -> [f64; 2] {
    let cos = |multiple: f64| cosine(multiple * latitude.to_radians());
    [
        111_412.84 * cos(1.0) - 93.5 * cos(3.0) + 0.118 * cos(5.0),
        111_132.92 - 559.82 * cos(2.0) + 1.175 * cos(4.0) - 0.0023 * cos(6.0),
    ]
}

/// Metres of the ground for a metre of the map in spherical Mercator, `y` metres north of the equator:
/// cos φ = 1 / cosh(y / R), R = 6 378 137 m (Snyder 1987, eq. 7-4). Against lengths on the ellipsoid it is off
/// by up to 0.7 %, along y at the equator.
pub(crate) fn mercator_shrink(y: f64) -> f64 {
    1.0 / hyperbolic_cosine((y / 6_378_137.0).clamp(-4.0, 4.0))
}

/// cosh x for |x| ≤ 4, relative error below 1e-13: Taylor series of cosh a − 1 at x / 16, then
/// cosh 2a − 1 = 2v(v + 2) of v = cosh a − 1.
fn hyperbolic_cosine(x: f64) -> f64 {
    let a = x / 16.0;
    let a2 = a * a;
    let mut v = 0.0;
    for k in [6.0, 5.0, 4.0, 3.0, 2.0, 1.0_f64] {
        v = a2 / ((2.0 * k) * (2.0 * k - 1.0)) * (1.0 + v);
    }
    for _ in 0..4 {
        v = 2.0 * v * (v + 2.0);
    }
    1.0 + v
}

/// cos x for |x| < 10, absolute error below 1e-13: the argument is halved four times, then the
/// Taylor series to x¹², then cos 2a = 2 cos² a − 1. The same bits on every platform, unlike the
/// system's own.
fn cosine(x: f64) -> f64 {
    let a = x / 16.0;
    let a2 = a * a;
    // 1 − cos a, so that doubling does not lose the small difference: v → 2v(2 − v).
    let mut versine = 0.0;
    for k in [6.0, 5.0, 4.0, 3.0, 2.0, 1.0_f64] {
        versine = a2 / ((2.0 * k) * (2.0 * k - 1.0)) * (1.0 - versine);
    }
    for _ in 0..4 {
        versine = 2.0 * versine * (2.0 - versine);
    }
    1.0 - versine
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_cosines() {
        for (degrees, expected) in [
            (0.0, 1.0),
            (60.0, 0.5),
            (90.0, 0.0),
            (180.0, -1.0),
            (540.0, -1.0),
        ] {
            assert!(
                (cosine(f64::to_radians(degrees)) - expected).abs() < 1e-12,
                "{degrees}"
            );
        }
        // cosh(ln 2) = 5/4, cosh(ln 16) = 257/32.
        let ln2 = std::f64::consts::LN_2;
        for (x, expected) in [
            (0.0, 1.0),
            (ln2, 1.25),
            (-ln2, 1.25),
            (4.0 * ln2, 257.0 / 32.0),
        ] {
            assert!((hyperbolic_cosine(x) / expected - 1.0).abs() < 1e-12, "{x}");
        }
    }

    #[test]
    fn known_degrees() {
        // WGS 84: one degree of longitude at the equator is 2πa/360 = 111319.49 m; one of latitude
        // at the equator 110574.3 m, at the pole 111693.9 m.
        let equator = metres_per_degree(0.0);
        assert!((equator[0] - 111_319.49).abs() < 0.1 && (equator[1] - 110_574.3).abs() < 0.2);
        let pole = metres_per_degree(90.0);
        assert!(pole[0].abs() < 1e-6 && (pole[1] - 111_693.9).abs() < 0.2);
    }
}
