//! The error guarantee, on the triangles that the adapter drew: a million places a run. The soak of a hundred
//! million is `dolomite_lab lod --part drawn --cameras 2000 --samples 20000`.

use bevy::math::{DVec3, UVec2};
use dolomite_ground::detail::DetailCells;
use dolomite_lab::scenes::camera::Camera;
use dolomite_lab::scenes::cameras::{KINDS, Kind, around};
use dolomite_lab::scenes::selection::FINEST;
use dolomite_lab::scenes::terrains;
use dolomite_lab::scenes::truth::Truth;
use dolomite_lab::studies::lod::drawn::{CAPACITY, Surface, drawn, judge};
use dolomite_testkit::detail::DetailStage;
use dolomite_testkit::gpu::for_test;
use dolomite_testkit::random::Random;
use std::time::Instant;

/// Tolerances of the cameras by turns, pixels.
const TAUS: [f64; 4] = [8.0, 4.0, 2.0, 4.0];
/// Places a camera, beside the vertices that it sees.
const SAMPLES: usize = 40_000;
/// With four times the pixels an error of 1 pixel is one of 4: small pictures are chosen faster.
const SIZE: UVec2 = UVec2::new(240, 135);

#[test]
fn gpu_a_million_places_of_drawn_triangles_keep_to_the_bound() {
    let Some(gpu) = for_test() else { return };
    let (start, mut places, mut largest) = (Instant::now(), 0, 0.0_f64);
    for (number, terrain) in terrains::all(11).iter().enumerate() {
        let truth = Truth::new(terrain);
        let cells = DetailCells::new(terrain.clone(), FINEST);
        let mut stage = DetailStage::new(&gpu, &cells, CAPACITY).expect("passes");
        let cameras = around(terrain, KINDS.len(), 11 + number as u32);
        for (k, (kind, camera)) in cameras.into_iter().enumerate() {
            let camera = Camera {
                size: SIZE,
                ..camera
            };
            let tau = TAUS[(k + number) % TAUS.len()];
            let surface = drawn(&mut stage, &cells, &camera, tau).expect("runs");
            let mut random = Random::new(k as u32);
            let count = judge(&truth, &surface, (kind, camera), tau, SAMPLES, &mut random);
            let Some(measured) = count.measured() else {
                panic!("{kind:?} over ground {number} sees nothing");
            };
            assert_eq!(
                (count.above(), measured.holes),
                (0, 0),
                "{kind:?} at {tau} px over ground {number}: {measured:?}"
            );
            assert!(measured.max <= 1.0, "{kind:?}: {measured:?}");
            places += measured.samples;
            largest = largest.max(measured.max);
        }
    }
    println!(
        "{places} places on {}, largest error {largest:.3} of the bound, {:.0} s",
        gpu.name,
        start.elapsed().as_secs_f64()
    );
    assert!(places >= 1_000_000, "{places}");
    // Triangles far finer than asked for would prove nothing.
    assert!(largest > 0.4, "{largest}");
}

/// What is measured above must be able to fail: by a vertex that is off, a triangle that is missing, a part of the
/// ground that is missing with all its edges, and by the wrong ground.
#[test]
fn gpu_a_displaced_vertex_and_a_missing_triangle_are_caught() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrains::fbm(1);
    let truth = Truth::new(&terrain);
    let cells = DetailCells::new(terrain.clone(), FINEST);
    let mut stage = DetailStage::new(&gpu, &cells, CAPACITY).expect("passes");
    let camera = Camera {
        size: SIZE,
        ..around(&terrain, 2, 1)[1].1
    };
    let (view, tau) = (camera.view(), 2.0);
    let good = drawn(&mut stage, &cells, &camera, tau).expect("runs");
    let of = |surface: &Surface, truth: &Truth| {
        let with = (Kind::Flying, camera);
        let count = judge(truth, surface, with, tau, 2000, &mut Random::new(1));
        (count.above(), count.measured().expect("seen").holes)
    };
    assert_eq!(of(&good, &truth), (0, 0));

    // The vertex nearest to the middle of the picture, two tolerances aside on the screen.
    let off_middle = |at: DVec3| view.project(at).map_or(f64::INFINITY, |p| p.length());
    let by_middle = |a: &DVec3, b: &DVec3| off_middle(*a).total_cmp(&off_middle(*b));
    let (middle, &at) = good
        .positions
        .iter()
        .enumerate()
        .min_by(|a, b| by_middle(a.1, b.1))
        .expect("vertices");
    let up = DVec3::Y * 1e-3;
    let pixels = view.pixels(at, at + up).expect("before the camera") / 1e-3;
    for sign in [1.0, -1.0] {
        let mut moved = good.clone();
        moved.positions[middle].y += sign * 2.0 * tau / pixels;
        let (above, holes) = of(&moved, &truth);
        assert!(above >= 1 && holes == 0, "{above} {holes}");
    }

    // A triangle in the middle, with its three edges.
    let has = |triangle: &[u32; 3]| triangle.contains(&(middle as u32));
    let first = good.triangles.iter().position(has).expect("it is drawn");
    let mut missing = good.clone();
    missing.triangles.remove(first);
    let (above, holes) = of(&missing, &truth);
    assert!(above >= 3 && holes >= 3, "{above} {holes}");

    // All that the view shows, so that no edge of the hole is seen.
    let mut bare = good.clone();
    bare.triangles.retain(|&t| !view.may_see(&good.corners(t)));
    assert!(bare.triangles.len() < good.triangles.len());
    // Of 2000 / 8 = 250 places that are looked at for holes, those that are in view.
    let (above, holes) = of(&bare, &truth);
    assert!(above >= 25 && holes >= 25, "{above} {holes}");

    // Another ground, of the same kind.
    let other = Truth::new(&terrains::fbm(2));
    assert!(of(&good, &other).0 > 100);
}
