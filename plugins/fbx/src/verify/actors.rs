//! The file's pose and the keys' pose at a time, and how far they are apart.

use super::bodies::{Bodies, Scratch, Weights};
use super::chain::{Chain, down, length};
use super::found::Subject;
use super::lengths::Lengths;
use super::played;
use crate::clips::{MorphCurves, Player, Pose, SHELL, Shells, Source, play};
use crate::curves::{Majorant, NodeCurves, Over, Rates, Reading, Squares};
use crate::model::{Channel, Clip, Property, Trs};
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Both poses of one clip.
pub(super) struct Actors<'a> {
    source: &'a Source<'a, 'a>,
    shells: &'a Shells,
    begin: f64,
    curves: Vec<(usize, NodeCurves<'a>)>,
    morphs: Vec<Morph<'a>>,
    players: Vec<Player<'a>>,
    channels: Vec<&'a Channel>,
    moving: &'a [bool],
    /// Nodes that move, parents first.
    movers: Vec<usize>,
    truth: Pose,
    played: Pose,
    true_world: Vec<DAffine3>,
    world: Vec<DAffine3>,
    /// What is added to a point by going from where a node belongs to where it is.
    off: Vec<DAffine3>,
    /// Bodies that move, and their morph targets' weights.
    bodies: Vec<(usize, Weights)>,
    scratch: Scratch,
    all: &'a Bodies,
    /// What looks at a span saw: for each, what is off of each node that moves, and how far the three axes of its shell are.
    kept: Vec<Vec<(DAffine3, DMat3)>>,
    /// The same of the end of the last span.
    end: Vec<(DAffine3, DMat3)>,
    swings: Vec<DMat3>,
    /// The farthest of all nodes' shells.
    nodes: f64,
    /// No morph target moves.
    is_plain: bool,
    /// Scratch of [`Actors::rate`].
    rates: [Vec<Rates>; 2],
    chains: [Vec<Chain>; 2],
    /// Of nodes whose scales move, and of those whose axes do not keep their lengths.
    squares: Vec<Option<Squares>>,
    lengths: Vec<Lengths>,
    /// The time that both poses are of.
    posed: Option<f64>,
    /// Poses of nodes that were worked out, and what costs as much.
    work: usize,
}

/// Axes that differ by no more than this share are about as long.
const ALIKE: f64 = 1e-3;

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
        let order = shells.in_order().iter().copied();
        Self {
            bodies: bodies.collect(),
            scratch: Scratch::default(),
            all: source.bodies,
            movers: order.filter(|&node| moving[node]).collect(),
            off: vec![nothing(); count],
            kept: Vec::new(),
            end: Vec::new(),
            posed: None,
            swings: vec![DMat3::ZERO; count],
            nodes: 0.0,
            is_plain: morphs.is_empty(),
            rates: [vec![Rates::UNKNOWN; count], vec![Rates::UNKNOWN; count]],
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

    fn pose(&mut self, time: f64) {
        if self.posed.replace(time) == Some(time) {
            return;
        }
        self.work += self.movers.len().max(1);
        for (node, curves) in &mut self.curves {
            self.truth[*node] = curves.at(time);
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
        let moves = |node: usize| self.moving[node];
        self.shells
            .world_where(&self.truth, &mut self.true_world, moves);
        self.shells
            .world_where(&self.played, &mut self.world, moves);
    }

    /// The farthest of all points, as they are off.
    fn farthest(&mut self, floor: f64) -> f64 {
        let mut farthest = 0.0_f64;
        for &node in &self.movers {
            let (shift, swing) = (self.off[node].translation, &self.swings[node]);
            for axis in [swing.x_axis, swing.y_axis, swing.z_axis] {
                // The farther of the two ends.
                let far =
                    shift.length_squared() + axis.length_squared() + 2.0 * shift.dot(axis).abs();
                farthest = farthest.max(far);
            }
        }
        self.nodes = farthest.sqrt();
        let mut farthest = self.nodes.max(floor);
        for (body, weights) in &self.bodies {
            let body = &self.all.0[*body];
            let (model, off) = (self.source.model, &self.off);
            let world = &self.true_world;
            let own = (&mut self.scratch, &mut self.work);
            farthest = body.farthest(model, off, world, weights, farthest, own);
        }
        farthest
    }

    /// Majorants of what places each node below its parent, of the file and of the keys.
    fn locals(&mut self, over: Over) {
        for &node in &self.movers {
            self.rates[0][node] = Rates::still(&self.truth[node]);
            self.rates[1][node] = Rates::still(&self.played[node]);
            self.squares[node] = None;
        }
        for (node, curves) in &mut self.curves {
            let rates = curves.over(over);
            self.squares[*node] = (!rates.scale.is_still()).then(|| curves.squares_over(over));
            self.rates[0][*node] = rates;
        }
        let label = over.since(self.begin);
        for (channel, player) in self.channels.iter().zip(&mut self.players) {
            let rates = &mut self.rates[1][channel.node];
            match channel.property {
                Property::Translation => {
                    rates.translation = played::vector(channel, player, label).0;
                }
                Property::Rotation => rates.turn = played::turn(channel, player, label),
                Property::Scale => rates.scale = played::vector(channel, player, label).1,
                Property::Weights => {}
            }
        }
    }

    /// Majorants of each node in the world.
    fn chains(&mut self) {
        let places = [(&self.true_world, &self.truth), (&self.world, &self.played)];
        let sides = self.rates.iter().zip(&mut self.chains).zip(places);
        for ((rates, chains), (world, pose)) in sides {
            down(
                self.shells,
                &self.movers,
                self.moving,
                rates,
                (world, pose),
                chains,
            );
        }
    }

    /// Majorants of how long the axes of nodes are that do not keep their lengths.
    fn lengths(&mut self) {
        for &node in &self.movers {
            if self.chains[0][node].keeps {
                continue;
            }
            let still = |axes: &DMat3| (Lengths::still(axes), Majorant::still(length(axes)));
            let (above, axes) = match self.shells.parent(node) {
                None => still(&DMat3::IDENTITY),
                Some(parent) if self.moving[parent] => {
                    let chain = &self.chains[0][parent];
                    let lengths = match chain.keeps {
                        true => Lengths::still(&self.true_world[parent].matrix3),
                        false => self.lengths[parent],
                    };
                    (lengths, chain.axes)
                }
                Some(parent) => still(&self.true_world[parent].matrix3),
            };
            let scales = self.squares[node];
            let scales = scales.unwrap_or_else(|| Squares::still(self.truth[node].scale));
            self.lengths[node] = above.below(&axes, &self.rates[0][node], &scales);
        }
    }

    /// Of how far out the shell of a node is, in its own unit: as far as its axes are short. `posed` says that poses are those of the
    /// span's middle.
    fn shell(&self, node: usize, posed: bool) -> Majorant {
        let chain = &self.chains[0][node];
        let axes = &self.true_world[node].matrix3;
        let columns = || [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length);
        if chain.keeps {
            let columns = columns();
            let least = columns.into_iter().fold(f64::INFINITY, f64::min);
            return Majorant::still(SHELL / least.max(1e-9));
        }
        let lengths = &self.lengths[node];
        // As they are in the middle of the span, or as they are known to be.
        let (columns, off) = match posed {
            true => (columns(), 0.0),
            false => (lengths.middles.map(f64::sqrt), lengths.off),
        };
        let of = |squared: &Majorant, shortest: f64, longest: f64| {
            let least = (shortest * shortest * (1.0 - off) - squared.1).max(0.0);
            let most = longest * longest * (1.0 + off) + squared.1;
            let [near, far] = [most, least].map(|square| SHELL / square.sqrt().max(1e-9));
            let mut moves = match least <= 1e-18 {
                true => Majorant::within(far, far),
                false => squared.reciprocal_root(least).scaled(SHELL),
            };
            moves.1 = moves.1.min(moves.0[1] / 2.0).min(far - near);
            moves
        };
        let ([x, y, z], [a, b, c]) = (columns, &lengths.squares);
        let (shortest, longest) = (x.min(y).min(z), x.max(y).max(z));
        // One for all where they are about as long.
        if longest - shortest <= ALIKE * shortest {
            return of(&a.max(b).max(c), shortest, longest);
        }
        let of = |squared: &Majorant, long: f64| {
            // As fast as the axes move, each is no longer than it is.
            let mut axis = chain.axes;
            axis.0[0] = (long * long * (1.0 + off) + squared.1).sqrt();
            of(&squared.min(&axis.product(&axis)), long, long)
        };
        of(a, x).max(&of(b, y)).max(&of(c, z))
    }

    /// Majorants of how far a point of a body that a node carries is moved.
    fn carried(&mut self, over: Over) -> Majorant {
        let mut out = Majorant::ZERO;
        let label = over.since(self.begin);
        for (number, weights) in &self.bodies {
            let body = &self.all.0[*number];
            // How far morph targets move vertices, in the file and by the keys.
            let mut morphs = [Majorant::ZERO; 2];
            if body.has_targets() {
                morphs = [
                    Majorant::still(body.reach(weights.wanted.iter().copied())),
                    Majorant::still(body.reach(weights.played.iter().copied())),
                ];
                let mut parts = Vec::new();
                let sum = |parts: &[Majorant]| {
                    let each = body.reaches().iter().zip(parts);
                    each.fold(Majorant::ZERO, |sum, (reach, part)| {
                        sum.plus(&part.scaled(*reach))
                    })
                };
                let morph = self.morphs.iter_mut().find(|morph| morph.mesh == body.mesh);
                if let Some(morph) = morph {
                    morph.curves.over(over, &mut parts);
                    morphs[0] = sum(&parts);
                }
                let weigh = |c: &&Channel| c.property == Property::Weights && c.node == body.node;
                let mut all = self.channels.iter().zip(&mut self.players);
                if let Some((channel, player)) = all.find(|(channel, _)| weigh(channel)) {
                    parts.clear();
                    played::numbers(channel, player, label, &mut parts);
                    morphs[1] = sum(&parts);
                }
            }
            for (node, far, longer) in body.levers() {
                let moved = |side: usize| {
                    let chain = match self.moving[node] {
                        true => self.chains[side][node],
                        false => Chain::still(&self.true_world[node]),
                    };
                    let reach = Majorant::still(far).plus(&morphs[side].scaled(longer));
                    chain.origin.plus(&chain.axes.product(&reach))
                };
                out = out.max(&moved(0).plus(&moved(1)));
            }
        }
        out
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
            self.kept.resize(index + 1, Vec::new());
        }
        let (off, swings) = (&self.off, &self.swings);
        self.kept[index].clear();
        let pairs = self.movers.iter().map(|&node| (off[node], swings[node]));
        self.kept[index].extend(pairs);
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
            self.kept.push(Vec::new());
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
            for (slot, &node) in self.movers.iter().enumerate() {
                let (mut off, mut swing) = (nothing(), DMat3::ZERO);
                for (weight, kept) in row.iter().zip(&self.kept) {
                    let (one, other) = &kept[slot];
                    off.matrix3 += one.matrix3 * *weight;
                    off.translation += one.translation * *weight;
                    swing += *other * *weight;
                }
                (self.off[node], self.swings[node]) = (off, swing);
            }
            most = self.farthest(most);
        }
        Some(most)
    }

    fn rate(&mut self, from: f64, to: f64) -> Majorant {
        let over = Over {
            from,
            to,
            slack: 1e-7 * (to - self.begin).abs() + 1e-9,
        };
        // Of the poses only lengths of axes are asked, which mostly are the same at all times, or known.
        if self.posed.is_none() || !self.is_plain {
            self.pose(over.middle());
        }
        self.work += 8 * self.movers.len();
        self.locals(over);
        self.chains();
        self.lengths();
        let is_known =
            |&node: &usize| self.chains[0][node].keeps || self.lengths[node].off <= ALIKE;
        if !self.movers.iter().all(is_known) {
            self.pose(over.middle());
        }
        let posed = self.posed == Some(over.middle());
        let mut out = Majorant::ZERO;
        for &node in &self.movers {
            let shell = self.shell(node, posed);
            let moved = |chain: &Chain| chain.origin.plus(&chain.axes.product(&shell));
            let both = self.chains.each_ref().map(|chains| moved(&chains[node]));
            out = out.max(&both[0].plus(&both[1]));
        }
        out.max(&self.carried(over))
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
