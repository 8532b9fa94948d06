//! A crowd whose figures each blend three clips at moments of their own, on one core.

use super::method::{Input, Method, processor_time};
use super::methods;
use super::model::Model;
use crate::csv::Row;
use crate::study::Options;
use dolomite_testkit::metrics::median;
use dolomite_testkit::random::Random;
use std::time::{Duration, Instant};

/// Shortest timed run: ten ticks and more of the kernel's clock, by which it counts processor time.
const LEAST: Duration = Duration::from_millis(100);
/// Seconds of a frame.
const DT: f32 = 1.0 / 60.0;

/// A row for each method: local poses; and one more with matrices, of those that make them.
pub fn rows(model: &Model, options: &Options, figures: usize) -> Vec<Row> {
    let mut random = Random::new(options.seed ^ 0xc0de);
    let crowd: Vec<[Input; 3]> = (0..figures)
        .map(|_| {
            model.blended.map(|clip| Input {
                clip,
                time: random.range(0.0, model.rig.clips[clip].duration()),
                weight: random.range(0.1, 1.0),
            })
        })
        .collect();
    let mut rows = Vec::new();
    for method in &mut methods(model, model.blended) {
        method.crowd(&crowd);
        for (model_too, quantity) in [(false, "sampled and blended"), (true, "and model matrices")]
        {
            let joints = (figures * model.rig.skeleton.len()) as f64;
            if let Some(frame) = time(method.as_mut(), options.repeats, model_too) {
                rows.push(row(method.as_ref(), quantity, figures, frame / joints));
            }
        }
    }
    rows
}

/// Nanoseconds of processor time a frame.
fn time(method: &mut dyn Method, repeats: usize, model: bool) -> Option<f64> {
    // The first frame makes buffers.
    if !method.frame(DT, model) {
        return None;
    }
    let start = Instant::now();
    let times = (0..repeats.max(1)).map(|_| {
        let before = processor_time(start);
        let mut frames = 0;
        loop {
            method.frame(DT, model);
            frames += 1;
            let spent = processor_time(start) - before;
            if spent >= LEAST {
                return spent.as_secs_f64() * 1e9 / f64::from(frames);
            }
        }
    });
    median(times.collect())
}

fn row(method: &dyn Method, quantity: &str, figures: usize, ns: f64) -> Row {
    Row {
        sweep: "speed".into(),
        method: method.name().into(),
        parameter: "figures".into(),
        parameter_value: figures as f64,
        quantity: quantity.into(),
        error: None,
        error_unit: String::new(),
        time_ns: Some(ns),
        bytes: method.bytes(),
        vertices: None,
        hash: None,
        device: "cpu".into(),
    }
}
