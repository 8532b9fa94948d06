//! Dolomite's own.

use super::method::{Input, Method};
use super::model::Model;
use bevy::math::Affine3A;
use dolomite_character::clip::oracle::Transform64;
use dolomite_character::{Blender, Clip, Layer, Pose, Sampler, Skeleton};

/// `dolomite_character`.
pub struct Ours {
    skeleton: Skeleton,
    clips: Vec<Clip>,
    sampler: Sampler,
    blender: Blender,
    samples: Vec<Pose>,
    figures: Vec<Figure>,
}

/// A figure of the crowd.
struct Figure {
    inputs: [Input; 3],
    pose: Pose,
    model: Vec<Affine3A>,
}

impl Ours {
    /// Of a model.
    pub fn new(model: &Model) -> Self {
        Self {
            skeleton: model.rig.skeleton.clone(),
            clips: model.rig.clips.clone(),
            sampler: Sampler::new(),
            blender: Blender::new(),
            samples: Vec::new(),
            figures: Vec::new(),
        }
    }
}

/// As f64.
pub fn wide(pose: &Pose) -> Vec<Transform64> {
    (0..pose.len())
        .map(|joint| {
            let local = pose.get(joint);
            Transform64 {
                translation: local.translation.to_array().map(f64::from),
                rotation: local.rotation.to_array().map(f64::from),
                scale: local.scale.to_array().map(f64::from),
            }
        })
        .collect()
}

impl Method for Ours {
    fn name(&self) -> &'static str {
        "ours"
    }

    fn blend(&mut self, inputs: &[Input]) -> Vec<Transform64> {
        self.samples
            .resize(inputs.len().max(self.samples.len()), Pose::default());
        for (input, sample) in inputs.iter().zip(&mut self.samples) {
            self.sampler
                .sample(&self.clips[input.clip], input.time, sample);
        }
        if inputs.len() == 1 {
            return wide(&self.samples[0]);
        }
        let layers: Vec<Layer> = inputs
            .iter()
            .zip(&self.samples)
            .map(|(input, pose)| Layer {
                pose,
                weight: input.weight,
                mask: None,
            })
            .collect();
        let mut out = Pose::default();
        self.blender.blend(self.skeleton.rest(), &layers, &mut out);
        wide(&out)
    }

    fn crowd(&mut self, figures: &[[Input; 3]]) {
        self.samples.resize(3, Pose::default());
        self.figures = figures
            .iter()
            .map(|inputs| Figure {
                inputs: *inputs,
                pose: Pose::default(),
                model: Vec::new(),
            })
            .collect();
    }

    fn frame(&mut self, dt: f32, model: bool) -> bool {
        let Self {
            skeleton,
            clips,
            sampler,
            blender,
            samples,
            figures,
        } = self;
        for figure in figures {
            for (input, sample) in figure.inputs.iter_mut().zip(samples.iter_mut()) {
                let clip = &clips[input.clip];
                input.time = clip.looped(input.time + dt);
                sampler.sample(clip, input.time, sample);
            }
            let layers: [Layer; 3] = core::array::from_fn(|i| Layer {
                pose: &samples[i],
                weight: figure.inputs[i].weight,
                mask: None,
            });
            blender.blend(skeleton.rest(), &layers, &mut figure.pose);
            if model {
                skeleton.local_to_model(&figure.pose, &mut figure.model);
            }
        }
        true
    }

    fn bytes(&self) -> Option<usize> {
        Some(self.clips.iter().map(Clip::bytes).sum())
    }
}
