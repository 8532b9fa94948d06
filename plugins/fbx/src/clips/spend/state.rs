//! Where every node is at every sample while keys go, and how far that is from the file.

use super::curve::{Target, put};
use crate::clips::work::Work;
use crate::model::Trs;
use glam::{DAffine3, DVec4};

/// Poses of a clip as its keys play.
pub(super) struct State<'a> {
    work: &'a Work<'a>,
    /// Poses of each track, those of a track together.
    local: Vec<Trs>,
    /// Matrices of the nodes that move, those of a sample together.
    world: Vec<DAffine3>,
    /// Squared distances at the skin, likewise.
    far: Vec<f64>,
    /// What morph targets are off by at each sample.
    morph: Vec<f64>,
    /// For each node, its number among those that move, and its track.
    slots: Vec<Option<usize>>,
    tracks: Vec<Option<usize>>,
    rest: Vec<DAffine3>,
    trial: Trial,
}

/// A change that was measured.
#[derive(Default)]
struct Trial {
    from: usize,
    local: Vec<Trs>,
    world: Vec<DAffine3>,
    far: Vec<f64>,
}

/// Nodes of some branches of the tree, parents first.
pub(super) struct Below {
    nodes: Vec<usize>,
    /// For each its parent's number in `nodes`, where that is among them.
    parents: Vec<Option<usize>>,
}

/// What is played of one property from a sample on.
pub(super) struct Played<'a> {
    pub(super) target: Target,
    pub(super) from: usize,
    pub(super) values: &'a [DVec4],
}

impl<'a> Played<'a> {
    /// Of all samples.
    pub(super) fn from_start(target: Target, values: &'a [DVec4]) -> Self {
        Self {
            target,
            from: 0,
            values,
        }
    }
}

impl<'a> State<'a> {
    pub(super) fn new(work: &'a Work<'a>, morph: Vec<f64>) -> Self {
        let count = work.times.len();
        let mut slots = vec![None; work.rest.len()];
        for (slot, &node) in work.moved.iter().enumerate() {
            slots[node] = Some(slot);
        }
        let mut tracks = vec![None; work.rest.len()];
        let mut local = Vec::with_capacity(count * work.samples.tracks.len());
        for (number, track) in work.samples.tracks.iter().enumerate() {
            tracks[track.node] = Some(number);
            local.extend_from_slice(&track.poses);
        }
        let mut rest = Vec::new();
        work.shells.world(&work.rest, &mut rest);
        Self {
            local,
            world: work.truth.clone(),
            far: vec![0.0; work.truth.len()],
            morph,
            slots,
            tracks,
            rest,
            trial: Trial::default(),
            work,
        }
    }

    /// Plays a property without measuring.
    pub(super) fn hold(&mut self, played: &Played) {
        let at = played.target.track * self.count() + played.from;
        for (pose, &value) in self.local[at..].iter_mut().zip(played.values) {
            put(pose, played.target.property, value);
        }
    }

    pub(super) fn count(&self) -> usize {
        self.work.times.len()
    }

    /// Nodes that move, in the order that samples have them.
    pub(super) fn nodes(&self) -> &[usize] {
        &self.work.moved
    }

    /// Nodes that move, parents first.
    pub(super) fn in_order(&self) -> impl Iterator<Item = usize> {
        let in_order = self.work.shells.in_order().iter().copied();
        in_order.filter(|&node| self.slots[node].is_some())
    }

    /// The number of a node among those that move: one that has a track, or hangs on such a one.
    pub(super) fn slot(&self, node: usize) -> usize {
        self.slots[node].expect("what is below a track moves")
    }

    /// The number of a node's parent, where that moves.
    pub(super) fn parent_slot(&self, node: usize) -> Option<usize> {
        self.slots[self.work.shells.parent(node)?]
    }

    /// Where the parent of a node is that does not move.
    pub(super) fn fixed_parent(&self, node: usize) -> DAffine3 {
        let parent = self.work.shells.parent(node);
        parent.map_or(DAffine3::IDENTITY, |parent| self.rest[parent])
    }

    /// Nodes that move and hang on a node.
    pub(super) fn children(&self, node: usize) -> Vec<usize> {
        let on_it = |&&other: &&usize| self.work.shells.parent(other) == Some(node);
        self.nodes().iter().filter(on_it).copied().collect()
    }

    /// The pose of a node that moves.
    pub(super) fn local(&self, node: usize, i: usize) -> &Trs {
        match self.tracks[node] {
            Some(track) => &self.local[track * self.count() + i],
            None => &self.work.rest[node],
        }
    }

    /// The matrix of a node that moves.
    pub(super) fn world(&self, node: usize, i: usize) -> &DAffine3 {
        &self.world[i * self.work.moved.len() + self.slot(node)]
    }

    /// The squared distance at the skin.
    pub(super) fn apart(&self, node: usize, wanted: &DAffine3, is: &DAffine3) -> f64 {
        self.work.shells.apart(node, wanted, is)
    }

    /// The nodes that move when those of `targets` do.
    pub(super) fn below(&self, targets: impl Iterator<Item = Target>) -> Below {
        let shells = self.work.shells;
        let moved = shells.moved_by(targets.map(|target| target.node));
        let in_order = shells.in_order().iter().copied();
        let nodes: Vec<usize> = in_order.filter(|&node| moved[node]).collect();
        let place = |node: usize| nodes.iter().position(|&other| other == node);
        let parents = nodes
            .iter()
            .map(|&node| shells.parent(node).and_then(place));
        Below {
            parents: parents.collect(),
            nodes,
        }
    }

    /// Plays `played` on samples `from..=to` and measures the nodes of `below` there. Gives what that adds to the
    /// error, or nothing where it is more than `bound` metres anywhere.
    pub(super) fn measure(
        &mut self,
        below: &Below,
        played: &[Played],
        (from, to): (usize, usize),
        bound: f64,
    ) -> Option<f64> {
        let (count, width) = (self.count(), self.work.moved.len());
        let mut trial = std::mem::take(&mut self.trial);
        trial.from = from;
        trial.world.clear();
        trial.far.clear();
        trial.local.clear();
        let per_bound = 1.0 / (bound * bound);
        let mut cost = 0.0;
        let mut good = true;
        'samples: for i in from..=to {
            let allowed = bound - self.morph[i];
            let row = i * width;
            let first = trial.world.len();
            for (&node, parent) in below.nodes.iter().zip(&below.parents) {
                let slot = self.slot(node);
                let mut own = match self.tracks[node] {
                    Some(track) => self.local[track * count + i],
                    None => self.work.rest[node],
                };
                for one in played {
                    if one.target.node == node && i >= one.from && i < one.from + one.values.len() {
                        put(&mut own, one.target.property, one.values[i - one.from]);
                    }
                }
                let own_world = DAffine3::from_scale_rotation_translation(
                    own.scale,
                    own.rotation,
                    own.translation,
                );
                let world = match self.work.shells.parent(node) {
                    None => own_world,
                    Some(above) => match (*parent, self.slots[above]) {
                        (Some(there), _) => trial.world[first + there] * own_world,
                        (None, Some(slot)) => self.world[row + slot] * own_world,
                        (None, None) => self.rest[above] * own_world,
                    },
                };
                let far = self
                    .work
                    .shells
                    .apart(node, &self.work.truth[row + slot], &world);
                if allowed < 0.0 || far > allowed * allowed {
                    good = false;
                    break 'samples;
                }
                cost += weight(far * per_bound) - weight(self.far[row + slot] * per_bound);
                trial.world.push(world);
                trial.far.push(far);
                trial.local.push(own);
            }
        }
        self.trial = trial;
        good.then_some(cost)
    }

    /// Takes what was measured last.
    pub(super) fn take(&mut self, below: &Below) {
        let nodes = &below.nodes;
        let (count, width) = (self.count(), self.work.moved.len());
        let trial = &self.trial;
        for (at, &world) in trial.world.iter().enumerate() {
            let (i, node) = (trial.from + at / nodes.len(), nodes[at % nodes.len()]);
            let slot = self.slot(node);
            self.world[i * width + slot] = world;
            self.far[i * width + slot] = trial.far[at];
            if let Some(track) = self.tracks[node] {
                self.local[track * count + i] = trial.local[at];
            }
        }
    }

    /// The node that was farthest off when the nodes of `below` were measured last, with what morph
    /// targets were off by then.
    pub(super) fn worst(&self, below: &Below) -> usize {
        let nodes = &below.nodes;
        let morph = |at: usize| self.morph[self.trial.from + at / nodes.len()];
        let far = self.trial.far.iter().enumerate();
        let far = far.map(|(at, far)| (at, far.sqrt() + morph(at)));
        let worst = far.max_by(|a, b| a.1.total_cmp(&b.1));
        nodes[worst.map_or(0, |(at, _)| at % nodes.len())]
    }

    /// `node` is `other` or hangs on it somewhere.
    pub(super) fn is_above(&self, other: usize, node: usize) -> bool {
        let mut above = Some(node);
        while let Some(at) = above {
            if at == other {
                return true;
            }
            above = self.work.shells.parent(at);
        }
        false
    }

    /// How far away a node's own shell and the nodes that hang on it are in the first pose, metres.
    pub(super) fn reach(&self, node: usize) -> f64 {
        let own = self.world(node, 0);
        let children = self.children(node);
        let far = children
            .iter()
            .map(|&child| self.world(child, 0).translation.distance(own.translation));
        far.fold(self.work.shells.radius(node, own), f64::max)
    }

    /// The largest error, metres.
    #[cfg(test)]
    pub(super) fn error(&self) -> f64 {
        let width = self.work.moved.len();
        let far = self.far.iter().enumerate();
        far.map(|(at, far)| far.sqrt() + self.morph[at / width])
            .fold(0.0, f64::max)
    }
}

/// What a squared error, as a share of the bound's square, weighs: a place near the bound has little left
/// to give. (The power matters little: with 1, 2 and 4 bytes were the same within 0.4 %.)
fn weight(share: f64) -> f64 {
    share * share
}
