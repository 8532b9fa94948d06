//! The file's pose and the keys' pose at a time, and how far they are apart.

use super::bodies::{Bodies, Scratch, Weights};
use super::chain::Chain;
use super::found::Subject;
use super::lengths::Lengths;
use crate::clips::{MorphCurves, Player, Pose, SHELL, Shells, Source, play};
use crate::curves::{Majorant, NodeCurves, Rates, Reading, Squares};
use crate::model::{Channel, Clip, Trs};
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Both poses of one clip.
pub(super) struct Actors<'a> {
    source: &'a Source<'a, 'a>,
    pub(super) shells: &'a Shells,
    pub(super) begin: f64,
    pub(super) curves: Vec<(usize, NodeCurves<'a>)>,
    pub(super) morphs: Vec<Morph<'a>>,
    pub(super) players: Vec<Player<'a>>,
    pub(super) channels: Vec<&'a Channel>,
    pub(super) moving: &'a [bool],
    /// Nodes that move, parents first.
    pub(super) movers: Vec<usize>,
    pub(super) truth: Pose,
    pub(super) played: Pose,
    /// The same two below their parents and in the world, as matrices.
    locals: [Vec<DAffine3>; 2],
    pub(super) true_world: Vec<DAffine3>,
    pub(super) world: Vec<DAffine3>,
    /// Nodes that players move.
    playing: Vec<usize>,
    /// What is added to a point by going from where a node belongs to where it is.
    off: Vec<DAffine3>,
    /// Bodies that move, and their morph targets' weights.
    pub(super) bodies: Vec<(usize, Weights)>,
    scratch: Scratch,
    pub(super) all: &'a Bodies,
    /// What looks at a span saw, and the same of the end of the last span.
    kept: Vec<Seen>,
    end: Seen,
    swings: Vec<DMat3>,
    /// How far each node's shell was off in the last look, and each body by one joint alone.
    fars: Vec<f64>,
    reaches: Vec<f64>,
    /// The farthest of all nodes' shells.
    nodes: f64,
    /// No morph target moves.
    pub(super) is_plain: bool,
    /// Scratch of [`Actors::rate`].
    pub(super) rates: [Vec<Rates>; 2],
    pub(super) chains: [Vec<Chain>; 2],
    /// Of nodes whose scales move, and of those whose axes do not keep their lengths.
    pub(super) squares: Vec<Option<Squares>>,
    pub(super) lengths: Vec<Lengths>,
    /// The time that both poses are of.
    pub(super) posed: Option<f64>,
    /// Poses of nodes that were worked out, and what costs as much.
    pub(super) work: usize,
}

/// What a look saw.
#[derive(Clone, Default)]
struct Seen {
    /// What is off of each node that moves, and how far the three axes of its shell are.
    off: Vec<(DAffine3, DMat3)>,
    /// No mixture of looks is off by more than the same mixture of these, all added.
    fars: Vec<f64>,
    reaches: Vec<f64>,
}

/// By how much sums of what looks saw may be rounded.
const MIXED: f64 = 1.0 + 1e-12;

pub(super) struct Morph<'a> {
    pub(super) mesh: usize,
    pub(super) curves: MorphCurves<'a>,
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
        let model = source.model;
        let rest: Pose = model.nodes.iter().map(|node| node.rest).collect();
        let layers = source.take.layers(reading);
        let written: Pose = rest.iter().map(rounded).collect();
        let (mut true_world, mut world) = (Vec::new(), Vec::new());
        shells.world(&rest, &mut true_world);
        shells.world(&written, &mut world);
        let curves = source.take.moving.iter();
        let curves: Vec<(usize, NodeCurves)> = curves
            .map(|&node| (node, source.take.curves(&layers, node)))
            .collect();
        let mut played = written;
        let (mut still, mut players, mut channels) = (Vec::new(), Vec::new(), Vec::new());
        for channel in &clip.channels {
            let player = Player::new(channel);
            if player.stands() {
                still.push(player);
            } else {
                players.push(player);
                channels.push(channel);
            }
        }
        play(&mut still, 0.0, &mut played, |_, _| ());
        let all = &source.bodies.0;
        let morphs = &source.take.meshes;
        let bodies = (0..all.len())
            .filter(|&body| all[body].moves(moving) || morphs.contains(&all[body].mesh));
        let bodies = bodies.map(|body| {
            let targets = &model.meshes[all[body].mesh].targets;
            let rest: Vec<f64> = targets.iter().map(|target| target.rest).collect();
            let weights = Weights {
                wanted: rest.clone(),
                played: rest,
            };
            (body, weights)
        });
        let count = rest.len();
        let mut playing: Vec<usize> = channels.iter().map(|channel| channel.node).collect();
        playing.sort_unstable();
        playing.dedup();
        let order = shells.in_order().iter().copied();
        Self {
            bodies: bodies.collect(),
            scratch: Scratch::default(),
            all: source.bodies,
            movers: order.filter(|&node| moving[node]).collect(),
            off: vec![nothing(); count],
            kept: Vec::new(),
            end: Seen::default(),
            fars: Vec::new(),
            reaches: Vec::new(),
            posed: None,
            swings: vec![DMat3::ZERO; count],
            nodes: 0.0,
            is_plain: morphs.is_empty(),
            rates: [&rest, &played].map(|pose| pose.iter().map(Rates::still).collect()),
            chains: [vec![Chain::ROOT; count], vec![Chain::ROOT; count]],
            squares: vec![None; count],
            lengths: vec![Lengths::still(&DMat3::IDENTITY); count],
            work: 0,
            curves,
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
            channels,
            playing,
            locals: [&rest, &played].map(|pose| pose.iter().map(Trs::affine).collect()),
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

    /// Nothing of what it saw stands for what is no transform.
    pub(super) fn forget(&mut self) {
        self.posed = None;
        self.curves
            .iter_mut()
            .for_each(|(_, curves)| curves.forget());
    }

    /// The file's poses alone, at `time`.
    fn true_pose(&mut self, time: f64) {
        self.posed = None;
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

    pub(super) fn pose(&mut self, time: f64) {
        if self.posed.replace(time) == Some(time) {
            return;
        }
        self.work += self.movers.len().max(1);
        for (node, curves) in &mut self.curves {
            self.truth[*node] = curves.at(time);
            self.locals[0][*node] = self.truth[*node].affine();
        }
        for morph in &mut self.morphs {
            morph.weights.clear();
            morph.curves.at(time, &mut morph.weights);
        }
        let (all, bodies, morphs) = (&self.all.0, &mut self.bodies, &self.morphs);
        for (body, weights) in bodies.iter_mut() {
            let its = morphs.iter().find(|morph| morph.mesh == all[*body].mesh);
            if let Some(morph) = its {
                weights.wanted.clone_from(&morph.weights);
            }
        }
        let label = (time - self.begin).max(0.0);
        play(
            &mut self.players,
            label,
            &mut self.played,
            |node, played| {
                let its = bodies.iter_mut().find(|(body, _)| all[*body].node == node);
                if let Some((_, weights)) = its {
                    weights.played.clear();
                    weights.played.extend_from_slice(played);
                }
            },
        );
        for &node in &self.playing {
            self.locals[1][node] = self.played[node].affine();
        }
        let [of_truth, of_played] = &self.locals;
        self.shells
            .world_of(&self.movers, of_truth, &mut self.true_world);
        self.shells
            .world_of(&self.movers, of_played, &mut self.world);
    }

    /// The farthest of six points of a node's shell, as they are off.
    fn far(&self, node: usize) -> f64 {
        let (shift, swing) = (self.off[node].translation, &self.swings[node]);
        let mut farthest = 0.0_f64;
        for axis in [swing.x_axis, swing.y_axis, swing.z_axis] {
            // The farther of the two ends.
            let far = axis.length_squared() + 2.0 * shift.dot(axis).abs();
            farthest = farthest.max(far);
        }
        (shift.length_squared() + farthest).sqrt()
    }

    /// The farthest of all points, as they are off.
    fn farthest(&mut self, floor: f64) -> f64 {
        self.nodes = 0.0;
        let mut fars = std::mem::take(&mut self.fars);
        fars.clear();
        for &node in &self.movers {
            let far = self.far(node);
            self.nodes = self.nodes.max(far);
            fars.push(far);
        }
        self.fars = fars;
        let mut farthest = self.nodes.max(floor);
        self.reaches.clear();
        for slot in 0..self.bodies.len() {
            farthest = self.farthest_of(slot, farthest);
            self.reaches.push(self.scratch.reach);
        }
        farthest
    }

    /// The farthest vertex of a body.
    fn farthest_of(&mut self, slot: usize, floor: f64) -> f64 {
        let (body, weights) = &self.bodies[slot];
        let own = (&mut self.scratch, &mut self.work);
        let (off, world) = (&self.off, &self.true_world);
        self.all.0[*body].farthest(self.source.model, off, world, weights, floor, own)
    }

    /// Mixes what looks saw of a node.
    fn mix(&mut self, row: &[f64], slot: usize) {
        let (mut off, mut swing) = (nothing(), DMat3::ZERO);
        for (weight, kept) in row.iter().zip(&self.kept) {
            let (one, other) = &kept.off[slot];
            off.matrix3 += one.matrix3 * *weight;
            off.translation += one.translation * *weight;
            swing += *other * *weight;
        }
        let node = self.movers[slot];
        (self.off[node], self.swings[node]) = (off, swing);
    }
}

impl Subject for Actors<'_> {
    fn look(&mut self, time: f64, floor: f64) -> f64 {
        self.pose(time);
        for &node in &self.movers {
            self.off[node] = difference(&self.true_world[node], &self.world[node]);
            let axes = &self.true_world[node].matrix3;
            let off = &self.off[node].matrix3;
            let swing = |axis: usize| {
                let far = SHELL / axes.col(axis).length().max(1e-9);
                off.col(axis) * far
            };
            self.swings[node] = DMat3::from_cols(swing(0), swing(1), swing(2));
        }
        self.farthest(floor)
    }

    fn about(&self) -> f64 {
        self.nodes
    }

    fn keep(&mut self, index: usize) {
        if !self.is_plain {
            return;
        }
        if self.kept.len() <= index {
            self.kept.resize(index + 1, Seen::default());
        }
        let (off, swings) = (&self.off, &self.swings);
        let kept = &mut self.kept[index];
        kept.off.clear();
        let pairs = self.movers.iter().map(|&node| (off[node], swings[node]));
        kept.off.extend(pairs);
        kept.fars.clone_from(&self.fars);
        kept.reaches.clone_from(&self.reaches);
    }

    fn keep_end(&mut self, index: usize) {
        if self.is_plain {
            self.end.clone_from(&self.kept[index]);
        }
    }

    fn keep_again(&mut self) {
        if !self.is_plain {
            return;
        }
        if self.kept.is_empty() {
            self.kept.push(Seen::default());
        }
        std::mem::swap(&mut self.kept[0], &mut self.end);
    }

    fn mixed(&mut self, rows: &[Vec<f64>], floor: f64) -> Option<f64> {
        if !self.is_plain {
            return None;
        }
        let mut most = floor;
        self.work += rows.len() * self.movers.len() / 2;
        for row in rows {
            let sum = |kept: &[Seen], of: &dyn Fn(&Seen) -> f64| {
                let each = row.iter().zip(kept);
                each.map(|(weight, kept)| weight.abs() * of(kept))
                    .sum::<f64>()
                    * MIXED
            };
            for slot in 0..self.movers.len() {
                if sum(&self.kept, &|kept| kept.fars[slot]) > most {
                    self.mix(row, slot);
                    most = most.max(self.far(self.movers[slot]));
                }
            }
            let mut is_mixed = false;
            for body in 0..self.bodies.len() {
                if sum(&self.kept, &|kept| kept.reaches[body]) <= most {
                    continue;
                }
                if !is_mixed {
                    (0..self.movers.len()).for_each(|slot| self.mix(row, slot));
                    is_mixed = true;
                }
                most = self.farthest_of(body, most);
            }
        }
        Some(most)
    }

    fn rate(&mut self, from: f64, to: f64) -> Majorant {
        self.moves(from, to)
    }

    fn work(&self) -> usize {
        self.work
    }
}

/// What is added to a point by going from one place to the other.
fn difference(a: &DAffine3, b: &DAffine3) -> DAffine3 {
    DAffine3 {
        matrix3: DMat3::from_cols(
            b.matrix3.x_axis - a.matrix3.x_axis,
            b.matrix3.y_axis - a.matrix3.y_axis,
            b.matrix3.z_axis - a.matrix3.z_axis,
        ),
        translation: b.translation - a.translation,
    }
}

fn nothing() -> DAffine3 {
    DAffine3 {
        matrix3: DMat3::ZERO,
        translation: DVec3::ZERO,
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
