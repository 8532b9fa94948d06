//! What the passes take: printed, not tested.

use super::support::{MOST, classic, laid_on_samples, picture_of};
use bevy::math::{DQuat, DVec2, DVec3, EulerRot, UVec2};
use dolomite_ground::detail::layout::DetailParams;
use dolomite_ground::detail::{DetailGround, DetailView, HorizonView, Lens, Metric, TerrainLod};
use dolomite_terrain::Terrain;
use dolomite_testkit::blocks::{BlockStage, PassTime};
use dolomite_testkit::gpu::{Gpu, for_test};
use std::collections::BTreeMap;

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
    fn params(&self, laid: &DetailGround, ahead: f64) -> DetailParams {
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
            ..DetailParams::new(laid, view, 0, [1 << 19, 1 << 20])
        };
        let picture = picture_of(&params, self.size, self.fov, turn);
        let horizon = HorizonView::new(laid, &params.view, &picture, params.anchor_height);
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

/// Prints the least time of each pass in so many runs, and what processors spent a run; the mesh is not read back.
fn resting(name: &str, runs: u32, mut run: impl FnMut() -> Vec<PassTime>) {
    let mut least: Vec<PassTime> = run();
    let before = processor_time();
    for _ in 0..runs {
        for (least, pass) in least.iter_mut().zip(run()) {
            least.time = least.time.min(pass.time);
        }
    }
    let spent = processor_time()
        .zip(before)
        .map(|(after, before)| (after - before) * 1e3 / f64::from(runs));
    println!(
        "  {name}, least of {runs}, {spent:.0?} ms of processors: {}",
        told(&least)
    );
}

/// Seconds of all threads so far, to 10 ms.
fn processor_time() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let mut words = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut ticks = || words.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / 100.0)
}

fn time(gpu: &Gpu, scene: &Scene) {
    let laid = laid_on_samples(&scene.terrain, scene.finest);
    let mut stage = BlockStage::new(gpu, &laid, 8192).expect("passes");
    let given = scene.params(&laid, 0.0);
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
    resting("resting", 12, || {
        stage.run_unread(given, 64).expect("runs").passes
    });
    for k in 1..=5 {
        let run = stage
            .run(scene.params(&laid, 10.0 * f64::from(k)), 64)
            .expect("runs");
        println!(
            "  moving, {} made, {} wished, coarsening {:.2}: {}",
            run.made,
            run.wishes,
            run.coarsening,
            told(&run.passes)
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
