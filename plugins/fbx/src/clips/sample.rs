//! The poses of a clip as the FBX file has them, in f64.

use super::grid::{Grid, Plan};
use super::keys::{BLENDS, MOVES};
use super::parts::{in_parts, threads};
use super::value::Value;
use crate::curves::{BlendWeight, Layers, Majorant, NodeCurves, Over, Reading};
use crate::error::FbxError;
use crate::model::{Model, Trs};
use crate::options::{Budget, Options};
use crate::read::ShapeKey;
use crate::read::shapes::{shape_rates, shape_weights, stops};
use glam::DQuat;
use std::ops::Range;
use ufbx::{AnimStack, ElementType, SceneRoot};

/// A node that moves, and where it is at each time.
pub(crate) struct Track {
    pub(crate) node: usize,
    /// One of its angles changes much between two keys, so that it counts what it does there however
    /// near these are.
    pub(crate) spins: bool,
    pub(crate) poses: Vec<Trs>,
}

impl Track {
    /// Puts what lies within frames onto the straight way from key to key, unless the node spins.
    fn straighten(&mut self, grid: &Grid) {
        if self.spins {
            return;
        }
        let mut from = 0;
        for to in 1..grid.len() {
            if grid.within[to - 1] && !grid.keys[to] {
                continue;
            }
            let length = grid.times[to] - grid.times[from];
            for i in from + 1..to {
                let share = (grid.times[i] - grid.times[from]) / length;
                self.poses[i] = between(&self.poses[from], &self.poses[to], share);
            }
            from = to;
        }
    }
}

/// A pose on the straight way from one to another.
pub(super) fn between(a: &Trs, b: &Trs, share: f64) -> Trs {
    Trs {
        translation: a.translation.lerp(b.translation, share),
        rotation: DQuat::on_line(&DQuat::line(&a.rotation, &b.rotation), share),
        scale: a.scale.lerp(b.scale, share),
    }
}

/// Morph targets that move, and their weights at each time, all targets of a time together.
pub(crate) struct MorphTrack {
    /// Nodes that show the mesh.
    pub(crate) nodes: Vec<usize>,
    pub(crate) mesh: usize,
    pub(crate) targets: usize,
    pub(crate) weights: Vec<f64>,
}

/// A sampled clip, or a part of one.
pub(crate) struct Samples {
    pub(crate) grid: Grid,
    pub(crate) tracks: Vec<Track>,
    pub(crate) morphs: Vec<MorphTrack>,
    /// Samples that keys may stand on: those that were looked at, not predicted.
    pub(crate) stops: Vec<usize>,
    /// Samples that were looked at before keys were asked for.
    pub(crate) first: usize,
}

/// An animation stack that is to become a clip.
pub(crate) struct Take<'a> {
    pub(crate) scene: &'a SceneRoot,
    /// Number of the stack.
    pub(crate) number: usize,
    pub(crate) plan: Plan,
    /// Nodes that it moves.
    pub(crate) moving: Vec<usize>,
    /// Meshes of which it moves morph targets.
    pub(crate) meshes: Vec<usize>,
    /// For each mesh of the model what its targets are.
    pub(crate) shapes: &'a [Vec<ShapeKey>],
    /// Samples that memory allows at a time.
    pub(crate) most: usize,
}

impl<'a> Take<'a> {
    pub(crate) fn of(
        scene: &'a SceneRoot,
        number: usize,
        shapes: &'a [Vec<ShapeKey>],
        options: &Options,
        budget: &Budget,
    ) -> Result<Self, FbxError> {
        let stack: &AnimStack = &scene.anim_stacks[number];
        let layers = Layers::of(scene, stack, Reading::Usual);
        let moving = moving_nodes(scene, &layers);
        let channels = moving_channels(scene, &layers);
        let meshes: Vec<usize> = (0..shapes.len())
            .filter(|&mesh| shapes[mesh].iter().any(|key| channels[key.channel]))
            .collect();
        // A pose is 80 bytes here and about four times that while keys are chosen.
        let columns = moving.len() * 5 + meshes.iter().map(|&m| shapes[m].len()).sum::<usize>();
        let most = budget.limits.memory / 4 / (columns.max(1) * 64);
        let plan = Plan::of(scene, stack, &layers, options, budget)?;
        // Two samples at a time must fit, and the list of all keys.
        budget.afford(plan.len() * MARK_BYTES, "the keys of a clip")?;
        if most < LEAST {
            return Err(budget.too_much("the poses of a clip"));
        }
        let take = Self {
            scene,
            number,
            plan,
            moving,
            meshes,
            shapes,
            most,
        };
        // A first look at all of it must be within the limits; what more there is to look at is done as far as they go.
        budget.can_pay(take.first_look(), "the poses of a clip")?;
        Ok(take)
    }

    /// Whether all of it fits into memory at once, with room for more samples where it bends.
    pub(crate) fn is_whole(&self) -> bool {
        self.plan.samples() <= self.most as f64
    }

    /// Its samples through a range of the plan's marks.
    pub(crate) fn sample(
        &self,
        plan: &Plan,
        window: Range<usize>,
        model: &Model,
        options: &Options,
        budget: &Budget,
    ) -> Result<Samples, FbxError> {
        self.through(Grid::of(plan, window), model, options, budget)
    }

    /// Some samples spread over all of it.
    pub(crate) fn overview(
        &self,
        model: &Model,
        options: &Options,
        budget: &Budget,
    ) -> Result<Samples, FbxError> {
        let mut grid = Grid::default();
        let count = OVERVIEW.min(self.most).max(2);
        for i in 0..count {
            let share = i as f64 / (count - 1) as f64;
            let label = ((self.plan.end - self.plan.begin) * share) as f32;
            grid.push(self.plan.begin + f64::from(label), label, false, false);
        }
        self.through(grid, model, options, budget)
    }

    fn through(
        &self,
        grid: Grid,
        model: &Model,
        options: &Options,
        budget: &Budget,
    ) -> Result<Samples, FbxError> {
        budget.pay(self.columns() * grid.len());
        let poses = self.poses(&grid.times, options);
        let tracks = self
            .moving
            .iter()
            .zip(poses)
            .map(|(&node, poses)| {
                let spins = self.plan.spinning.contains(&node);
                let mut track = Track { node, spins, poses };
                track.straighten(&grid);
                track
            })
            .collect();
        let morphs = self
            .meshes
            .iter()
            .map(|&mesh| MorphTrack {
                nodes: (0..model.nodes.len())
                    .filter(|&node| model.nodes[node].mesh == Some(mesh))
                    .collect(),
                mesh,
                targets: self.shapes[mesh].len(),
                weights: self.weights(mesh, &grid.times),
            })
            .collect();
        Ok(Samples {
            first: grid.len(),
            stops: (0..grid.len()).collect(),
            grid,
            tracks,
            morphs,
        })
    }

    /// The stack.
    pub(crate) fn stack(&self) -> &'a AnimStack {
        &self.scene.anim_stacks[self.number]
    }

    /// The layers that play.
    pub(crate) fn layers(&self, reading: Reading) -> Layers<'a> {
        Layers::of(self.scene, self.stack(), reading)
    }

    /// The curves of node number `node`.
    pub(crate) fn curves(&self, layers: &Layers<'a>, node: usize) -> NodeCurves<'a> {
        NodeCurves::of(layers, &self.scene.nodes[node])
    }

    /// What a look at all of its samples costs, in poses of nodes.
    pub(crate) fn first_look(&self) -> usize {
        self.plan.samples() as usize * self.columns()
    }

    /// What a time costs, in poses of nodes.
    pub(crate) fn columns(&self) -> usize {
        let weights = self.meshes.iter().map(|&mesh| self.shapes[mesh].len());
        (self.moving.len() + weights.sum::<usize>()).max(1)
    }

    /// Where each node that moves is at each of `times`.
    pub(crate) fn poses(&self, times: &[f64], options: &Options) -> Vec<Vec<Trs>> {
        let nodes = &self.moving;
        let threads = threads(nodes.len() * times.len(), options);
        let parts = in_parts(nodes.len(), threads, |range| -> Vec<Vec<Trs>> {
            // ufbx's scene alone may go from thread to thread.
            let layers = self.layers(Reading::Usual);
            let track = |&node: &usize| {
                let mut curves = self.curves(&layers, node);
                times.iter().map(|&time| curves.at(time)).collect()
            };
            nodes[range].iter().map(track).collect()
        });
        parts.into_iter().flatten().collect()
    }

    /// What the targets of a mesh weigh.
    pub(crate) fn morph(&self, layers: &Layers<'a>, mesh: usize) -> MorphCurves<'a> {
        MorphCurves::of(self, layers, &self.shapes[mesh])
    }

    /// Weights of all targets of a mesh at each of `times`, those of a time together.
    pub(crate) fn weights(&self, mesh: usize, times: &[f64]) -> Vec<f64> {
        let mut morph = self.morph(&self.layers(Reading::Usual), mesh);
        let mut out = Vec::with_capacity(self.shapes[mesh].len() * times.len());
        for &time in times {
            morph.at(time, &mut out);
        }
        out
    }
}

/// Bytes of a mark and of what is made of it.
const MARK_BYTES: usize = 128;

/// Samples at a time that a clip can do with.
const LEAST: usize = 64;

/// Samples of an overview.
const OVERVIEW: usize = 64;

/// The curves of a mesh's morph targets.
pub(crate) struct MorphCurves<'a> {
    channels: Vec<(BlendWeight<'a>, Vec<f64>)>,
}

impl<'a> MorphCurves<'a> {
    fn of(take: &Take<'a>, layers: &Layers<'a>, shapes: &[ShapeKey]) -> Self {
        let mut channels = Vec::new();
        let mut at = 0;
        while at < shapes.len() {
            let channel: &'a ufbx::BlendChannel = &take.scene.blend_channels[shapes[at].channel];
            let stops = stops(channel);
            at += stops.len().max(1);
            let weight = BlendWeight::of(layers, channel);
            channels.push((weight, stops));
        }
        Self { channels }
    }

    /// Adds the majorants of all weights over a span between keys to `out`.
    pub(crate) fn over(&mut self, over: Over, out: &mut Vec<Majorant>) {
        for (channel, stops) in &mut self.channels {
            shape_rates(stops, &channel.over(over), out);
        }
    }

    /// Adds the weights of all targets at `time` to `out`.
    pub(crate) fn at(&mut self, time: f64, out: &mut Vec<f64>) {
        for (channel, stops) in &mut self.channels {
            let weights = shape_weights(stops, channel.at(time));
            out.extend(
                weights
                    .into_iter()
                    .map(|w| if w.is_finite() { w } else { 0.0 }),
            );
        }
    }
}

/// Nodes that the layers may move. Where a scale is animated that children do not inherit, their
/// places are scaled instead: all that hang on such helpers are looked at.
fn moving_nodes(scene: &SceneRoot, layers: &Layers) -> Vec<usize> {
    let mut moves = vec![false; scene.nodes.len()];
    let mut helpers = false;
    for layer in &layers.playing {
        for prop in layer
            .source
            .anim_props
            .iter()
            .filter(|p| p.element.type_ == ElementType::Node)
        {
            if MOVES.contains(&&*prop.prop_name) {
                let node = prop.element.typed_id as usize;
                moves[node] = true;
                helpers |= scene.nodes[node].is_scale_helper;
            }
        }
    }
    for (node, moves) in scene.nodes.iter().zip(&mut moves) {
        let hangs = |name: &&&str| layers.hanging(&node.element, name).next().is_some();
        *moves |= MOVES.iter().any(|name| hangs(&name));
    }
    if helpers {
        for node in &scene.nodes {
            // A node's own pivots are those of its helper's scale.
            let beside = node.scale_helper.is_some()
                || node
                    .parent
                    .as_ref()
                    .is_some_and(|parent| parent.scale_helper.is_some());
            moves[node.element.typed_id as usize] |= beside || node.is_scale_helper;
        }
    }
    (1..moves.len()).filter(|&node| moves[node]).collect()
}

fn moving_channels(scene: &SceneRoot, layers: &Layers) -> Vec<bool> {
    let mut moves = vec![false; scene.blend_channels.len()];
    for layer in &layers.playing {
        for prop in layer.source.anim_props.iter() {
            if prop.element.type_ == ElementType::BlendChannel && prop.prop_name.as_ref() == BLENDS
            {
                moves[prop.element.typed_id as usize] = true;
            }
        }
    }
    for (channel, moves) in scene.blend_channels.iter().zip(&mut moves) {
        *moves |= layers.hanging(&channel.element, BLENDS).next().is_some();
    }
    moves
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn what_lies_within_frames_is_straight_unless_the_node_spins() {
        let mut grid = Grid::default();
        for i in 0..6 {
            // Keys at 0, 2, 3 and 5; the time from 3 to 5 is no frame.
            grid.push(f64::from(i), i as f32, false, [0, 2, 3, 5].contains(&i));
            grid.set_within(i < 3);
        }
        let at = |x: f64| Trs {
            translation: DVec3::X * x,
            ..Trs::IDENTITY
        };
        let wild = [0.0, 9.0, 4.0, 6.0, -7.0, 8.0];
        let straightened = |spins| {
            let poses = wild.map(at).to_vec();
            let mut track = Track {
                node: 0,
                spins,
                poses,
            };
            track.straighten(&grid);
            track
                .poses
                .iter()
                .map(|pose| pose.translation.x)
                .collect::<Vec<_>>()
        };
        assert_eq!(straightened(true), wild);
        assert_eq!(straightened(false), [0.0, 2.0, 4.0, 6.0, -7.0, 8.0]);
    }
}
