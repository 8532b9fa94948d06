//! The file's pose and the keys' pose at a time, and how far they are apart.

use super::skin::vertex_distance;
use crate::clips::{MorphCurves, Player, Pose, Shells, Source, play};
use crate::curves::{NodeCurves, Reading};
use crate::model::{Clip, Property, Trs};
use glam::{DAffine3, DQuat, DVec3};

/// Both poses of one clip.
pub(super) struct Actors<'a> {
    source: &'a Source<'a, 'a>,
    shells: &'a Shells,
    begin: f64,
    curves: Vec<(usize, NodeCurves<'a>)>,
    morphs: Vec<Morph<'a>>,
    players: Vec<Player<'a>>,
    moving: &'a [bool],
    truth: Pose,
    played: Pose,
    true_world: Vec<DAffine3>,
    world: Vec<DAffine3>,
}

struct Morph<'a> {
    mesh: usize,
    curves: MorphCurves<'a>,
    weights: Vec<f64>,
}

impl<'a> Actors<'a> {
    pub(super) fn of(
        source: &'a Source<'a, 'a>,
        shells: &'a Shells,
        clip: &'a Clip,
        moving: &'a [bool],
        reading: Reading,
    ) -> Self {
        let rest: Pose = source.model.nodes.iter().map(|node| node.rest).collect();
        let layers = source.take.layers(reading);
        let written: Pose = rest.iter().map(rounded).collect();
        let (mut true_world, mut world) = (Vec::new(), Vec::new());
        shells.world(&rest, &mut true_world);
        shells.world(&written, &mut world);
        let curves = source.take.moving.iter();
        let mut played = written;
        let (mut still, mut players) = (Vec::new(), Vec::new());
        for channel in &clip.channels {
            let stands = channel.times.len() == 1 && channel.property != Property::Weights;
            let list = if stands { &mut still } else { &mut players };
            list.push(Player::new(channel));
        }
        play(&mut still, 0.0, &mut played, |_, _| ());
        Self {
            curves: curves
                .map(|&node| (node, source.take.curves(&layers, node)))
                .collect(),
            morphs: source
                .take
                .meshes
                .iter()
                .map(|&mesh| Morph {
                    mesh,
                    curves: source.take.morph(&layers, mesh),
                    weights: Vec::new(),
                })
                .collect(),
            players,
            played,
            truth: rest,
            true_world,
            world,
            begin: clip.begin,
            source,
            shells,
            moving,
        }
    }

    /// The file's poses alone, at `time`.
    fn true_pose(&mut self, time: f64) {
        for (node, curves) in &mut self.curves {
            self.truth[*node] = curves.at(time);
        }
        self.shells.world(&self.truth, &mut self.true_world);
    }

    /// How far what two readings of the same layers show at `time` is apart, metres at the shells.
    pub(super) fn otherwise(&mut self, other: &mut Self, time: f64) -> f64 {
        self.true_pose(time);
        other.true_pose(time);
        self.shells
            .distance(&self.true_world, &other.true_world, self.moving)
    }

    /// How far the keys are from the curves at `time`, seconds on the file's clock: metres.
    pub(super) fn apart(&mut self, time: f64) -> f64 {
        let morphed = self.pose(time);
        let apart = self
            .shells
            .distance(&self.true_world, &self.world, self.moving);
        apart + morphed
    }

    /// The distance of shells, and that of the vertices, without that of morph targets.
    pub(super) fn both(&mut self, time: f64) -> (f64, f64) {
        self.pose(time);
        let shells = self
            .shells
            .distance(&self.true_world, &self.world, self.moving);
        let vertices = vertex_distance(
            self.source.model,
            &self.true_world,
            &self.world,
            self.moving,
        );
        (shells, vertices)
    }

    fn pose(&mut self, time: f64) -> f64 {
        for (node, curves) in &mut self.curves {
            self.truth[*node] = curves.at(time);
        }
        for morph in &mut self.morphs {
            morph.weights.clear();
            morph.curves.at(time, &mut morph.weights);
        }
        let (model, morphs) = (self.source.model, &self.morphs);
        let mut morphed: Vec<(usize, f64)> = Vec::new();
        let label = (time - self.begin).max(0.0);
        play(
            &mut self.players,
            label,
            &mut self.played,
            |node, weights| {
                let mesh = model.nodes[node].mesh;
                let Some(morph) = morphs.iter().find(|morph| mesh == Some(morph.mesh)) else {
                    return;
                };
                let targets = &model.meshes[morph.mesh].targets;
                let each = morph.weights.iter().zip(weights).zip(targets);
                let sum: f64 = each
                    .map(|((a, b), target)| (a - b).abs() * target.reach)
                    .sum();
                morphed.push((node, sum));
            },
        );
        let moves = |node: usize| self.moving[node];
        self.shells
            .world_where(&self.truth, &mut self.true_world, moves);
        self.shells
            .world_where(&self.played, &mut self.world, moves);
        morphed
            .into_iter()
            .map(|(node, sum)| sum * self.shells.widest(model, node, &self.true_world))
            .fold(0.0, f64::max)
    }
}

/// As it is written.
fn rounded(rest: &Trs) -> Trs {
    let vector = |v: DVec3| v.as_vec3().as_dvec3();
    let rotation = rest.rotation.as_quat();
    Trs {
        translation: vector(rest.translation),
        rotation: DQuat::from_array(rotation.to_array().map(f64::from)).normalize(),
        scale: vector(rest.scale),
    }
}
