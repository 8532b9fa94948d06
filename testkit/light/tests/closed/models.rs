//! Light that leaves.

use std::f64::consts::{PI, TAU};

use dolomite_light_oracle::model::directional_albedo::{distribution_integral, split_sum};
use dolomite_light_oracle::model::{Response, SplitSum, blinn_phong, microfacets, standard};
use dolomite_light_oracle::quadrature::{hemisphere, integrate};
use dolomite_light_oracle::random::Random;
use dolomite_light_oracle::scene::{BlinnPhong, Lobe, Material, Standard};
use glam::DVec3;

use super::{WHITE, close};

/// A unit vector whose cosine with +Z is given.
fn tilted(cos: f64) -> DVec3 {
    DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
}

fn metal(perceptual_roughness: f64) -> Standard {
    Standard {
        metallic: 1.0,
        perceptual_roughness,
        ..Standard::default()
    }
}

/// ∫ f (n·l) dl for an eye on the normal; the model depends on the polar angle alone.
fn head_on(material: &Material, nodes: usize) -> f64 {
    let response = Response::new(material, DVec3::Z, DVec3::Z, SplitSum::Karis);
    integrate(0.0, 0.5 * PI, nodes, |angle| {
        TAU * angle.sin() * response.reflected(tilted(angle.cos())).x
    })
}

#[test]
fn a_white_lambertian_surface_gives_back_all() {
    for cos in [1.0, 0.5, 0.01] {
        let response = Response::new(&WHITE, DVec3::Z, tilted(cos), SplitSum::Karis);
        let all = hemisphere(16, 4, |l| response.reflected(l));
        close(all.x, 1.0, 1e-13);
    }
}

#[test]
fn the_distribution_of_microfacets_has_the_projected_area_of_its_surface() {
    for alpha in [standard::alpha(0.0), 0.05, 0.3, 1.0] {
        close(distribution_integral(alpha), 1.0, 1e-12);
    }
}

#[test]
fn masked_microfacets_have_the_projected_area_that_is_seen() {
    // Heitz 2014: V = 1 / (4 (n·l)(n·v)(1 + Λ(l) + Λ(v))) with Λ = (√(1 + α² tan²) − 1) / 2.
    let lambda = |alpha: f64, cos: f64| {
        let tan_squared = (1.0 - cos * cos) / (cos * cos);
        0.5 * ((1.0 + alpha * alpha * tan_squared).sqrt() - 1.0)
    };
    for (alpha, n_v, n_l) in [
        (0.1, 0.3, 0.9),
        (0.5, 0.8, 0.2),
        (1.0, 0.5, 0.6),
        (0.3, 1.0, 0.1),
    ] {
        let masked = 1.0 + lambda(alpha, n_v) + lambda(alpha, n_l);
        let exact = 1.0 / (4.0 * n_v * n_l * masked);
        close(microfacets::smith(alpha, n_v, n_l), exact, 1e-14);
    }
    // Those that an eye sees are, projected, the surface: G₁(v) ∫ D (v·h)⁺ dh = n·v, where G₁ is 4 (n·v) V for a light on
    // the normal, which nothing shadows.
    for (alpha, n_v) in [(0.5, 0.9), (0.7, 0.6), (1.0, 0.3)] {
        let v = tilted(n_v);
        let seen = hemisphere(256, 256, |h| {
            let sin_squared = h.x * h.x + h.y * h.y;
            DVec3::splat(microfacets::ggx(alpha, h.z, sin_squared) * v.dot(h).max(0.0))
        });
        let g1 = 4.0 * n_v * microfacets::smith(alpha, n_v, 1.0);
        // The end of (v·h)⁺ goes across the points of the quadrature.
        close(g1 * seen.x, n_v, 1e-5);
    }
}

#[test]
fn the_directional_albedo_at_roughness_1_is_an_elementary_function() {
    // α = 1: D = 1/π, V = ½ / (n·l + n·v), and so A + B = 1 − c ln(1 + 1/c) with c = n·v.
    for c in [1e-4, 0.01, 0.1, 0.4, 0.9, 1.0_f64] {
        let exact = 1.0 - c * (1.0 + 1.0 / c).ln();
        let [a, b] = split_sum(1.0, c);
        // At grazing incidence V grows without bound.
        close(a + b, exact, if c < 0.01 { 1e-6 } else { 1e-12 });
        // The same by the directions of the light: 1/π · ½ c_l / (c_l + c) · 2π.
        let smooth = integrate(0.0, 1.0, 256, |x| {
            let n_l = x * x * x;
            let f = microfacets::ggx(1.0, 0.5, 0.75) * microfacets::smith(1.0, c, n_l);
            TAU * f * n_l * 3.0 * x * x
        });
        close(smooth, exact, 1e-12);
    }
}

#[test]
fn a_white_metal_that_reflects_more_than_once_gives_back_all() {
    // The white furnace: F₀ = 1, so k = 1/E. The integral over the directions of the light knows nothing of the one over
    // half vectors that E is taken from. With Bevy's polynomial the furnace is off by that polynomial's error.
    let mut polynomial: f64 = 0.0;
    for roughness in [0.3, 0.5, 0.7, 1.0] {
        for cos in [1.0, 0.7, 0.3] {
            let furnace = |split| {
                let m = Material::Standard(metal(roughness));
                let response = Response::new(&m, DVec3::Z, tilted(cos), split);
                hemisphere(512, 512, |l| response.reflected(l)).x
            };
            // A smooth metal's mirror image of a low eye is too sharp for these 512² directions.
            let bound = if roughness * cos < 0.1 { 1e-10 } else { 1e-12 };
            close(furnace(SplitSum::Integral), 1.0, bound);
            polynomial = polynomial.max((furnace(SplitSum::Karis) - 1.0).abs());
        }
    }
    // At roughness 1, seen from above.
    assert!((0.32..0.33).contains(&polynomial), "{polynomial}");
}

#[test]
fn burleys_diffuse_albedo_seen_from_above_is_linear_in_alpha() {
    // 2 ∫ c (1 + (α (1 + c) − ½)(1 − c)⁵) dc = 1 + (5 α − 2) / 84, and c_d = 1 with a reflectance of 0.
    for roughness in [0.1, 0.4, 0.8, 1.0] {
        let material = Material::Standard(Standard {
            perceptual_roughness: roughness,
            reflectance: 0.0,
            ..Standard::default()
        });
        let alpha = roughness * roughness;
        close(
            head_on(&material, 32),
            1.0 + (5.0 * alpha - 2.0) / 84.0,
            1e-12,
        );
    }
}

#[test]
fn glass_reflects_four_per_cent() {
    // ((n − 1) / (n + 1))² for n = 1.5.
    let f0 = standard::f0(DVec3::ZERO, 0.0, 0.5);
    close(f0.x, (0.5_f64 / 2.5).powi(2), 1e-15);
    assert_eq!(standard::f90(f0), 1.0);
    assert_eq!(standard::schlick(f0, 1.0, 1.0), f0);
    assert_eq!(standard::schlick(f0, 1.0, 0.0), DVec3::ONE);
    // Below F₀ = 2/99 in the mean of the channels the rim is darker.
    close(standard::f90(DVec3::splat(0.01)), 0.495, 1e-15);
}

#[test]
fn head_on_a_standard_material_is_its_peak() {
    // n = v = l: f = c_d / π + k F₀ / (4 π α²).
    let m = Standard {
        base_colour: DVec3::new(0.8, 0.4, 0.1),
        metallic: 0.25,
        perceptual_roughness: 0.4,
        reflectance: 0.7,
        ..Standard::default()
    };
    let response = Response::new(&Material::Standard(m), DVec3::Z, DVec3::Z, SplitSum::Karis);
    let [a, b] = standard::karis(0.4, 1.0);
    let f = response.reflected(DVec3::Z);
    for channel in 0..3 {
        let base = m.base_colour[channel];
        let f0 = 0.75 * 0.16 * 0.49 + 0.25 * base;
        let k = 1.0 + f0 * (1.0 / (a + b) - 1.0);
        let alpha: f64 = 0.16;
        let exact = 0.75 * base / PI + k * f0 / (4.0 * PI * alpha * alpha);
        close(f[channel], exact, 1e-13);
    }
}

#[test]
fn at_60_degrees_a_standard_material_has_known_values() {
    // n·l = n·v = ½, so V = 1 / √(1 + 3 α²). In the mirror's direction n·h = 1 and l·h = ½; back to the light n·h = ½ and
    // l·h = 1.
    let m = Standard {
        base_colour: DVec3::new(0.8, 0.4, 0.1),
        metallic: 0.25,
        perceptual_roughness: 0.6,
        reflectance: 0.7,
        ..Standard::default()
    };
    let alpha: f64 = 0.36;
    let a2 = alpha * alpha;
    let [a, b] = standard::karis(0.6, 0.5);
    let (l, mirrored) = (tilted(0.5), tilted(0.5) * DVec3::new(-1.0, 1.0, 1.0));
    for channel in 0..3 {
        let base = m.base_colour[channel];
        let f0 = 0.75 * 0.16 * 0.49 + 0.25 * base;
        let k = 1.0 + f0 * (1.0 / (a + b) - 1.0);
        let exact = |d: f64, fresnel: f64, f90: f64| {
            let scatter = 1.0 + (f90 - 1.0) / 32.0;
            let diffuse = 0.75 * base / PI * scatter * scatter;
            0.5 * (diffuse + k * d * fresnel / (1.0 + 3.0 * a2).sqrt())
        };
        let is = |v: DVec3| {
            let response = Response::new(&Material::Standard(m), DVec3::Z, v, SplitSum::Karis);
            response.reflected(l)[channel]
        };
        let fresnel = f0 + (1.0 - f0) / 32.0;
        close(
            is(mirrored),
            exact(1.0 / (PI * a2), fresnel, 0.5 + 0.5 * alpha),
            1e-13,
        );
        let d = a2 / (PI * (0.75 + 0.25 * a2).powi(2));
        close(is(l), exact(d, f0, 0.5 + 2.0 * alpha), 1e-13);
    }
}

#[test]
fn at_60_degrees_blinn_and_phong_have_known_values() {
    // Mirrored: n·h = r·v = 1. On the normal: n·h = cos 30°, r·v = ½.
    for (lobe, exponent) in [(Lobe::Blinn, 20.0), (Lobe::Phong, 5.0)] {
        let material = Material::BlinnPhong(BlinnPhong {
            diffuse: DVec3::splat(0.3),
            specular: DVec3::splat(0.2),
            exponent,
            lobe,
            ..BlinnPhong::default()
        });
        let normal = match lobe {
            Lobe::Blinn => 22.0 * 24.0 / (8.0 * PI * (2.0_f64.powi(-10) + 20.0)),
            Lobe::Phong => 7.0 / (2.0 * PI),
        };
        let is = |v: DVec3| {
            let response = Response::new(&material, DVec3::Z, v, SplitSum::Karis);
            response.reflected(tilted(0.5)).x
        };
        let mirrored = tilted(0.5) * DVec3::new(-1.0, 1.0, 1.0);
        close(is(mirrored), 0.5 * (0.3 / PI + 0.2 * normal), 1e-13);
        let x = match lobe {
            Lobe::Blinn => 0.75_f64.powi(10),
            Lobe::Phong => 0.5_f64.powi(5),
        };
        close(is(DVec3::Z), 0.5 * (0.3 / PI + 0.2 * normal * x), 1e-13);
        // The eye and the light on two sides: no highlight.
        let below = Response::new(&material, DVec3::Z, DVec3::NEG_Z, SplitSum::Karis);
        close(below.reflected(DVec3::Z).x, 0.3 / PI, 1e-13);
        assert_eq!(below.reflected(DVec3::NEG_Z), DVec3::ZERO);
    }
}

#[test]
fn karis_polynomial_at_roughness_1_has_known_values() {
    // r = (0, 0.015, 0.468, −0.018): A = 0.468 − 1.04 · 0.015, and B is below 0 and so 5e-5.
    let [a, b] = standard::karis(1.0, 0.3);
    close(a, 0.468 - 1.04 * 0.015, 1e-13);
    assert_eq!(b, 5e-5);
    // r = (1, 0.0425, 1.04, −0.04) with 2^(−9.28) at normal incidence, where it is below 1.
    let a004 = (-9.28_f64).exp2() + 0.0425;
    let [a, b] = standard::karis(0.0, 1.0);
    close(a, 1.04 - 1.04 * a004, 1e-13);
    close(b, 1.04 * a004 - 0.04, 1e-12);
}

#[test]
fn a_roughness_below_the_least_is_the_least() {
    let l = DVec3::new(0.1, 0.2, 0.9).normalize();
    let of = |roughness| {
        let response = Response::new(
            &Material::Standard(Standard {
                reflectance: 0.0,
                metallic: 0.0,
                ..metal(roughness)
            }),
            DVec3::Z,
            tilted(0.9),
            SplitSum::Integral,
        );
        response.reflected(l)
    };
    assert_eq!(of(0.0), of(0.089));
    assert_ne!(of(0.0), of(0.09));
    assert_eq!(standard::alpha(0.0), 0.089 * 0.089);
}

#[test]
fn blinns_lobe_reflects_its_colour_to_an_eye_on_the_normal() {
    for (exponent, nodes) in [(0.0, 16), (1.0, 16), (10.0, 32), (100.0, 64), (1000.0, 256)] {
        for (lobe, diffuse, specular) in [
            (Lobe::Blinn, 0.0, 1.0),
            (Lobe::Phong, 0.0, 1.0),
            (Lobe::Blinn, 0.3, 0.6),
        ] {
            let material = Material::BlinnPhong(BlinnPhong {
                diffuse: DVec3::splat(diffuse),
                specular: DVec3::splat(specular),
                exponent,
                lobe,
                ..BlinnPhong::default()
            });
            close(head_on(&material, nodes), diffuse + specular, 1e-12);
        }
    }
}

#[test]
fn blinns_normalisation_has_known_values() {
    // 1/π without a lobe, (m + 6) / 8π and less and less above it.
    close(
        blinn_phong::normalisation(Lobe::Blinn, 0.0),
        1.0 / PI,
        1e-15,
    );
    close(
        blinn_phong::normalisation(Lobe::Phong, 0.0),
        1.0 / PI,
        1e-15,
    );
    let m = 64.0;
    let exact = (m * m + 6.0 * m + 8.0) / (8.0 * PI * (m + 2.0_f64.powi(-32)));
    close(blinn_phong::normalisation(Lobe::Blinn, m), exact, 1e-15);
}

#[test]
fn no_phong_surface_gives_more_than_it_takes() {
    for lobe in [Lobe::Blinn, Lobe::Phong] {
        for exponent in [1.0, 8.0, 40.0] {
            let material = Material::BlinnPhong(BlinnPhong {
                diffuse: DVec3::ZERO,
                specular: DVec3::ONE,
                exponent,
                lobe,
                ..BlinnPhong::default()
            });
            for cos in [0.95, 0.6, 0.2, 0.02] {
                let response = Response::new(&material, DVec3::Z, tilted(cos), SplitSum::Karis);
                let all = hemisphere(96, 192, |l| response.reflected(l)).x;
                assert!(all < 1.0 && all > 0.0, "{lobe:?} {exponent} {cos}: {all}");
            }
        }
    }
}

#[test]
fn light_may_go_either_way() {
    // Helmholtz: f(v, l) = f(l, v). A standard material keeps it without the factor k, which is 1 for F₀ = 0.
    let mut random = Random::new(5);
    let mut upward = || loop {
        let d = random.direction();
        if d.z > 0.01 {
            return d;
        }
    };
    let materials = [
        Material::Standard(Standard {
            reflectance: 0.0,
            perceptual_roughness: 0.6,
            ..Standard::default()
        }),
        Material::BlinnPhong(BlinnPhong::default()),
        Material::BlinnPhong(BlinnPhong {
            lobe: Lobe::Phong,
            ..BlinnPhong::default()
        }),
    ];
    for _ in 0..1000 {
        let (l, v) = (upward(), upward());
        for material in &materials {
            let f = |v: DVec3, l: DVec3| {
                Response::new(material, DVec3::Z, v, SplitSum::Karis)
                    .reflected(l)
                    .x
                    / l.z
            };
            close(f(v, l), f(l, v), 1e-12);
        }
    }
}

#[test]
fn ambient_light_has_known_values() {
    // At roughness 1 the polynomial is A = 0.4524, B = 5e-5 for every angle, so a dielectric of albedo c gives
    // c A + B + 0.04 A + B, with F₉₀ = 1: less than a half of c, where a Lambertian surface gives c.
    let (a, b) = (0.468 - 1.04 * 0.015, 5e-5);
    let ambient = |m: Standard, v: DVec3, split: SplitSum| {
        Response::new(&Material::Standard(m), DVec3::Z, v, split)
            .ambient()
            .x
    };
    let rough = Standard {
        base_colour: DVec3::splat(0.7),
        perceptual_roughness: 1.0,
        ..Standard::default()
    };
    for cos in [0.2, 0.9] {
        let is = ambient(rough, tilted(cos), SplitSum::Karis);
        close(is, 0.7 * a + b + 0.04 * a + b, 1e-13);
        // A mirror of white metal gives back E, and the B of the diffuse term.
        let [a1, b1] = split_sum(1.0, cos);
        let is = ambient(metal(1.0), tilted(cos), SplitSum::Integral);
        close(is, b1 + a1 + b1, 1e-12);
    }
    // Reflectance 0 is no reflection: F₀ = 0 and F₉₀ = 0.
    let black = Standard {
        base_colour: DVec3::ZERO,
        reflectance: 0.0,
        ..rough
    };
    close(ambient(black, DVec3::Z, SplitSum::Karis), b, 1e-13);
    let response = Response::new(&WHITE, DVec3::Z, tilted(0.3), SplitSum::Karis);
    assert_eq!(response.ambient(), DVec3::ONE);
}
