//! Joints at random moments of all clips against f64.

use super::method::{Input, Method};
use super::methods;
use super::model::Model;
use crate::csv::Row;
use crate::study::Options;
use dolomite_character::clip::oracle::{self, Transform64};
use dolomite_testkit::metrics::{ErrorStats, Hash64};
use dolomite_testkit::random::Random;

/// A row for each method: distances of joints from where f64 has them, metres.
pub fn rows(model: &Model, options: &Options) -> Vec<Row> {
    let mut random = Random::new(options.seed);
    let moments: Vec<Input> = (0..options.samples)
        .map(|index| {
            let clip = index % model.rig.clips.len();
            Input {
                clip,
                time: random.range(0.0, model.rig.clips[clip].duration()),
                weight: 1.0,
            }
        })
        .collect();
    let truth: Vec<Vec<[f64; 3]>> = moments
        .iter()
        .map(|input| {
            let data = &model.rig.sources[input.clip];
            places(
                model,
                &oracle::sample(&model.rig.skeleton, data, f64::from(input.time)),
            )
        })
        .collect();
    methods(model, model.blended)
        .iter_mut()
        .map(|method| row(model, method.as_mut(), &moments, &truth))
        .collect()
}

/// Positions of all joints in the model's frame. In f64, so that a method's error is that of its local
/// transforms; ours is measured with its own f32 matrices by the tests of its crate.
pub fn places(model: &Model, pose: &[Transform64]) -> Vec<[f64; 3]> {
    oracle::local_to_model(&model.rig.skeleton, pose)
        .iter()
        .map(|matrix| [matrix[0][3], matrix[1][3], matrix[2][3]])
        .collect()
}

fn row(model: &Model, method: &mut dyn Method, moments: &[Input], truth: &[Vec<[f64; 3]>]) -> Row {
    let mut errors = Vec::with_capacity(moments.len() * model.rig.skeleton.len());
    let mut hash = Hash64::default();
    for (input, truth) in moments.iter().zip(truth) {
        let pose = method.blend(&[*input]);
        for (place, truth) in places(model, &pose).iter().zip(truth) {
            let square: f64 = place
                .iter()
                .zip(truth)
                .map(|(a, b)| (a - b) * (a - b))
                .sum();
            errors.push(square.sqrt());
            place.iter().for_each(|number| hash.add(number.to_bits()));
        }
    }
    Row {
        sweep: "sampling".into(),
        method: method.name().into(),
        parameter: "clips".into(),
        parameter_value: model.rig.clips.len() as f64,
        quantity: "joint position".into(),
        error: ErrorStats::of(errors).map(Into::into),
        error_unit: "m".into(),
        time_ns: None,
        bytes: method.bytes(),
        vertices: None,
        hash: Some(hash.finish()),
        device: "cpu".into(),
    }
}
