//! The poses of a clip as the FBX file has them, in f64.

use super::grid::Grid;
use super::keys::{BLENDS, MOVES};
use super::parts::{in_parts, threads};
use super::value::Value;
use crate::error::FbxError;
use crate::model::{Model, Trs};
use crate::options::{Budget, Options};
use crate::read::convert::trs;
use crate::read::shapes::{shape_weights, stops};
use crate::read::{ShapeKey, rest_of};
use glam::DQuat;
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

/// A sampled clip.
pub(crate) struct Samples {
    pub(crate) name: String,
    pub(crate) begin: f64,
    pub(crate) grid: Grid,
    pub(crate) tracks: Vec<Track>,
    pub(crate) morphs: Vec<MorphTrack>,
    /// Samples that keys may stand on: those that were looked at, not predicted.
    pub(crate) stops: Vec<usize>,
    /// Samples that memory allows.
    pub(crate) most: usize,
    /// Samples that were looked at before keys were asked for.
    pub(crate) first: usize,
}

/// Samples stack number `stack`. `shapes` says for each mesh of the model what its targets are.
pub(crate) fn sample(
    scene: &SceneRoot,
    stack: usize,
    model: &Model,
    shapes: &[Vec<ShapeKey>],
    options: &Options,
    budget: &Budget,
) -> Result<Samples, FbxError> {
    let source: &AnimStack = &scene.anim_stacks[stack];
    let moving = moving_nodes(scene, source);
    let channels = moving_channels(scene, source);
    let meshes: Vec<usize> = (0..shapes.len())
        .filter(|&mesh| shapes[mesh].iter().any(|key| channels[key.channel]))
        .collect();
    // A pose is 80 bytes here and about four times that while keys are chosen.
    let columns = moving.len() * 5 + meshes.iter().map(|&m| shapes[m].len()).sum::<usize>();
    let most = budget.limits.memory / 4 / (columns.max(1) * 64);
    let (begin, grid, spinning) = Grid::of_stack(scene, source, options, most, budget)?;

    let poses = evaluate(scene, stack, &moving, &grid.times, options, budget)?;
    let tracks = moving
        .iter()
        .zip(poses)
        .map(|(&node, poses)| {
            let spins = spinning.contains(&node);
            let mut track = Track { node, spins, poses };
            track.straighten(&grid);
            track
        })
        .collect();
    let morphs = meshes
        .iter()
        .map(|&mesh| MorphTrack {
            nodes: (0..model.nodes.len())
                .filter(|&node| model.nodes[node].mesh == Some(mesh))
                .collect(),
            mesh,
            targets: shapes[mesh].len(),
            weights: morph_weights(scene, source, &shapes[mesh], &grid.times),
        })
        .collect();
    budget.in_time("clips")?;
    Ok(Samples {
        name: source.element.name.to_string(),
        begin,
        first: grid.len(),
        stops: (0..grid.len()).collect(),
        grid,
        tracks,
        morphs,
        most,
    })
}

/// Nodes that the stack may move. Where a scale is animated that children do not inherit, their
/// places are scaled instead: all that hang on such helpers are looked at.
fn moving_nodes(scene: &SceneRoot, stack: &AnimStack) -> Vec<usize> {
    let mut moves = vec![false; scene.nodes.len()];
    let mut helpers = false;
    for layer in &stack.layers {
        for prop in layer
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
    if helpers {
        for node in &scene.nodes {
            let beside = node
                .parent
                .as_ref()
                .is_some_and(|parent| parent.scale_helper.is_some());
            moves[node.element.typed_id as usize] |= beside || node.is_scale_helper;
        }
    }
    (1..moves.len()).filter(|&node| moves[node]).collect()
}

fn moving_channels(scene: &SceneRoot, stack: &AnimStack) -> Vec<bool> {
    let mut moves = vec![false; scene.blend_channels.len()];
    for layer in &stack.layers {
        for prop in layer.anim_props.iter() {
            if prop.element.type_ == ElementType::BlendChannel && prop.prop_name.as_ref() == BLENDS
            {
                moves[prop.element.typed_id as usize] = true;
            }
        }
    }
    moves
}

/// Where each of `nodes` is at each of `times`.
pub(crate) fn evaluate(
    scene: &SceneRoot,
    stack: usize,
    nodes: &[usize],
    times: &[f64],
    options: &Options,
    budget: &Budget,
) -> Result<Vec<Vec<Trs>>, FbxError> {
    let threads = threads(nodes.len() * times.len(), options);
    let track = |node: usize| -> Vec<Trs> {
        let anim: &ufbx::Anim = &scene.anim_stacks[stack].anim;
        let source: &ufbx::Node = &scene.nodes[node];
        let mut last = rest_of(source);
        let pose = |&time: &f64| {
            let pose = trs(&ufbx::evaluate_transform(anim, source, time));
            // What is no transform leaves the node where it was.
            if pose.is_sound() {
                last = pose;
            }
            last
        };
        times.iter().map(pose).collect()
    };
    let parts = in_parts(nodes.len(), threads, |range| -> Vec<Vec<Trs>> {
        let in_time = nodes[range].iter().take_while(|_| !budget.is_late());
        in_time.map(|&node| track(node)).collect()
    });
    let tracks = parts.into_iter().flatten().collect();
    budget.in_time("clips")?;
    Ok(tracks)
}

/// Weights of all targets of a mesh at each of `times`, those of a time together.
pub(crate) fn morph_weights(
    scene: &SceneRoot,
    stack: &AnimStack,
    shapes: &[ShapeKey],
    times: &[f64],
) -> Vec<f64> {
    let mut out = vec![0.0; shapes.len() * times.len()];
    let mut at = 0;
    while at < shapes.len() {
        let channel: &ufbx::BlendChannel = &scene.blend_channels[shapes[at].channel];
        let stops = stops(channel);
        for (i, &time) in times.iter().enumerate() {
            let weight = ufbx::evaluate_blend_weight(&stack.anim, channel, time);
            let weights = shape_weights(&stops, weight);
            for (key, weight) in weights.into_iter().enumerate() {
                out[i * shapes.len() + at + key] = if weight.is_finite() { weight } else { 0.0 };
            }
        }
        at += stops.len().max(1);
    }
    out
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
