//! Blends of three clips: what the order of the inputs does, and how far from the weighted mean in f64.

use super::method::Input;
use super::methods;
use super::model::Model;
use crate::csv::Row;
use crate::study::Options;
use dolomite_character::clip::oracle::{self, Transform64};
use dolomite_testkit::metrics::ErrorStats;
use dolomite_testkit::random::Random;

/// All orders of three.
const ORDERS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [0, 2, 1],
    [1, 0, 2],
    [1, 2, 0],
    [2, 0, 1],
    [2, 1, 0],
];

/// Two rows for each method: the greatest angle between two orders, and, of ours, the angle from f64.
pub fn rows(model: &Model, options: &Options) -> Vec<Row> {
    let mut random = Random::new(options.seed ^ 0x5eed);
    let count = (options.samples / 64).clamp(16, 2000);
    let triples: Vec<[Input; 3]> = (0..count).map(|_| triple(model, &mut random)).collect();
    // For each method, order and triple: the pose. A method may know its order from the start.
    let mut poses: Vec<(&'static str, Vec<Vec<Vec<Transform64>>>)> = Vec::new();
    for order in ORDERS {
        for (index, method) in methods(model, order.map(|i| model.blended[i]))
            .iter_mut()
            .enumerate()
        {
            if poses.len() == index {
                poses.push((method.name(), Vec::new()));
            }
            let blends = triples
                .iter()
                .map(|inputs| method.blend(&order.map(|i| inputs[i])));
            poses[index].1.push(blends.collect());
        }
    }
    let mut rows = Vec::new();
    for (name, orders) in &poses {
        let mut differences = Vec::new();
        for triple in 0..triples.len() {
            for joint in 0..model.rig.skeleton.len() {
                let worst = orders[1..]
                    .iter()
                    .map(|other| angle(&orders[0][triple][joint], &other[triple][joint]))
                    .fold(0.0, f64::max);
                differences.push(worst);
            }
        }
        rows.push(row(name, "difference between orders", differences));
    }
    let exact = triples
        .iter()
        .zip(&poses[0].1[0])
        .flat_map(|(inputs, blended)| {
            let truth = truth(model, inputs);
            let pairs: Vec<f64> = truth
                .iter()
                .zip(blended)
                .map(|(a, b)| angle(a, b))
                .collect();
            pairs
        });
    rows.push(row(poses[0].0, "rotation", exact.collect()));
    rows
}

fn triple(model: &Model, random: &mut Random) -> [Input; 3] {
    model.blended.map(|clip| Input {
        clip,
        time: random.range(0.0, model.rig.clips[clip].duration()),
        weight: random.range(0.1, 1.0),
    })
}

fn truth(model: &Model, inputs: &[Input; 3]) -> Vec<Transform64> {
    let poses: Vec<(Vec<Transform64>, f64)> = inputs
        .iter()
        .map(|input| {
            let data = &model.rig.sources[input.clip];
            let pose = oracle::sample(&model.rig.skeleton, data, f64::from(input.time));
            (pose, f64::from(input.weight))
        })
        .collect();
    oracle::blend(&poses)
}

fn angle(a: &Transform64, b: &Transform64) -> f64 {
    oracle::angle(a.rotation, b.rotation)
}

fn row(method: &str, quantity: &str, errors: Vec<f64>) -> Row {
    Row {
        sweep: "blending".into(),
        method: method.into(),
        parameter: "inputs".into(),
        parameter_value: 3.0,
        quantity: quantity.into(),
        error: ErrorStats::of(errors).map(Into::into),
        error_unit: "rad".into(),
        time_ns: None,
        bytes: None,
        vertices: None,
        hash: None,
        device: "cpu".into(),
    }
}
