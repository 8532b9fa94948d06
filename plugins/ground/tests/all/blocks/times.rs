//! What the passes take, beside those of single cells: printed, not tested.

use super::support::{MOST, picture_of};
use bevy::math::{DQuat, DVec2, DVec3, EulerRot, UVec2};
use dolomite_ground::detail::layout::DetailParams;
use dolomite_ground::detail::{DetailCells, DetailView, HorizonView, Lens, Metric, TerrainLod};
use dolomite_terrain::{
    Filter, GroundPoint, GroundRect, HeightMap, Layer, Source, Terrain, TerrainData,
};
use dolomite_testkit::blocks::BlockStage;
use dolomite_testkit::detail::{DetailStage, PassTime};
use dolomite_testkit::gpu::{Gpu, for_test};
use std::collections::BTreeMap;

/// The classic scene's ground, where the shared data are.
fn classic() -> Option<Terrain> {
    let shared = std::env::var_os("DOLOMITE_SHARED")?;
    let file = std::path::Path::new(&shared).join("data/classic/heights_1024_f32le.raw");
    let bytes = std::fs::read(file).ok()?;
    let heights: Vec<f32> = bytes
        .as_chunks::<4>()
        .0
        .iter()
        .map(|&bytes| 100.0 * f32::from_le_bytes(bytes))
        .collect();
    let at = |k: usize| (k + 1023) & 1023;
    let metres = (0..1026 * 1026)
        .map(|k| heights[at(k / 1026) * 1024 + at(k % 1026)])
        .collect();
    let (first, spacing) = (DVec2::splat(-512.5), DVec2::ONE);
    let map = HeightMap::new(1026, 1026, metres, first, spacing, Filter::Bilinear).ok()?;
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 1024.0),
        layers: vec![Layer {
            source: Source::Map(map),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    })
    .ok()
}

struct Scene {
    name: &'static str,
    terrain: Terrain,
    eye: DVec3,
    turn: [f64; 2],
    size: UVec2,
    fov: f64,
    finest: f32,
}

impl Scene {
    fn params(&self, cells: &DetailCells, ahead: f64) -> DetailParams {
        let [yaw, pitch] = self.turn;
        let turn = DQuat::from_euler(EulerRot::YXZ, yaw, pitch, 0.0);
        let way = turn * DVec3::NEG_Z;
        let eye = self.eye + DVec3::new(way.x, 0.0, way.z).normalize() * ahead;
        let lens = Lens::Perspective(f64::from(bevy::math::ops::tan(self.fov as f32 / 2.0)));
        let mut view = DetailView::new(eye, turn, lens, self.size, 0.1);
        view.set_metric(&TerrainLod {
            metric: Metric::ErrorBound { pixels: 1.0 },
            ..TerrainLod::default()
        });
        let params = DetailParams {
            anchor_height: eye.y.floor() as f32,
            ..DetailParams::new(cells, view, 0, [1 << 19, 1 << 20])
        };
        let picture = picture_of(&params, self.size, self.fov, turn);
        let horizon = HorizonView::new(cells, &params.view, &picture, params.anchor_height);
        let culled = params.cull(&picture, false);
        horizon.map_or(culled, |horizon| culled.occlude(horizon))
    }
}

fn told(passes: &[PassTime]) -> String {
    let mut entries: BTreeMap<&str, f64> = BTreeMap::new();
    for pass in passes {
        *entries.entry(pass.entry).or_default() += pass.time.as_secs_f64() * 1e3;
    }
    let all: f64 = entries.values().sum();
    let parts: Vec<_> = entries
        .iter()
        .map(|(name, ms)| format!("{name} {ms:.2}"))
        .collect();
    format!("{all:.1} ms: {}", parts.join(", "))
}

fn time(gpu: &Gpu, scene: &Scene) {
    let mut cells = DetailCells::new(scene.terrain.clone(), scene.finest);
    if scene.name == "classic" {
        // On the samples of the map.
        cells.lattice.origin = GroundPoint::new(DVec2::splat(-512.5));
    }
    let mut stage = BlockStage::new(gpu, &cells, 8192).expect("passes");
    let given = scene.params(&cells, 0.0);
    let (run, frames) = stage.settle(given, 64, MOST).expect("runs");
    println!(
        "{}: {frames} choices, {} blocks, {} looked at, {} drawn, {} vertices, {} triangles, {} of the tolerance",
        scene.name,
        run.used,
        run.candidates,
        run.drawn,
        run.positions.len(),
        run.triangles.len(),
        run.coarsening.max(run.left)
    );
    stage.timed = true;
    for _ in 0..5 {
        let run = stage.run(given, 64).expect("runs");
        println!("  resting {}", told(&run.passes));
    }
    for k in 1..=5 {
        let run = stage
            .run(scene.params(&cells, 10.0 * f64::from(k)), 64)
            .expect("runs");
        println!(
            "  moving, {} made, {} wished, coarsening {:.2}: {}",
            run.made,
            run.wishes,
            run.coarsening,
            told(&run.passes)
        );
    }
    if std::env::var_os("BLOCKS_ALONE").is_some() {
        return;
    }
    let cells = DetailCells::new(scene.terrain.clone(), scene.finest);
    let mut stage = DetailStage::new(gpu, &cells, 1 << 20).expect("passes");
    let given = scene.params(&cells, 0.0);
    for name in ["first", "resting", "resting"] {
        let (run, passes) = stage.run_timed(given).expect("runs");
        println!(
            "  single cells, {name}: {} triangles, {}",
            run.triangles.len(),
            told(&passes)
        );
    }
}

#[test]
#[ignore = "prints times"]
fn gpu_times_of_the_passes() {
    let Some(gpu) = for_test() else { return };
    let mut scenes = Vec::new();
    if let Some(terrain) = classic() {
        scenes.push(Scene {
            name: "classic",
            terrain,
            eye: DVec3::new(200.0, 70.0, 0.0),
            turn: [
                std::f64::consts::PI,
                f64::from(bevy::math::ops::atan(-0.25)),
            ],
            size: UVec2::new(1280, 720),
            fov: 60.0_f64.to_radians(),
            finest: 0.25,
        });
    }
    let terrain = super::support::mountain();
    let xz = DVec2::new(1000.0, -2000.0);
    let height = terrain.sample_f64(xz).height.max(0.0);
    scenes.push(Scene {
        name: "mountain",
        terrain,
        eye: DVec3::new(xz.x, height + 1.7, xz.y),
        turn: [0.7, -0.05],
        size: UVec2::new(640, 360),
        fov: 60.0_f64.to_radians(),
        finest: TerrainLod::default().finest,
    });
    for scene in &scenes {
        time(&gpu, scene);
    }
}
