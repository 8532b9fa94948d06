//! The error guarantee of the level of detail in blocks, on the triangles that its passes drew: a million places a run. The same
//! of single cells is `drawn.rs`.

use bevy::math::{DVec2, UVec2};
use dolomite_ground::blocks::kept::lattice_of;
use dolomite_ground::detail::DetailCells;
use dolomite_lab::scenes::camera::Camera;
use dolomite_lab::scenes::cameras::{KINDS, Kind, around};
use dolomite_lab::scenes::selection::{FINEST, bound, params};
use dolomite_lab::scenes::terrains;
use dolomite_lab::scenes::truth::Truth;
use dolomite_lab::studies::lod::drawn::{POOLS, Surface, judge};
use dolomite_terrain::{Filter, GroundRect, HeightMap, Layer, Source, Terrain, TerrainData};
use dolomite_testkit::blocks::BlockStage;
use dolomite_testkit::gpu::for_test;
use dolomite_testkit::random::Random;
use std::collections::HashMap;
use std::path::PathBuf;
use std::time::Instant;

/// Tolerances of the cameras by turns, pixels.
const TAUS: [f64; 4] = [8.0, 4.0, 2.0, 4.0];
/// Places a camera, beside the vertices that it sees.
const SAMPLES: usize = 32_000;
/// As in `drawn.rs`.
const SIZE: UVec2 = UVec2::new(240, 135);
/// Slots of blocks, some 60 MB; blocks made a choice; most choices until a view is settled.
const SLOTS: u32 = 4096;
const BUDGET: u32 = 64;
const MOST: usize = 200;

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

/// The grounds, with the lattices that blocks have: on the samples of a map where there is one.
fn grounds() -> Vec<(Terrain, DetailCells)> {
    let with_cells = |terrain: Terrain| {
        let mut cells = DetailCells::new(terrain.clone(), FINEST);
        cells.lattice = lattice_of(&terrain, FINEST);
        (terrain, cells)
    };
    let [mountain, fbm, elevation] = terrains::all(11);
    let all = [classic(), Some(fbm), Some(elevation), Some(mountain)];
    all.into_iter().flatten().map(with_cells).collect()
}

/// What the passes draw for a camera at a tolerance, once all that it asks for is made.
fn drawn(stage: &mut BlockStage<'_>, cells: &DetailCells, camera: &Camera, tau: f64) -> Surface {
    let params = params(cells, camera, bound(tau), POOLS);
    let (run, _) = stage.settle(params, BUDGET, MOST).expect("runs");
    let held = run.left.max(run.coarsening);
    let (positions, triangles) = welded(&run.positions, &run.triangles);
    Surface::new(&params, &positions, triangles, held)
}

/// Each block has vertices of its own, and those on its border have the bits of its neighbour's: one of each. Where bits
/// differ an edge stays open, and counts as a hole.
fn welded(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut all = Vec::new();
    let mut known = HashMap::new();
    let numbers: Vec<u32> = positions
        .iter()
        .map(|&at| {
            *known.entry(at.map(f32::to_bits)).or_insert_with(|| {
                all.push(at);
                all.len() as u32 - 1
            })
        })
        .collect();
    let triangles = triangles.iter().map(|t| t.map(|k| numbers[k as usize]));
    let triangles = triangles.collect();
    (all, triangles)
}

#[test]
fn gpu_a_million_places_of_triangles_of_blocks_keep_to_the_bound() {
    let Some(gpu) = for_test() else { return };
    let (start, mut places, mut largest) = (Instant::now(), 0, 0.0_f64);
    for (number, (terrain, cells)) in grounds().into_iter().enumerate() {
        let truth = Truth::new(&terrain);
        let mut stage = BlockStage::new(&gpu, &cells, SLOTS).expect("passes");
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
            let surface = drawn(&mut stage, &cells, &camera, tau);
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

/// What is measured above must be able to fail: by another ground, and by what is missing.
#[test]
fn gpu_other_ground_and_missing_triangles_of_blocks_are_caught() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrains::fbm(1);
    let cells = DetailCells::new(terrain.clone(), FINEST);
    let mut stage = BlockStage::new(&gpu, &cells, SLOTS).expect("passes");
    let camera = Camera {
        size: SIZE,
        ..around(&terrain, 2, 1)[1].1
    };
    let tau = 4.0;
    let good = drawn(&mut stage, &cells, &camera, tau);
    let of = |surface: &Surface, truth: &Truth| {
        let with = (Kind::Flying, camera);
        let count = judge(truth, surface, with, tau, 2000, &mut Random::new(1));
        (count.above(), count.measured().expect("seen").holes)
    };
    let truth = Truth::new(&terrain);
    assert_eq!(of(&good, &truth), (0, 0));
    assert!(of(&good, &Truth::new(&terrains::fbm(2))).0 > 100);
    let view = camera.view();
    let seen = good
        .triangles
        .iter()
        .position(|&t| good.corners(t).iter().all(|&corner| view.sees(corner)));
    let mut missing = good.clone();
    missing.triangles.remove(seen.expect("some are seen"));
    assert!(of(&missing, &truth).1 >= 1);
}
