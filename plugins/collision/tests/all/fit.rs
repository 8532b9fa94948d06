//! The smallest volumes around points: points are made so that the smallest is known.

use crate::support::random::{direction, place, size, turn};
use bevy::math::DVec3;
use dolomite_collision::{Aabb, Capsule, Ellipsoid, FitError, Sphere, Volume};
use dolomite_testkit::random::Random;

fn holds(volume: &Volume, points: &[DVec3]) -> bool {
    points.iter().all(|&point| volume.contains(point))
}

/// Points on a sphere with four of them around its centre: it is the smallest (a sphere is where the centre is in
/// the hull of the points that it rests on).
#[test]
fn the_smallest_sphere() {
    let mut random = Random::new(11);
    for number in 0..2000 {
        let (center, radius) = (place(&mut random, 100.0), size(&mut random, 1e-3, 1e3));
        let mut points: Vec<DVec3> = (0..random.below(60))
            .map(|_| center + direction(&mut random) * radius * random.unit())
            .collect();
        let (a, b) = (direction(&mut random), direction(&mut random));
        match number % 3 {
            // The ends of a diameter.
            0 => points.extend([center + a * radius, center - a * radius]),
            // Three around a circle.
            1 => {
                let b = b.reject_from(a).normalize();
                let third = |c: f64, s: f64| center + (a * c + b * s) * radius;
                let s = 0.75_f64.sqrt();
                points.extend([third(1.0, 0.0), third(-0.5, s), third(-0.5, -s)]);
            }
            // A tetrahedron.
            _ => {
                let turn = turn(&mut random);
                let corners = [
                    [1.0, 1.0, 1.0],
                    [1.0, -1.0, -1.0],
                    [-1.0, 1.0, -1.0],
                    [-1.0, -1.0, 1.0],
                ];
                let unit = (1.0_f64 / 3.0).sqrt();
                points.extend(corners.map(|c| center + turn * DVec3::from(c) * unit * radius));
            }
        }
        let found = Sphere::fit(&points).unwrap();
        assert!(holds(&found.into(), &points));
        // Places are known to 1e-14 of 100 m; below the radius of 1e-3 m that is 1e-11 of it.
        let error = (found.radius / radius - 1.0).abs();
        assert!(error < 1e-10, "{number}: {} for {radius}", found.radius);
    }
}

/// The ends of the axes of an ellipsoid: it is the smallest around them, and points inside do not matter.
#[test]
fn the_smallest_ellipsoid() {
    let mut random = Random::new(12);
    for number in 0..200 {
        let radii = DVec3::new(
            1.0,
            size(&mut random, 0.02, 1.0),
            size(&mut random, 0.02, 1.0),
        );
        let (turn, center) = (turn(&mut random), place(&mut random, 10.0));
        let mut points = Vec::new();
        for axis in 0..3 {
            let end = turn * (DVec3::AXES[axis] * radii[axis]);
            points.extend([center + end, center - end]);
        }
        for _ in 0..random.below(200) {
            points.push(center + turn * (direction(&mut random) * random.unit() * radii));
        }
        let found = Ellipsoid::fit(&points).unwrap();
        assert!(holds(&found.into(), &points), "{number}");
        let ratio = found.radii.element_product() / radii.element_product();
        // Never smaller, which needs both the points inside and the smallest known; 0.2 % greater at most.
        assert!((1.0 - 1e-9..=1.002).contains(&ratio), "{number}: {ratio}");
    }
}

#[test]
fn a_small_capsule() {
    let mut random = Random::new(13);
    for number in 0..60 {
        let radius = size(&mut random, 0.1, 1.0);
        let arm = direction(&mut random) * size(&mut random, 0.5, 4.0);
        let center = place(&mut random, 10.0);
        let true_one = Capsule {
            segment: [center - arm, center + arm],
            radius,
        };
        // Rings around both ends and the caps: enough points that nothing is smaller but by their distances.
        let mut points = Vec::new();
        for _ in 0..2000 {
            let out = direction(&mut random) * radius;
            points.push(if out.dot(arm) > 0.0 {
                center + arm + out
            } else {
                center - arm + out
            });
        }
        let found = Capsule::fit(&points).unwrap();
        assert!(holds(&found.into(), &points), "{number}");
        let ratio = found.volume() / true_one.volume();
        assert!((0.9..1.01).contains(&ratio), "{number}: {ratio}");
    }
}

/// Points of all kinds, far away, flat, in a line, all one: everything holds them, and the sphere is never greater
/// than that around their box.
#[test]
fn hostile_points_are_held() {
    let mut random = Random::new(14);
    for number in 0..3000 {
        let (far, spread) = (place(&mut random, 1e5), size(&mut random, 1e-6, 1e3));
        let flat = [DVec3::ONE, DVec3::new(1.0, 0.0, 1.0), DVec3::X, DVec3::ZERO][number % 4];
        let turn = turn(&mut random);
        let points: Vec<DVec3> = (0..1 + random.below(30))
            .map(|_| far + turn * (place(&mut random, spread) * flat))
            .collect();
        let (sphere, aabb) = (Sphere::fit(&points).unwrap(), Aabb::fit(&points).unwrap());
        assert!(holds(&sphere.into(), &points), "{number} sphere {points:?}");
        assert!(holds(&aabb.into(), &points), "{number} box");
        let around = aabb.half_size().length();
        assert!(
            sphere.radius <= around * (1.0 + 1e-9) + 1e-9,
            "{number}: {} {around}",
            sphere.radius
        );
        let capsule = Capsule::fit(&points).unwrap();
        assert!(
            holds(&capsule.into(), &points),
            "{number} capsule {capsule:?} {points:?}"
        );
        let ellipsoid = Ellipsoid::fit(&points).unwrap();
        // Thin ones are smaller than the rounding of places 1e5 m away, 1e-11 m.
        for &point in &points {
            let gap = ellipsoid.distance(point);
            assert!(gap <= 1e-10, "{number} ellipsoid {gap:e} {ellipsoid:?}");
        }
    }
}

#[test]
fn no_points_and_no_places_are_refused() {
    assert_eq!(Sphere::fit(&[]), Err(FitError::Empty));
    let points = [DVec3::ZERO, DVec3::new(f64::NAN, 0.0, 0.0)];
    assert_eq!(Aabb::fit(&points), Err(FitError::NotFinite(1)));
    assert_eq!(Ellipsoid::fit(&points), Err(FitError::NotFinite(1)));
    let said = Capsule::fit(&points).unwrap_err().to_string();
    assert_eq!(said, "point 1 is not finite");
}
