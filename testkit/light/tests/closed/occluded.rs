//! Ambient occlusion and form factors.
//!
//! The share of a light from everywhere that a body takes away is its form factor: J. R. Howell, "A catalog of radiation
//! heat transfer configuration factors".

use std::f64::consts::{FRAC_PI_2, PI};

use dolomite_light_oracle::occlusion::{Occlusion, occlusion};
use dolomite_light_oracle::random::Random;
use dolomite_light_oracle::scene::{Mesh, Object, Pose, Scene, Shape};
use dolomite_light_oracle::trace::Tracer;
use glam::{DQuat, DVec3};

use super::{exact, placed};

/// The share that reaches the origin, or another point, of a surface that looks up.
fn free(scene: &Scene, point: DVec3, how: &Occlusion) -> f64 {
    occlusion(&Tracer::new(scene), point, DVec3::Y, DVec3::Y, how)
}

/// Fails unless 4096 even rays, and as many independent ones, say so.
#[track_caller]
fn share(scene: &Scene, exact: f64) {
    let even = free(scene, DVec3::ZERO, &Occlusion::default());
    // The edge of a body cuts the square of the rays in a curve; 4096 points of the Hammersley set keep its area to
    // less than this (measured: 5.5e-4).
    assert!((even - exact).abs() < 1.5e-3, "{even} is not {exact}");
    let random = Occlusion {
        even: false,
        seed: 4,
        ..Occlusion::default()
    };
    let random = free(scene, DVec3::ZERO, &random);
    let deviation = (exact * (1.0 - exact) / 4096.0).sqrt();
    assert!(
        (random - exact).abs() <= 4.0 * deviation,
        "{random} {exact}"
    );
}

/// An endless wall at the distance x, seen from the origin.
fn wall(turn: f64, distance: f64) -> (Shape, Pose) {
    let rotation = DQuat::from_rotation_y(turn) * DQuat::from_rotation_z(FRAC_PI_2);
    let pose = Pose {
        translation: distance * (DQuat::from_rotation_y(turn) * DVec3::X),
        rotation,
        ..Pose::default()
    };
    (Shape::Plane, pose)
}

/// A quad of these corners.
fn quad(corners: [DVec3; 4]) -> Scene {
    Scene {
        meshes: vec![Mesh {
            positions: corners.to_vec(),
            normals: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }],
        ..exact(&[(Shape::Mesh(0), Pose::default())])
    }
}

#[test]
fn nothing_is_no_occlusion() {
    assert_eq!(
        free(&Scene::default(), DVec3::ZERO, &Occlusion::default()),
        1.0
    );
}

#[test]
fn an_endless_wall_takes_a_half_and_a_corner_three_quarters() {
    share(&exact(&[wall(0.0, 0.7)]), 0.5);
    share(&exact(&[wall(0.0, 0.7), wall(FRAC_PI_2, 3.0)]), 0.25);
}

#[test]
fn what_is_further_than_the_distance_takes_nothing() {
    // Of a wall at 0.6 within a distance of 1, the directions whose part along x is above 0.6: the cap of a disc,
    // 1/π (acos 0.6 − 0.6 · 0.8) of the projected hemisphere.
    let scene = exact(&[wall(0.0, 0.6)]);
    let how = Occlusion {
        distance: 1.0,
        ..Occlusion::default()
    };
    let cap = (0.6_f64.acos() - 0.48) / PI;
    let is = free(&scene, DVec3::ZERO, &how);
    assert!((is - (1.0 - cap)).abs() < 2.5e-3, "{is}");
}

#[test]
fn a_wall_of_a_height_takes_half_of_one_minus_the_cosine() {
    // ½ (1 − a / √(a² + h²)) for the distance a; 2000 m are endless for a wall of 2 m.
    let (a, h) = (1.5, 2.0);
    let at = |y: f64, z: f64| DVec3::new(a, y, z);
    let scene = quad([at(0.0, -2e3), at(h, -2e3), at(h, 2e3), at(0.0, 2e3)]);
    share(&scene, 1.0 - 0.5 * (1.0 - a / f64::hypot(a, h)));
}

#[test]
fn a_disc_above_takes_its_square_over_that_of_the_edge() {
    // R² / (R² + h²); the disc is an ellipsoid that is 1e-9 thick.
    let (radius, height) = (1.3, 0.9);
    let size = DVec3::new(radius, 1e-9, radius);
    let scene = exact(&[(Shape::Sphere, placed(DVec3::new(0.0, height, 0.0), size))]);
    let r2 = radius * radius;
    share(&scene, 1.0 - r2 / (r2 + height * height));
}

#[test]
fn a_sphere_above_takes_the_square_of_its_sine() {
    // (R / D)², times the cosine for a sphere that is not cut by the horizon.
    let (radius, distance) = (1.0, 2.5);
    for angle in [0.0, 0.6_f64] {
        let place = distance * DVec3::new(angle.sin(), angle.cos(), 0.0);
        let scene = exact(&[(Shape::Sphere, placed(place, DVec3::splat(radius)))]);
        share(&scene, 1.0 - (radius / distance).powi(2) * angle.cos());
    }
}

#[test]
fn a_rectangle_with_a_corner_above_has_its_form_factor() {
    // X = a / c, Y = b / c: 1/2π (X / √(1 + X²) atan(Y / √(1 + X²)) + Y / √(1 + Y²) atan(X / √(1 + Y²))).
    let (a, b, c) = (2.0, 1.2, 0.8);
    let at = |x: f64, z: f64| DVec3::new(x, c, z);
    let scene = quad([at(0.0, 0.0), at(a, 0.0), at(a, b), at(0.0, b)]);
    let part = |x: f64, y: f64| {
        let root = (1.0 + x * x).sqrt();
        x / root * (y / root).atan()
    };
    let (x, y) = (a / c, b / c);
    share(&scene, 1.0 - (part(x, y) + part(y, x)) / (2.0 * PI));
}

#[test]
fn an_upright_rectangle_with_a_corner_ahead_has_its_form_factor() {
    // At the distance c, of the width b and the height a: 1/2π (atan(b/c) − c / √(a² + c²) atan(b / √(a² + c²))).
    let (a, b, c) = (1.7, 1.1, 0.6);
    let at = |y: f64, z: f64| DVec3::new(c, y, z);
    let scene = quad([at(0.0, 0.0), at(a, 0.0), at(a, b), at(0.0, b)]);
    let edge = f64::hypot(a, c);
    let factor = ((b / c).atan() - c / edge * (b / edge).atan()) / (2.0 * PI);
    share(&scene, 1.0 - factor);
}

#[test]
fn anywhere_in_half_of_a_sphere_half_of_the_sky_is_seen() {
    // From one point of a sphere to a part of it the form factor is the part's share of the sphere's area. The pit is the
    // lower half; the point looks to the middle.
    let (around, down) = (96_u32, 48_u32);
    let mut mesh = Mesh::default();
    for i in 0..=down {
        for j in 0..around {
            let (s, c) = (FRAC_PI_2 * f64::from(i) / f64::from(down)).sin_cos();
            let (z, x) = (2.0 * PI * f64::from(j) / f64::from(around)).sin_cos();
            mesh.positions.push(DVec3::new(c * x, -s, c * z));
        }
    }
    for i in 0..down {
        for j in 0..around {
            let at = |i: u32, j: u32| i * around + j % around;
            mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            mesh.triangles
                .push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    let scene = Scene {
        meshes: vec![mesh],
        ..exact(&[(Shape::Mesh(0), Pose::default())])
    };
    let tracer = Tracer::new(&scene);
    for elevation in [1.5, 0.8, 0.3_f64] {
        let p = DVec3::new(elevation.cos(), -elevation.sin(), 0.0);
        // A little inside the polygon, whose rings sag by (π/2 / 48)² / 8 = 1.3e-4.
        let is = occlusion(&tracer, 0.999 * p, -p, -p, &Occlusion::default());
        // Half, with what the sag and the step inside take away.
        assert!((is - 0.5).abs() < 5e-3, "{is}");
    }
}

/// The mean over points of a unit square y = 0, that looks up, of what `blocker` takes from it, by 160 000 rays.
fn taken(blocker: &Scene) -> f64 {
    let tracer = Tracer::new(blocker);
    let mut random = Random::new(17);
    let points = 40_000;
    let how = Occlusion {
        rays: 4,
        even: false,
        ..Occlusion::default()
    };
    let blocked: f64 = (0..points)
        .map(|_| {
            let p = DVec3::new(random.unit(), 0.0, random.unit());
            1.0 - occlusion(&tracer, p, DVec3::Y, DVec3::Y, &how)
        })
        .sum();
    blocked / f64::from(points)
}

/// Four standard deviations of 160 000 rays of which a fifth hits.
const SQUARES: f64 = 4.0 * 1e-3;

#[test]
fn two_parallel_squares_have_their_form_factor() {
    let at = |x: f64, z: f64| DVec3::new(x, 1.0, z);
    let scene = quad([at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]);
    // Hottel, for X = Y = 1.
    let root = 2.0_f64.sqrt();
    let exact = 2.0 / PI
        * (0.5 * (4.0_f64 / 3.0).ln() + 2.0 * root * (1.0 / root).atan() - 2.0 * 1.0_f64.atan());
    assert!((exact - 0.199_825).abs() < 1e-6);
    let is = taken(&scene);
    assert!((is - exact).abs() < SQUARES, "{is} {exact}");
}

#[test]
fn two_squares_with_a_common_edge_have_their_form_factor() {
    let at = |y: f64, z: f64| DVec3::new(1.0, y, z);
    let scene = quad([at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]);
    // Hamilton and Morgan, for H = W = 1.
    let root = 2.0_f64.sqrt();
    let logarithm = (4.0_f64 / 3.0 * 0.75 * 0.75).ln();
    let exact = (2.0 * 1.0_f64.atan() - root * (1.0 / root).atan() + 0.25 * logarithm) / PI;
    assert!((exact - 0.200_044).abs() < 1e-6);
    let is = taken(&scene);
    assert!((is - exact).abs() < SQUARES, "{is} {exact}");
}

#[test]
fn the_error_of_independent_rays_falls_as_their_root_and_that_of_even_ones_faster() {
    let ball = placed(DVec3::new(0.5, 1.5, 0.0), DVec3::ONE);
    let mut scene = exact(&[(Shape::Sphere, ball)]);
    scene
        .objects
        .push(Object::new(Shape::Plane, wall(2.0, 1.0).1, 0));
    let tracer = Tracer::new(&scene);
    let ask = |how: &Occlusion| occlusion(&tracer, DVec3::ZERO, DVec3::Y, DVec3::Y, how);
    let truth = ask(&Occlusion {
        rays: 1 << 20,
        ..Occlusion::default()
    });
    let slope = |even: bool| {
        let sizes: Vec<u32> = (4..=12).step_by(2).map(|k| 1 << k).collect();
        let points: Vec<(f64, f64)> = sizes
            .iter()
            .map(|rays| {
                let trials = 400;
                let squares: f64 = (0..trials)
                    .map(|seed| {
                        let how = Occlusion {
                            rays: *rays,
                            even,
                            seed,
                            ..Occlusion::default()
                        };
                        (ask(&how) - truth).powi(2)
                    })
                    .sum();
                (f64::from(*rays).ln(), 0.5 * (squares / 400.0).ln())
            })
            .collect();
        let n = points.len() as f64;
        let (mx, my) = points
            .iter()
            .fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
        let (xy, xx) = points.iter().fold((0.0, 0.0), |s, p| {
            (s.0 + (p.0 - mx) * (p.1 - my), s.1 + (p.0 - mx).powi(2))
        });
        xy / xx
    };
    let (independent, even) = (slope(false), slope(true));
    // Measured: −0.497 and −0.78.
    assert!((independent + 0.5).abs() < 0.03, "{independent}");
    assert!(even < -0.65, "{even}");
}
