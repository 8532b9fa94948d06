//! What the passes that choose and make blocks take on the adapter, one by one.

use crate::scenes::camera::Camera;
use crate::scenes::selection::{bound, ground_of, params};
use bevy::math::DVec3;
use dolomite_terrain::Terrain;
use dolomite_testkit::blocks::{BlockError, BlockRun, BlockStage};
use dolomite_testkit::gpu::Gpu;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Slots of blocks, about as many as a view of the game has by default.
const SLOTS: u32 = 1 << 13;
/// Vertices and triangles.
const POOL: [u32; 2] = [1 << 19, 1 << 20];
/// Most blocks that a choice makes.
const BUDGET: u32 = 64;
/// Most choices until a view is settled.
const MOST: usize = 1000;
/// The camera goes so far from one choice to the next, metres a step; at 60 frames a second 600 m/s, as the
/// path of the classic scene has it.
const STEP: f64 = 10.0;
/// Choices on the way; medians count.
const STEPS: usize = 5;

/// Times of a view's choices, milliseconds by passes.
type Entries = BTreeMap<&'static str, f64>;

fn add(entries: &mut Entries, run: &BlockRun) {
    for pass in &run.passes {
        *entries.entry(pass.entry).or_default() += pass.time.as_secs_f64() * 1e3;
    }
}

/// Milliseconds of each pass at `tau` pixels with cells down to `finest` metres: of all choices from the first on, which has
/// only the roots, to the one that has nothing to make; of one more of the same view, which an app leaves out; of
/// views a step of 10 m further each, each of one choice, which makes 64 blocks at most for the next.
///
/// # Errors
/// [`BlockError`].
///
/// # Panics
/// If the view is not settled after a thousand choices.
pub fn passes(
    gpu: &Gpu,
    terrain: &Terrain,
    camera: &Camera,
    tau: f64,
    finest: f32,
) -> Result<Value, BlockError> {
    let ground = ground_of(terrain, finest);
    let mut stage = BlockStage::new(gpu, &ground, SLOTS)?;
    stage.timed = true;
    let of = |camera: &Camera| params(&ground, camera, bound(tau), POOL);
    let (mut making, mut choices) = (Entries::new(), 0);
    let first = loop {
        let run = stage.run_unread(of(camera), BUDGET)?;
        add(&mut making, &run);
        choices += 1;
        let done = run.made == 0;
        if done || choices == MOST {
            assert!(done, "not settled after {MOST} choices");
            break run;
        }
    };
    let resting = stage.run(of(camera), BUDGET)?;
    let mut at_rest = Entries::new();
    add(&mut at_rest, &resting);
    let ahead = camera.view().forward;
    let mut moving: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let (mut used, mut made) = (vec![first.used], Vec::new());
    for k in 1..=STEPS {
        let way = DVec3::new(ahead.x, 0.0, ahead.z).normalize_or(DVec3::X);
        let next = Camera {
            eye: camera.eye + way * STEP * k as f64,
            ..*camera
        };
        let run = stage.run_unread(of(&next), BUDGET)?;
        used.push(run.used);
        made.push(run.made);
        let mut entries = Entries::new();
        add(&mut entries, &run);
        for (entry, time) in entries {
            moving.entry(entry).or_default().push(time);
        }
    }
    let moving = moving.into_iter().map(|(entry, times)| {
        let time = dolomite_testkit::metrics::median(times).unwrap_or(f64::NAN);
        (entry, time)
    });
    Ok(json!({
        "blocks": used,
        "blocks_made_a_step": made,
        "choices_until_settled": choices,
        "blocks_looked_at": resting.candidates,
        "blocks_drawn": resting.drawn,
        "vertices": resting.positions.len(),
        "triangles": resting.triangles.len(),
        "held": resting.coarsening.max(resting.left),
        "making_ms": told(making),
        "resting_ms": told(at_rest),
        "moving_ms": told(moving.collect()),
    }))
}

fn told(entries: Entries) -> Value {
    let all: f64 = entries.values().sum();
    let mut told = Map::new();
    told.insert("all".into(), json!(all));
    told.extend(entries.into_iter().map(|(k, v)| (k.to_owned(), json!(v))));
    Value::Object(told)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::cameras::{Kind, camera};
    use crate::scenes::terrains;
    use dolomite_ground::render::blocks::record::{Extras, steps};

    #[test]
    fn gpu_a_timed_choice_is_the_same_and_names_every_dispatch() {
        let Some(gpu) = dolomite_testkit::gpu::for_test() else {
            return;
        };
        let terrain = terrains::fbm(1);
        let ground = ground_of(&terrain, 0.25);
        let mut stage = BlockStage::new(&gpu, &ground, 1 << 12).unwrap();
        let camera = camera(&terrain, Kind::Flying, 1);
        let told = params(&ground, &camera, bound(8.0), [1 << 17, 1 << 18]);
        let (run, _) = stage.settle(told, BUDGET, MOST).unwrap();
        stage.timed = true;
        let timed = stage.run(told, BUDGET).unwrap();
        let places = |run: &BlockRun| -> Vec<[[u32; 3]; 3]> {
            let at = |k: u32| run.positions[k as usize].map(f32::to_bits);
            let mut all: Vec<_> = run.triangles.iter().map(|t| t.map(at)).collect();
            all.sort_unstable();
            all
        };
        assert!(run.triangles.len() > 1000 && places(&run) == places(&timed));
        // None where the device has no timestamps.
        if !timed.passes.is_empty() {
            assert_eq!(timed.passes.len(), steps(Extras::default()).count());
            assert_eq!(timed.passes.last().map(|pass| pass.entry), Some("finish"));
            let all: std::time::Duration = timed.passes.iter().map(|pass| pass.time).sum();
            assert!(
                !all.is_zero() && all <= timed.time,
                "{all:?} of {:?}",
                timed.time
            );
        }
    }
}
