//! What the passes of a choice take on the adapter, one by one.

use crate::scenes::camera::Camera;
use crate::scenes::selection::{bound, detail_view};
use bevy::math::DVec3;
use dolomite_ground::detail::DetailCells;
use dolomite_ground::detail::layout::DetailParams;
use dolomite_terrain::Terrain;
use dolomite_testkit::detail::{DetailError, DetailStage};
use dolomite_testkit::gpu::Gpu;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Cells that there is room for, as in the game.
const CAPACITY: u32 = 1 << 20;
/// Vertices and triangles.
const POOL: [u32; 2] = [1 << 19, 1 << 20];
/// The camera goes so far from one choice to the next, metres a step; at 60 frames a second 600 m/s, as the
/// path of the classic scene has it.
const STEP: f64 = 10.0;
/// Choices on the way; medians count.
const STEPS: usize = 5;

/// Milliseconds of each pass at `tau` pixels with cells down to `finest` metres: of the first choice, which has
/// all cells to make; of one more of the same view, which has none; of views a step of 10 m further each.
///
/// # Errors
/// [`DetailError`].
pub fn passes(
    gpu: &Gpu,
    terrain: &Terrain,
    camera: &Camera,
    tau: f64,
    finest: f32,
) -> Result<Value, DetailError> {
    let cells = DetailCells::new(terrain.clone(), finest);
    let mut stage = DetailStage::new(gpu, &cells, CAPACITY)?;
    let mut choose = |camera: &Camera| {
        let view = detail_view(camera, bound(tau));
        let (run, times) = stage.run_timed(DetailParams::new(&cells, view, 0, POOL))?;
        let mut entries: BTreeMap<&str, f64> = BTreeMap::new();
        for pass in &times {
            *entries.entry(pass.entry).or_default() += pass.time.as_secs_f64() * 1e3;
        }
        Ok::<_, DetailError>((run, entries))
    };
    let (first, making) = choose(camera)?;
    let (_, resting) = choose(camera)?;
    let ahead = camera.view().forward;
    let mut moving: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let mut used = vec![first.used];
    for k in 1..=STEPS {
        let way = DVec3::new(ahead.x, 0.0, ahead.z).normalize_or(DVec3::X);
        let (run, entries) = choose(&Camera {
            eye: camera.eye + way * STEP * k as f64,
            ..*camera
        })?;
        used.push(run.used);
        for (entry, time) in entries {
            moving.entry(entry).or_default().push(time);
        }
    }
    let moving = moving.into_iter().map(|(entry, times)| {
        let time = dolomite_testkit::metrics::median(times).unwrap_or(f64::NAN);
        (entry, time)
    });
    Ok(json!({
        "cells_made": used,
        "vertices": first.positions.len(),
        "triangles": first.triangles.len(),
        "first_ms": told(making),
        "resting_ms": told(resting),
        "moving_ms": told(moving.collect()),
    }))
}

fn told(entries: BTreeMap<&str, f64>) -> Value {
    let all: f64 = entries.values().sum();
    let mut told = Map::new();
    told.insert("all".into(), json!(all));
    told.extend(entries.into_iter().map(|(k, v)| (k.to_owned(), json!(v))));
    Value::Object(told)
}
