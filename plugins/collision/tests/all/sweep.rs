//! Ellipsoids that move against single triangles, held to halving in double-double numbers.

use bevy::math::DVec3;
use dolomite_collision::{Contact, Ellipsoid, Feature, SweepError, sweep};
use dolomite_testkit::hostile::{self, KINDS};
use dolomite_testkit::places::{direction, place, size};
use dolomite_testkit::random::Random;
use dolomite_testkit::sweeps::{Sweep, Swept, swept};

/// Where the oracle's least distance is farther from 1 than this, in radii, there is no doubt whether it hits.
const DOUBT: f64 = 1e-9;

#[derive(Debug, Default)]
struct Errors {
    missed: u32,
    invented: u32,
    /// In parts of the way.
    time: f64,
    /// Radians.
    normal: f64,
    hits: u32,
}

fn ours(case: &Sweep) -> Option<Contact> {
    let ellipsoid = Ellipsoid::upright(case.center.into(), case.radii.into());
    sweep(
        &ellipsoid,
        case.way.into(),
        &[case.corners.map(DVec3::from)],
    )
    .expect("valid")
}

fn compare(errors: &mut Errors, found: Option<Contact>, truth: &Swept) {
    let must = truth.least < 1.0 - DOUBT && (truth.start > 1.0 || truth.rate > 1e-9);
    let may = truth.least < 1.0 + DOUBT;
    let Some(found) = found else {
        errors.missed += u32::from(must);
        return;
    };
    if !may {
        errors.invented += 1;
        return;
    }
    if !must {
        return;
    }
    errors.hits += 1;
    errors.time = errors.time.max((found.time - truth.time).abs());
    let normal = DVec3::from(truth.normal);
    if normal != DVec3::ZERO {
        let angle = found.normal.cross(normal).length();
        let angle = if found.normal.dot(normal) > 0.0 {
            angle
        } else {
            3.0
        };
        if angle > errors.normal {
            errors.normal = angle;
        }
    }
}

#[test]
fn hostile_sweeps_hit_as_the_oracle_says() {
    let mut random = Random::new(21);
    for kind in 0..KINDS {
        let mut errors = Errors::default();
        for _ in 0..500 {
            let case = hostile::sweep(&mut random, kind);
            compare(&mut errors, ours(&case), &swept(&case));
        }
        println!("{}: {errors:?}", hostile::name(kind));
        assert_eq!(
            (errors.missed, errors.invented),
            (0, 0),
            "{}",
            hostile::name(kind)
        );
        assert!(
            errors.time <= 1e-6 && errors.normal <= 1e-4,
            "{}: {errors:?}",
            hostile::name(kind)
        );
        assert!(errors.hits > 100, "{}: {errors:?}", hostile::name(kind));
    }
}

/// Needles of every width, down to corners in one line: the normal of those is a rounding, and says nothing.
#[test]
fn slivers_of_any_width_are_hit_as_the_oracle_says() {
    let mut random = Random::new(23);
    for widths in [[0.0, 0.0], [1e-18, 1e-14], [1e-14, 1e-10], [1e-10, 1e-5]] {
        let mut errors = Errors::default();
        for _ in 0..1500 {
            let from = place(&mut random, 2.0);
            let along = direction(&mut random) * size(&mut random, 0.1, 10.0);
            let width = if widths[1] > 0.0 {
                along.length() * size(&mut random, widths[0], widths[1])
            } else {
                0.0
            };
            let middle = from + along * random.unit() + direction(&mut random) * width;
            let mut corners = [from, from + along, middle];
            corners.rotate_left(random.below(3));
            let radii = DVec3::new(
                size(&mut random, 1e-3, 1.0),
                size(&mut random, 1e-3, 1.0),
                size(&mut random, 1e-3, 1.0),
            );
            let aim = from + along * random.unit();
            let way = direction(&mut random) * size(&mut random, 0.1, 10.0);
            // So near to it that it is hit where the way is not too short.
            let beside = direction(&mut random) * radii * random.unit();
            let center = aim + beside - way * random.unit();
            let case = Sweep {
                center: center.to_array(),
                radii: radii.to_array(),
                way: way.to_array(),
                corners: corners.map(|corner| corner.to_array()),
            };
            compare(&mut errors, ours(&case), &swept(&case));
        }
        println!("{widths:?}: {errors:?}");
        assert_eq!((errors.missed, errors.invented), (0, 0), "{widths:?}");
        assert!(
            errors.time <= 1e-6 && errors.normal <= 1e-4 && errors.hits > 500,
            "{widths:?}: {errors:?}"
        );
    }
}

/// Its corners lie in one line but for the last bit: the plane through them is nobody's.
#[test]
fn a_segment_of_three_corners_is_hit_at_its_edge() {
    let mut case = Sweep {
        center: [2.8, 0.2, 4.2],
        radii: [0.3, 0.9, 0.3],
        way: [0.0, -4.0, 0.0],
        corners: [[0.0; 3], [4.0, -4.0, 6.0], [1.2, -1.2, 1.8]],
    };
    for _ in 0..2 {
        let found = ours(&case).expect("it falls onto the segment");
        assert!((found.time - 0.521_186).abs() < 1e-6, "{found:?}");
        assert!(matches!(found.feature, Feature::Edge(_)), "{found:?}");
        // The neighbours of these numbers.
        case.corners[1][2] = 6.000_000_000_000_001;
        case.corners[2][0] = 1.200_000_000_000_000_2;
    }
}

/// The comparison sees a sweep that has only faces, and one that is late by 2e-6.
#[test]
fn wrong_sweeps_are_seen() {
    let mut random = Random::new(22);
    let (mut faces, mut late) = (Errors::default(), Errors::default());
    for number in 0..3000 {
        let case = hostile::sweep(&mut random, number % KINDS);
        let truth = swept(&case);
        let found = ours(&case);
        compare(
            &mut faces,
            found.filter(|c| c.feature == Feature::Face),
            &truth,
        );
        let delayed = found.map(|c| Contact {
            time: c.time + 2e-6,
            ..c
        });
        compare(&mut late, delayed, &truth);
    }
    assert!(faces.missed > 100, "{faces:?}");
    assert!(late.time > 1e-6, "{late:?}");
}

#[test]
fn at_the_start() {
    let floor = [[-9.0, 0.0, 9.0], [9.0, 0.0, 9.0], [0.0, 0.0, -9.0]].map(DVec3::from);
    let at = |height: f64, way: DVec3| {
        let figure = Ellipsoid::upright(DVec3::new(0.0, height, 0.0), DVec3::new(0.3, 0.9, 0.3));
        sweep(&figure, way, &[floor]).unwrap()
    };
    // Touching: into it at once, along it and away never.
    assert_eq!(at(0.9, -DVec3::Y).map(|c| c.time), Some(0.0));
    assert_eq!(at(0.9, DVec3::X), None);
    assert_eq!(at(0.9, DVec3::Y), None);
    assert_eq!(at(0.9, DVec3::ZERO), None);
    // Inside: with its depth, and free to leave.
    let deep = at(0.8, -DVec3::Y).unwrap();
    assert!(
        (deep.depth - 0.1).abs() < 1e-12 && deep.normal.y > 0.999_999,
        "{deep:?}"
    );
    assert_eq!(at(0.8, DVec3::Y), None);
    // With its centre on the triangle: out of where it came from.
    assert!(at(0.0, -DVec3::Y).unwrap().normal.y > 0.999);
    assert!(at(0.0, DVec3::Y).unwrap().normal.y < -0.999);
    // From below.
    let below = at(-2.0, DVec3::Y * 2.0).unwrap();
    assert!((below.time - 0.55).abs() < 1e-12 && below.normal.y < -0.999);
    // An hour at 100 m/s onto it.
    let hour = at(360_000.0, DVec3::Y * -720_000.0).unwrap();
    assert!((hour.time - (360_000.0 - 0.9) / 720_000.0).abs() < 1e-15);
}

#[test]
fn what_cannot_be_swept_is_refused_and_broken_triangles_are_passed() {
    let floor = [[-9.0, 0.0, 9.0], [9.0, 0.0, 9.0], [0.0, 0.0, -9.0]].map(DVec3::from);
    let nan = f64::NAN;
    for radii in [
        DVec3::new(0.0, 1.0, 1.0),
        DVec3::splat(-1.0),
        DVec3::splat(nan),
        DVec3::splat(f64::INFINITY),
    ] {
        let refused = sweep(&Ellipsoid::upright(DVec3::ZERO, radii), DVec3::X, &[floor]);
        assert!(matches!(refused, Err(SweepError::Ellipsoid { .. })));
    }
    let figure = Ellipsoid::upright(DVec3::Y * 2.0, DVec3::ONE);
    for way in [
        DVec3::splat(nan),
        DVec3::splat(f64::INFINITY),
        DVec3::new(0.0, nan, 0.0),
        DVec3::Y * -1e300,
    ] {
        assert!(matches!(
            sweep(&figure, way, &[floor]),
            Err(SweepError::Way(_))
        ));
    }
    let nowhere = Ellipsoid::upright(DVec3::Y * 1e300, DVec3::ONE);
    assert!(matches!(
        sweep(&nowhere, DVec3::X, &[floor]),
        Err(SweepError::Ellipsoid { .. })
    ));
    let beyond = [DVec3::Z * 1e300, DVec3::X, DVec3::Y];
    assert_eq!(sweep(&figure, -DVec3::Y * 3.0, &[beyond]), Ok(None));
    // Far is not too far.
    let far = sweep(&figure, -DVec3::Y * 1e50, &[floor]);
    assert!(matches!(far, Ok(Some(contact)) if contact.time < 1e-49 && contact.normal.y > 0.999));
    let broken = [DVec3::splat(nan), DVec3::X, DVec3::Y];
    let point = [DVec3::new(0.0, 0.5, 0.0); 3];
    assert_eq!(sweep(&figure, -DVec3::Y * 3.0, &[]), Ok(None));
    assert_eq!(sweep(&figure, -DVec3::Y * 3.0, &[broken]), Ok(None));
    let found = sweep(&figure, -DVec3::Y * 3.0, &[broken, floor, point])
        .unwrap()
        .unwrap();
    assert_eq!(found.triangle, 2);
    assert!((found.time - 0.5 / 3.0).abs() < 1e-12);
}
