//! Light that arrives.

use std::f64::consts::{FRAC_PI_2, PI};

use dolomite_light_oracle::quadrature::{gauss_legendre, integrate};
use dolomite_light_oracle::scene::{Lamp, LampKind};
use glam::DVec3;

use super::{candela, close, illuminance};

const FAR: f64 = f64::INFINITY;

#[test]
fn a_point_light_over_a_plane_is_i_cos_by_d_squared() {
    for (height, x, z) in [(1.0, 0.0, 0.0), (2.5, 1.0, -3.0), (0.1, 40.0, 7.0)] {
        let light = candela(DVec3::new(0.0, height, 0.0), FAR);
        let d2: f64 = height * height + x * x + z * z;
        let is = illuminance(light, DVec3::new(x, 0.0, z), DVec3::Y);
        close(is, height / (d2 * d2.sqrt()), 1e-14);
    }
}

#[test]
fn the_window_is_one_minus_the_fourth_power_squared() {
    let light = candela(DVec3::new(0.0, 2.0, 0.0), 5.0);
    for x in [0.0, 1.0, 3.0, 4.5] {
        let d2: f64 = 4.0 + x * x;
        let w = 1.0 - d2 * d2 / 625.0;
        let is = illuminance(light, DVec3::new(x, 0.0, 0.0), DVec3::Y);
        // 1 − (d / r)⁴ loses some bits near the range.
        close(is, 2.0 * w * w / (d2 * d2.sqrt()), 1e-14 / w);
    }
}

#[test]
fn at_the_range_and_beyond_there_is_exactly_nothing() {
    for range in [0.1, 1.0, 3.0, 7.3, 1e6] {
        let light = candela(DVec3::ZERO, range);
        for beyond in [1.0, 1.0 + f64::EPSILON, 1.5, 1e9] {
            let is = illuminance(light, DVec3::new(0.0, -range * beyond, 0.0), DVec3::Y);
            assert_eq!(is.to_bits(), 0.0_f64.to_bits(), "{range} {beyond}");
        }
        let within = illuminance(light, DVec3::new(0.0, -range * 0.999, 0.0), DVec3::Y);
        assert!(within > 0.0);
    }
}

#[test]
fn within_a_centimetre_the_square_is_that_of_a_centimetre() {
    for d in [0.01, 0.005, 1e-6] {
        let light = candela(DVec3::new(0.0, d, 0.0), FAR);
        close(illuminance(light, DVec3::ZERO, DVec3::Y), 1e4, 1e-13);
    }
    let light = candela(DVec3::ZERO, FAR);
    assert_eq!(illuminance(light, DVec3::ZERO, DVec3::Y), 0.0);
}

#[test]
fn a_disc_below_a_point_light_takes_half_of_one_minus_the_cosine_of_its_flux() {
    // Φ / 2 (1 − h / √(h² + R²)), by ∫ E 2πx dx.
    let (h, radius): (f64, f64) = (1.5, 4.0);
    let light = Lamp::new(800.0, point(DVec3::new(0.0, h, 0.0)));
    let flux = integrate(0.0, radius, 96, |x| {
        2.0 * PI * x * illuminance(light, DVec3::new(x, 0.0, 0.0), DVec3::Y)
    });
    close(flux, 400.0 * (1.0 - h / h.hypot(radius)), 1e-12);
}

#[test]
fn a_closed_surface_takes_all_of_the_flux() {
    // Gauss's law, for a light away from the middle of a sphere of radius 2.
    let light = Lamp::new(100.0, point(DVec3::new(0.0, 0.0, 0.7)));
    let flux: f64 = gauss_legendre(64)
        .iter()
        .map(|(z, w)| {
            let n = DVec3::new((1.0 - z * z).sqrt(), 0.0, *z);
            w * 2.0 * PI * 4.0 * illuminance(light, 2.0 * n, -n)
        })
        .sum();
    close(flux, 100.0, 1e-12);
}

#[test]
fn a_point_light_lights_the_cap_of_a_sphere_that_sees_it() {
    // E(θ) = I (D cos θ − R) / (D² + R² − 2 D R cos θ)^(3/2) where cos θ > R / D.
    let (radius, distance): (f64, f64) = (1.5, 4.0);
    let light = Lamp::new(4.0 * PI, point(DVec3::new(0.0, distance, 0.0)));
    let at = |cos: f64| {
        let n = DVec3::new((1.0 - cos * cos).sqrt(), cos, 0.0);
        illuminance(light, radius * n, n)
    };
    for cos in [1.0, 0.9, 0.5, 0.376] {
        let d2 = distance * distance + radius * radius - 2.0 * distance * radius * cos;
        let exact = (distance * cos - radius) / (d2 * d2.sqrt());
        // D cos θ − R cancels at the rim of the cap.
        close(
            at(cos),
            exact,
            1e-15 * distance / (distance * cos - radius) + 1e-14,
        );
    }
    for cos in [0.374, 0.0, -1.0] {
        assert_eq!(at(cos), 0.0);
    }
    // What the cap takes is what the cone of tangents holds: Φ / 2 (1 − √(1 − (R / D)²)).
    let rim = radius / distance;
    let flux = integrate(rim, 1.0, 64, |cos| 2.0 * PI * radius * radius * at(cos));
    close(flux, 2.0 * PI * (1.0 - (1.0 - rim * rim).sqrt()), 1e-12);
}

#[test]
fn a_directional_light_is_its_cosine() {
    for angle in [0.0, 0.4, 1.2, 1.57_f64] {
        let direction = 3.0 * DVec3::new(angle.sin(), -angle.cos(), 0.0);
        let sun = Lamp::new(100.0, LampKind::Directional { direction });
        let is = illuminance(sun, DVec3::new(5.0, 6.0, 7.0), DVec3::Y);
        close(is, 100.0 * angle.cos(), 1e-12);
        assert_eq!(illuminance(sun, DVec3::ZERO, DVec3::NEG_Y), 0.0);
    }
}

#[test]
fn a_hard_spot_light_is_a_point_light_within_its_cone_and_nothing_outside() {
    let (outer, height): (f64, f64) = (0.5, 2.0);
    let light = cone(height, outer, outer);
    let rim = height * outer.tan();
    // The ramp is 1e-4 wide in the cosine, and full at the inner angle.
    let wide = 1e-4 / outer.sin();
    for (x, lit) in [
        (0.0, true),
        (0.5 * rim, true),
        (rim * 1.0001, false),
        (9.0, false),
    ] {
        let is = illuminance(light, DVec3::new(x, 0.0, 0.0), DVec3::Y);
        if lit {
            close(is, height / height.hypot(x).powi(3), 1e-13);
        } else {
            assert_eq!(is, 0.0, "{x}");
        }
    }
    let x = height * (outer - 2.0 * wide).tan();
    let is = illuminance(light, DVec3::new(x, 0.0, 0.0), DVec3::Y);
    close(is, height / height.hypot(x).powi(3), 1e-13);
}

#[test]
fn a_spot_light_has_a_quarter_halfway_between_the_cosines_of_its_angles() {
    let (inner, outer): (f64, f64) = (0.3, 0.8);
    let light = cone(2.0, inner, outer);
    let angle = (0.5 * (inner.cos() + outer.cos())).acos();
    let x = 2.0 * angle.tan();
    let is = illuminance(light, DVec3::new(x, 0.0, 0.0), DVec3::Y);
    close(is, 0.25 * 2.0 / 2.0_f64.hypot(x).powi(3), 1e-13);
}

#[test]
fn the_flux_of_a_spot_light_is_that_of_its_ramp() {
    // I · 2π ((1 − cos inner) + (cos inner − cos outer) / 3), by E over a sphere about it.
    let (inner, outer): (f64, f64) = (0.3, 0.8);
    let light = cone(0.0, inner, outer);
    let at = |cos: f64| {
        let d = DVec3::new((1.0 - cos * cos).sqrt(), -cos, 0.0);
        2.0 * PI * 9.0 * illuminance(light, 3.0 * d, -d)
    };
    let flux = integrate(inner.cos(), 1.0, 8, at) + integrate(outer.cos(), inner.cos(), 8, at);
    let (ci, co) = (inner.cos(), outer.cos());
    close(flux, 2.0 * PI * ((1.0 - ci) + (ci - co) / 3.0), 1e-12);
}

#[test]
fn an_outer_angle_beyond_a_right_angle_is_just_below_it() {
    let (wide, right) = (cone(2.0, 0.1, 2.5), cone(2.0, 0.1, FRAC_PI_2 - 1e-4));
    for x in [0.0, 3.0, 100.0] {
        let at = DVec3::new(x, 0.0, 0.0);
        let is = illuminance(wide, at, DVec3::Y);
        assert!(is > 0.0);
        assert_eq!(is, illuminance(right, at, DVec3::Y));
    }
}

#[test]
fn an_inner_angle_is_kept_between_0_and_the_outer_one() {
    for (inner, kept) in [(-0.7, 0.0), (0.9, 0.6)] {
        let (is, good) = (cone(2.0, inner, 0.6), cone(2.0, kept, 0.6));
        for x in [0.0, 0.4, 1.0, 1.3, 2.0] {
            let at = DVec3::new(x, 0.0, 0.0);
            let exact = illuminance(good, at, DVec3::Y);
            assert_eq!(illuminance(is, at, DVec3::Y), exact, "{inner} {x}");
        }
    }
}

#[test]
fn a_sphere_in_the_sun_has_the_phases_of_lambert() {
    // ∫ (n·l)⁺ (n·v)⁺ dω = 2/3 (sin a + (π − a) cos a) for the phase angle a (Lambert, "Photometria", 1760).
    for a in [0.0, 0.5, FRAC_PI_2, 2.8_f64] {
        let (l, v) = (DVec3::new(a.sin(), 0.0, a.cos()), DVec3::Z);
        let sun = Lamp::new(1.0, LampKind::Directional { direction: -l });
        // The lit and seen lune is between the azimuths a − π/2 and π/2; the polar angle is about Y.
        let sum = integrate(a - FRAC_PI_2, FRAC_PI_2, 32, |azimuth| {
            integrate(0.0, PI, 32, |polar| {
                let (s, c) = azimuth.sin_cos();
                let n = DVec3::new(polar.sin() * s, polar.cos(), polar.sin() * c);
                illuminance(sun, n, n) * n.dot(v) * polar.sin()
            })
        });
        close(sum, 2.0 / 3.0 * (a.sin() + (PI - a) * a.cos()), 1e-11);
    }
}

fn point(position: DVec3) -> LampKind {
    LampKind::Point {
        position,
        range: FAR,
    }
}

/// A spot light of 1 candela that looks down.
fn cone(height: f64, inner: f64, outer: f64) -> Lamp {
    let kind = LampKind::Spot {
        position: DVec3::new(0.0, height, 0.0),
        range: FAR,
        direction: DVec3::NEG_Y,
        inner,
        outer,
    };
    Lamp::new(4.0 * PI, kind)
}
