//! What keys of a clip are chosen from, and what they are measured against.

use super::choose::{Choice, Kinds, Sampled, rotation, vector, weights};
use super::metric::{Leverage, Shells};
use super::parts::{in_parts, threads};
use super::play::{Player, Pose, play};
use super::sample::{MorphTrack, Samples};
use crate::model::{Channel, Model, Property, Trs};
use crate::options::Options;
use glam::{DAffine3, DQuat, DVec3};

/// A sampled clip, the tree it moves, and where its nodes are in the world.
pub(super) struct Work<'a> {
    pub(super) samples: &'a Samples,
    model: &'a Model,
    pub(super) shells: &'a Shells,
    pub(super) rest: Pose,
    pub(super) leverage: Vec<Leverage>,
    moving: Vec<bool>,
    /// How many times as long a way within the mesh of a node with morph targets is in the world at rest.
    widths: Vec<f64>,
    pub(super) columns: Vec<Columns>,
    /// Matrices of the moving nodes at each sample, as the file has them.
    pub(super) truth: Vec<DAffine3>,
    pub(super) moved: Vec<usize>,
    /// Times of samples as f32 has them.
    pub(super) times: Vec<f64>,
    /// Samples on the file's own keys.
    common: Vec<usize>,
}

/// A track's properties apart.
pub(super) struct Columns {
    pub(super) translations: Vec<DVec3>,
    pub(super) rotations: Vec<DQuat>,
    pub(super) scales: Vec<DVec3>,
}

impl<'a> Work<'a> {
    pub(super) fn new(
        samples: &'a Samples,
        model: &'a Model,
        shells: &'a Shells,
        leverage: Vec<Leverage>,
        options: &Options,
    ) -> Self {
        let rest: Pose = model.nodes.iter().map(|node| node.rest).collect();
        let moving = shells.moved_by(samples.tracks.iter().map(|track| track.node));
        let moved: Vec<usize> = (0..moving.len()).filter(|&node| moving[node]).collect();
        let mut world = Vec::new();
        shells.world(&rest, &mut world);
        let mut widths = vec![1.0; rest.len()];
        for &node in samples.morphs.iter().flat_map(|morph| &morph.nodes) {
            widths[node] = shells.widest(model, node, &world);
        }
        let mut work = Self {
            widths,
            samples,
            model,
            shells,
            leverage,
            rest,
            moving,
            columns: samples
                .tracks
                .iter()
                .map(|track| columns(&track.poses))
                .collect(),
            truth: Vec::new(),
            common: samples
                .stops
                .iter()
                .copied()
                .filter(|&stop| samples.grid.keys[stop])
                .collect(),
            moved,
            times: samples
                .grid
                .labels
                .iter()
                .map(|&label| f64::from(label))
                .collect(),
        };
        work.truth = work.worlds(options);
        work
    }

    fn worlds(&self, options: &Options) -> Vec<DAffine3> {
        let count = self.samples.grid.len();
        let parts = in_parts(count, self.threads(options), |range| {
            let (mut pose, mut world) = (self.rest.clone(), Vec::new());
            self.shells.world(&pose, &mut world);
            let mut out = Vec::with_capacity(range.len() * self.moved.len());
            for i in range {
                for track in &self.samples.tracks {
                    pose[track.node] = track.poses[i];
                }
                self.shells
                    .world_where(&pose, &mut world, |node| self.moving[node]);
                out.extend(self.moved.iter().map(|&node| world[node]));
            }
            out
        });
        parts.into_iter().flatten().collect()
    }

    fn threads(&self, options: &Options) -> usize {
        threads(self.samples.grid.len() * self.samples.tracks.len(), options)
    }

    /// Keys that let each joint by itself do `error` metres wrong.
    pub(super) fn choose(&self, error: f64, kinds: &[Kinds], options: &Options) -> Vec<Choice> {
        let tracks = self.samples.tracks.len();
        let parts = in_parts(tracks, self.threads(options), |range| {
            range
                .flat_map(|index| self.choose_track(index, error, kinds))
                .collect::<Vec<_>>()
        });
        let mut choices: Vec<Choice> = parts.into_iter().flatten().collect();
        for morph in &self.samples.morphs {
            let kind = kinds.get(choices.len()).copied().unwrap_or_default();
            // Morph targets are told apart by their channel's kind only where parts of a clip must agree.
            let kind = match kind {
                Kinds::OnlyLinear | Kinds::OnlyCubic => kind,
                _ => Kinds::Any,
            };
            choices.extend(self.choose_morph(morph, error, kind));
        }
        choices
    }

    fn choose_track(&self, index: usize, error: f64, kinds: &[Kinds]) -> [Choice; 3] {
        let (track, columns) = (&self.samples.tracks[index], &self.columns[index]);
        let lever = self.leverage[track.node];
        let rest = self.rest[track.node];
        let sampled = |property: usize| {
            self.sampled(
                track.node,
                kinds.get(index * 3 + property).copied().unwrap_or_default(),
            )
        };
        [
            vector(
                &sampled(0),
                Property::Translation,
                &columns.translations,
                rest.translation,
                error / lever.translation,
            ),
            rotation(
                &sampled(1),
                &columns.rotations,
                rest.rotation,
                error / lever.rotation,
            ),
            vector(
                &sampled(2),
                Property::Scale,
                &columns.scales,
                rest.scale,
                error / lever.scale,
            ),
        ]
    }

    fn choose_morph(&self, morph: &MorphTrack, error: f64, kind: Kinds) -> Vec<Choice> {
        let values: Vec<Vec<f64>> = morph
            .weights
            .chunks(morph.targets)
            .map(<[f64]>::to_vec)
            .collect();
        let targets = &self.model.meshes[morph.mesh].targets;
        let rest: Vec<f64> = targets.iter().map(|target| target.rest).collect();
        morph
            .nodes
            .iter()
            .map(|&node| {
                // A skinned mesh may be scaled by its joints; they are as large as their shells say.
                let scale = self.leverage[node]
                    .translation
                    .max(self.widths[node])
                    .max(1.0);
                let reach: Vec<f64> = targets.iter().map(|target| target.reach * scale).collect();
                weights(&self.sampled(node, kind), &values, &rest, &reach, error)
            })
            .collect()
    }

    fn sampled(&self, node: usize, kinds: Kinds) -> Sampled<'_> {
        Sampled {
            node,
            times: &self.times,
            jumps: &self.samples.grid.jumps,
            stops: &self.samples.stops,
            common: &self.common,
            kinds,
        }
    }

    /// The largest distance of the played keys from the samples, metres: of joints, and of morph
    /// targets.
    pub(super) fn error(&self, choices: &[Choice], options: &Options) -> f64 {
        let channels: Vec<&Channel> = choices.iter().map(|choice| &choice.channel).collect();
        let parts = in_parts(self.samples.grid.len(), self.threads(options), |range| {
            let (mut pose, mut world) = (self.rest.clone(), Vec::new());
            // What has one key is where that says at all times.
            let all = channels.iter().map(|channel| Player::new(channel));
            let (mut still, mut players): (Vec<_>, Vec<_>) = all.partition(Player::stands);
            play(&mut still, 0.0, &mut pose, |_, _| ());
            self.shells.world(&pose, &mut world);
            let mut farthest = 0.0_f64;
            for i in range {
                let time = f64::from(self.samples.grid.labels[i]);
                let mut morphed = 0.0_f64;
                play(&mut players, time, &mut pose, |node, weights| {
                    morphed = morphed.max(self.morph_error(node, i, weights));
                });
                self.shells
                    .world_where(&pose, &mut world, |node| self.moving[node]);
                let truth = &self.truth[i * self.moved.len()..];
                let apart = self.moved.iter().zip(truth);
                let apart =
                    apart.map(|(&node, truth)| self.shells.apart(node, truth, &world[node]));
                farthest = farthest.max(apart.fold(0.0, f64::max).sqrt() + morphed);
            }
            farthest
        });
        parts.into_iter().fold(0.0, f64::max)
    }

    /// What one unit of any of a node's morph weights moves at most, metres.
    pub(super) fn reach(&self, node: usize) -> f64 {
        let morphs = self.samples.morphs.iter();
        let own = morphs.filter(|morph| morph.nodes.contains(&node));
        let targets = own.flat_map(|morph| &self.model.meshes[morph.mesh].targets);
        let scale = self.leverage[node].translation.max(1.0);
        targets
            .map(|target| target.reach * scale)
            .fold(0.0, f64::max)
    }

    /// What morph targets alone are off by at each sample, metres.
    pub(super) fn morph_errors(&self, choices: &[Choice]) -> Vec<f64> {
        let mut out = vec![0.0_f64; self.times.len()];
        let weights = choices.iter().map(|choice| &choice.channel);
        for channel in weights.filter(|channel| channel.property == Property::Weights) {
            let mut player = Player::new(channel);
            let mut numbers = vec![0.0; player.width()];
            for (i, out) in out.iter_mut().enumerate() {
                player.at(self.times[i], &mut numbers);
                *out = out.max(self.morph_error(channel.node, i, &numbers));
            }
        }
        out
    }

    fn morph_error(&self, node: usize, sample: usize, weights: &[f64]) -> f64 {
        let Some(morph) = self
            .samples
            .morphs
            .iter()
            .find(|morph| morph.nodes.contains(&node))
        else {
            return 0.0;
        };
        let truth = &morph.weights[sample * morph.targets..(sample + 1) * morph.targets];
        let targets = &self.model.meshes[morph.mesh].targets;
        let each = truth.iter().zip(weights).zip(targets);
        each.map(|((a, b), target)| (a - b).abs() * target.reach)
            .sum::<f64>()
            * self.widths[node]
    }
}

fn columns(poses: &[Trs]) -> Columns {
    let mut rotations: Vec<DQuat> = poses.iter().map(|pose| pose.rotation).collect();
    for i in 1..rotations.len() {
        if rotations[i].dot(rotations[i - 1]) < 0.0 {
            rotations[i] = -rotations[i];
        }
    }
    Columns {
        translations: poses.iter().map(|pose| pose.translation).collect(),
        rotations,
        scales: poses.iter().map(|pose| pose.scale).collect(),
    }
}
