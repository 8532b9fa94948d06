//! Volumes against each other, against triangles and against rays: held to bodies that touch in one point.

use crate::support::convex::{farthest, farthest_corner, moved};
use crate::support::random::{direction, place, turn, volume};
use bevy::math::{DAffine3, DVec3};
use dolomite_collision::{Aabb, Capsule, Ellipsoid, Ray, Sphere, Volume};
use dolomite_testkit::random::Random;

/// Gap and depth, metres, at bodies of at most some 30 m: far above the rounding of f64 there, 1e-14, times the
/// ratio of radii up to 1000.
const GAP: f64 = 1e-9;

type Overlap = fn(&Volume, &Volume) -> bool;

/// Pairs that are judged wrong, of `count` of each two kinds: apart by [`GAP`], together by it, and deep inside.
fn wrong_pairs(overlaps: Overlap, count: usize, seed: u32) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut random = Random::new(seed);
    for kinds in 0..16 {
        let (one, two) = (kinds % 4, kinds / 4);
        for number in 0..count {
            let a = volume(&mut random, one);
            let b = volume(&mut random, two);
            let along = direction(&mut random);
            let touch = farthest(&a, along) - farthest(&b, -along);
            for (by, expected) in [(GAP, false), (-GAP, true)] {
                let b = moved(&b, touch + along * by);
                if overlaps(&a, &b) != expected {
                    wrong.push(format!("{one} {two} {number} gap {by}"));
                }
            }
            let inside = farthest(&a, along).lerp(farthest(&a, -along), random.unit());
            let of_b = farthest(&b, along).lerp(farthest(&b, -along), random.unit());
            if !overlaps(&a, &moved(&b, inside - of_b)) {
                wrong.push(format!("{one} {two} {number} deep"));
            }
        }
    }
    wrong
}

#[test]
fn every_pair_touches_where_it_must() {
    let wrong = wrong_pairs(|a, b| a.overlaps(b), 4000, 1);
    assert!(
        wrong.is_empty(),
        "{}: {:?}",
        wrong.len(),
        &wrong[..9.min(wrong.len())]
    );
}

/// The same check sees wrong answers: the boxes around the volumes, and what is off by ten gaps.
#[test]
fn boxes_and_small_errors_are_seen() {
    let boxes: Overlap = |a, b| {
        let (a, b) = (Volume::Aabb(a.bounds()), Volume::Aabb(b.bounds()));
        a.overlaps(&b)
    };
    assert!(wrong_pairs(boxes, 100, 2).len() > 500);
    let late: Overlap = |a, b| {
        let by = (b.bounds().center() - a.bounds().center()).normalize_or_zero();
        a.overlaps(&moved(b, by * (10.0 * GAP)))
    };
    assert!(wrong_pairs(late, 100, 2).len() > 500);
}

#[test]
fn order_does_not_matter() {
    let mut random = Random::new(3);
    for _ in 0..20_000 {
        let kinds = random.below(16);
        let (a, b) = (
            volume(&mut random, kinds % 4),
            volume(&mut random, kinds / 4),
        );
        assert_eq!(a.overlaps(&b), b.overlaps(&a), "{a:?} {b:?}");
    }
}

#[test]
fn triangles_touch_where_they_must() {
    let mut random = Random::new(4);
    for number in 0..40_000 {
        let a = volume(&mut random, number % 4);
        let mut corners = [(); 3].map(|()| place(&mut random, 5.0));
        match number % 7 {
            0 => corners[2] = corners[0],
            1 => corners = [corners[0]; 3],
            2 => corners[2] = corners[0].lerp(corners[1], 0.3) + place(&mut random, 1e-6),
            _ => {}
        }
        let along = direction(&mut random);
        let touch = farthest(&a, along) - farthest_corner(corners, -along);
        for (by, expected) in [(GAP, false), (-GAP, true)] {
            let there = corners.map(|corner| corner + touch + along * by);
            assert_eq!(
                a.overlaps_triangle(there),
                expected,
                "{number} {a:?} {there:?}"
            );
        }
        // Through its inside: a point of the triangle in the middle of the volume.
        let (u, v) = (random.unit(), random.unit());
        let point = corners[0].lerp(corners[1], u).lerp(corners[2], v);
        let inside = farthest(&a, along).lerp(farthest(&a, -along), 0.5);
        let through = corners.map(|corner| corner - point + inside);
        assert!(a.overlaps_triangle(through), "{number} {a:?} {through:?}");
    }
}

#[test]
fn a_triangle_against_faces_and_edges() {
    // What the corners above do not reach: a volume that touches the middle of a face, or of an edge.
    let mut random = Random::new(5);
    for number in 0..40_000 {
        let a = volume(&mut random, number % 4);
        let along = direction(&mut random);
        let touch = farthest(&a, along);
        let (u, v) = along.any_orthonormal_pair();
        let (near, far) = (1.0 + random.unit(), 20.0 * random.unit() + 0.1);
        // In the plane across; then one whose edge lies in that plane and that leans away.
        let lean = if number % 2 == 0 { 0.0 } else { far };
        let corners = [
            touch - u * near - v * near * (1.0 - f64::from(lean > 0.0)),
            touch + u * near - v * near * (1.0 - f64::from(lean > 0.0)),
            touch + v * near + along * lean,
        ];
        for (by, expected) in [(GAP, false), (-GAP, true)] {
            let there = corners.map(|corner| corner + along * by);
            assert_eq!(a.overlaps_triangle(there), expected, "{number} {by} {a:?}");
        }
    }
}

#[test]
fn rays_enter_where_they_must() {
    let mut random = Random::new(6);
    let mut worst = 0.0_f64;
    for number in 0..40_000 {
        let a = volume(&mut random, number % 4);
        let along = direction(&mut random);
        let touch = farthest(&a, along);
        let mut way = direction(&mut random);
        if way.dot(along) > 0.0 {
            way = -way;
        }
        // Nearly across, the place where it enters is not a matter of f64.
        if way.dot(along) > -1e-3 {
            continue;
        }
        let length = 0.1 + 1000.0 * random.unit();
        // A ray that ends in a box's corner may pass it by rounding: it aims a little below.
        let below = match a {
            Volume::Aabb(_) => GAP,
            _ => 0.0,
        };
        let ray = Ray::new(touch - along * below - way * length, way * length);
        let time = a
            .enter(&ray)
            .unwrap_or_else(|| panic!("{number} {a:?} {ray:?}"));
        // From the plane that touches to the place that it aims at.
        let early = below / -way.dot(along) / length;
        assert!(
            time <= 1.0 + 1e-9 && time >= 1.0 - early - 1e-9,
            "{number} {time}"
        );
        if below == 0.0 {
            worst = worst.max((time - 1.0).abs());
        }
        let short = Ray {
            end: (1.0 - early) * 0.999,
            ..ray
        };
        assert_eq!(a.enter(&short), None);
        // Past it: the whole line on the far side of the plane.
        let (side, _) = along.any_orthonormal_pair();
        let past = Ray::new(touch + along * GAP - side * length, side * length);
        assert_eq!(a.enter(&past), None, "{number} {a:?}");
        // From inside at once.
        let inside = farthest(&a, along).lerp(farthest(&a, -along), 0.5);
        assert_eq!(a.enter(&Ray::new(inside, way)), Some(0.0));
    }
    // The way is known to 1e-13 m at 1000 m, and over 1e-3 of slope enters 1e-10 m of it late.
    assert!(worst < 1e-9, "{worst:e}");
    assert!(worst > 0.0);
}

#[test]
fn images_are_around_images() {
    let mut random = Random::new(7);
    for number in 0..20_000 {
        let a = volume(&mut random, number % 4);
        let scale = if number % 3 == 0 {
            DVec3::splat(0.1 + random.unit())
        } else {
            DVec3::splat(0.2) + place(&mut random, 1.0).abs()
        };
        let map = DAffine3::from_scale_rotation_translation(
            scale,
            turn(&mut random),
            place(&mut random, 9.0),
        );
        let image = a.transformed(&map);
        let bounds = a.bounds();
        for _ in 0..8 {
            let along = direction(&mut random);
            let point = farthest(&a, along);
            // The box is tight: the farthest points of its axes stand on it.
            assert!(Volume::Aabb(bounds).overlaps(&Volume::from(Sphere {
                center: point,
                radius: 1e-12
            })));
            let there = Sphere {
                center: map.transform_point3(point),
                radius: 1e-11,
            };
            assert!(image.overlaps(&there.into()), "{number} {a:?}");
            // Ellipsoids always, and the others under one scale, keep their surfaces.
            let exact = matches!(a, Volume::Ellipsoid(_))
                || (number % 3 == 0 && !matches!(a, Volume::Aabb(_)));
            if exact {
                let normal = map.matrix3.inverse().transpose() * along;
                let reach = (farthest(&image, normal) - there.center).dot(normal.normalize());
                assert!(reach.abs() < 1e-11, "{number} {reach:e} {a:?}");
            }
        }
        for axis in DVec3::AXES {
            for sign in [1.0, -1.0] {
                let reach = farthest(&a, axis * sign).dot(axis);
                let side = if sign > 0.0 {
                    bounds.max.dot(axis)
                } else {
                    bounds.min.dot(axis)
                };
                assert!((reach - side).abs() < 1e-12, "{reach} {side}");
            }
        }
    }
}

#[test]
fn what_is_no_volume_overlaps_nothing() {
    let nan = f64::NAN;
    let whole: Volume = Aabb::around(DVec3::ZERO, DVec3::splat(1e9)).into();
    let broken: [Volume; 9] = [
        Sphere {
            center: DVec3::new(nan, 0.0, 0.0),
            radius: 1.0,
        }
        .into(),
        Sphere {
            center: DVec3::ZERO,
            radius: -1.0,
        }
        .into(),
        Sphere {
            center: DVec3::ZERO,
            radius: f64::INFINITY,
        }
        .into(),
        Aabb {
            min: DVec3::ONE,
            max: -DVec3::ONE,
        }
        .into(),
        Aabb {
            min: DVec3::splat(nan),
            max: DVec3::ONE,
        }
        .into(),
        Ellipsoid::upright(DVec3::ZERO, DVec3::new(1.0, 0.0, 1.0)).into(),
        Ellipsoid::upright(DVec3::ZERO, DVec3::new(1.0, nan, 1.0)).into(),
        Capsule {
            segment: [DVec3::ZERO, DVec3::splat(nan)],
            radius: 1.0,
        }
        .into(),
        Capsule {
            segment: [DVec3::ZERO; 2],
            radius: nan,
        }
        .into(),
    ];
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    for volume in broken {
        assert!(
            !volume.overlaps(&whole) && !whole.overlaps(&volume),
            "{volume:?}"
        );
        assert!(!volume.overlaps_triangle(corners));
        assert!(!volume.contains(DVec3::ZERO));
        assert_eq!(volume.enter(&Ray::new(DVec3::X * 9.0, -DVec3::X)), None);
    }
    assert!(!whole.overlaps_triangle([DVec3::splat(nan), DVec3::X, DVec3::Y]));
    for ray in [
        Ray::new(DVec3::splat(nan), DVec3::X),
        Ray::new(DVec3::X * 9.0, DVec3::ZERO),
        Ray::new(DVec3::X * 9.0, DVec3::splat(f64::INFINITY)),
        Ray {
            end: -1.0,
            ..Ray::new(DVec3::X * 9.0, DVec3::X)
        },
        Ray {
            end: nan,
            ..Ray::new(DVec3::X * 9.0, DVec3::X)
        },
    ] {
        assert!(ray.check().is_err());
        assert_eq!(whole.enter(&ray), None);
    }
}

/// Points and segments are volumes without an inside.
#[test]
fn radii_of_zero() {
    let point: Volume = Sphere {
        center: DVec3::ONE,
        radius: 0.0,
    }
    .into();
    assert!(point.overlaps(&point));
    assert!(point.overlaps_triangle([DVec3::ONE, DVec3::X, DVec3::Y]));
    let segment: Volume = Capsule {
        segment: [DVec3::ZERO, DVec3::ONE * 2.0],
        radius: 0.0,
    }
    .into();
    let near = Sphere {
        center: DVec3::new(1.0, 1.0, 1.0 + 1e-6),
        radius: 1e-9,
    };
    assert!(!segment.overlaps(&near.into()));
    assert!(segment.contains(DVec3::ONE));
}
