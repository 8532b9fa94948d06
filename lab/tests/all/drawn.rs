//! The error guarantee, on the triangles that the adapter drew: a million places a run. The soak of a hundred
//! million is `dolomite_lab lod --part drawn --cameras 2000 --samples 20000`.

use bevy::math::{DVec2, DVec3, UVec2};
use dolomite_lab::scenes::camera::Camera;
use dolomite_lab::scenes::cameras::{KINDS, Kind, around};
use dolomite_lab::scenes::selection::{FINEST, ground_of};
use dolomite_lab::scenes::terrains;
use dolomite_lab::scenes::truth::Truth;
use dolomite_lab::studies::lod::drawn::drawn;
use dolomite_lab::studies::lod::judge::{Surface, judge};
use dolomite_terrain::{Filter, GroundRect, HeightMap, Layer, Source, Terrain, TerrainData};
use dolomite_testkit::blocks::BlockStage;
use dolomite_testkit::gpu::for_test;
use dolomite_testkit::random::Random;
use std::path::PathBuf;
use std::time::Instant;

/// Tolerances of the cameras by turns, pixels.
const TAUS: [f64; 4] = [8.0, 4.0, 2.0, 4.0];
/// Places a camera, beside the vertices that it sees.
const SAMPLES: usize = 32_000;
/// With four times the pixels an error of 1 pixel is one of 4: small pictures are chosen faster.
const SIZE: UVec2 = UVec2::new(240, 135);
/// Slots of blocks, some 60 MB.
const SLOTS: u32 = 4096;

/// The classic scene's ground, where the shared data are.
fn classic() -> Option<Terrain> {
    let shared = std::env::var_os("DOLOMITE_SHARED").map_or("../../shared".into(), PathBuf::from);
    let Ok(bytes) = std::fs::read(shared.join("data/classic/heights_1024_f32le.raw")) else {
        eprintln!("skipped: the classic ground, DOLOMITE_SHARED names no data");
        return None;
    };
    let heights: Vec<f32> = bytes
        .as_chunks::<4>()
        .0
        .iter()
        .map(|&bytes| 100.0 * f32::from_le_bytes(bytes))
        .collect();
    // It repeats: with one more column on each side its texels reach to the border.
    let at = |k: usize| (k + 1023) & 1023;
    let metres = (0..1026 * 1026)
        .map(|k| heights[at(k / 1026) * 1024 + at(k % 1026)])
        .collect();
    let map = HeightMap::new(
        1026,
        1026,
        metres,
        DVec2::splat(-512.5),
        DVec2::ONE,
        Filter::Bilinear,
    );
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 1024.0),
        layers: vec![Layer {
            source: Source::Map(map.ok()?),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    })
    .ok()
}

/// On lattices that stand on the samples of a map where there is one; the classic map's is aligned.
fn grounds() -> Vec<Terrain> {
    let [mountain, fbm, elevation] = terrains::all(11);
    let all = [classic(), Some(fbm), Some(elevation), Some(mountain)];
    all.into_iter().flatten().collect()
}

#[test]
fn gpu_a_million_places_of_drawn_triangles_keep_to_the_bound() {
    let Some(gpu) = for_test() else { return };
    let (start, mut places, mut largest) = (Instant::now(), 0, 0.0_f64);
    for (number, terrain) in grounds().into_iter().enumerate() {
        let ground = ground_of(&terrain, FINEST);
        let truth = Truth::new(&terrain);
        let mut stage = BlockStage::new(&gpu, &ground, SLOTS).expect("passes");
        let (mut own, begun) = (0.0_f64, Instant::now());
        let mut held = 0.0_f64;
        for (k, (kind, camera)) in around(&terrain, KINDS.len(), 11 + number as u32)
            .into_iter()
            .enumerate()
        {
            let camera = Camera {
                size: SIZE,
                ..camera
            };
            let tau = TAUS[(k + number) % TAUS.len()];
            let surface = drawn(&mut stage, &ground, &camera, tau).expect("runs");
            held = held.max(surface.held);
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
            places += measured.samples;
            own = own.max(measured.max);
        }
        println!(
            "ground {number}: largest {own:.3}, {held:.2} of the tolerance held, {:.0} s",
            begun.elapsed().as_secs_f64()
        );
        largest = largest.max(own);
    }
    println!(
        "{places} places on {}, largest error {largest:.3} of the bound, {:.0} s",
        gpu.name,
        start.elapsed().as_secs_f64()
    );
    assert!(places >= 1_000_000, "{places}");
    assert!(largest <= 1.0, "{largest}");
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
    let ground = ground_of(&terrain, FINEST);
    let mut stage = BlockStage::new(&gpu, &ground, SLOTS).expect("passes");
    let camera = Camera {
        size: SIZE,
        ..around(&terrain, 2, 1)[1].1
    };
    let (view, tau) = (camera.view(), 2.0);
    let good = drawn(&mut stage, &ground, &camera, tau).expect("runs");
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
