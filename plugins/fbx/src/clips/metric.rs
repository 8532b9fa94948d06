//! How far a pose is from another at the skin, metres.
//!
//! Around every node lies a shell: 3 cm in the world, or as far out as the farthest vertex that
//! follows the node. Two poses of a whole tree are as far apart as the farthest of six points on any
//! node's shell, measured in the world, so that what ancestors do wrong is counted in their
//! descendants. (The shell and its use: Nicholas Frechette, Animation Compression Library, "Error
//! metric", 2017-2021; there three points, and 3 cm for all.)

use super::play::Pose;
use crate::model::Model;
use glam::{DAffine3, DVec3};

/// The shell around a joint, metres.
pub(crate) const SHELL: f64 = 0.03;

/// The tree and its shells.
pub(crate) struct Shells {
    parents: Vec<Option<usize>>,
    /// Parents before children.
    order: Vec<usize>,
    /// Distance of the farthest vertex that follows each node, in the node's own unit.
    vertices: Vec<f64>,
}

/// What an error of each property of a node comes to, farthest out: metres a radian, metres a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leverage {
    pub(crate) translation: f64,
    pub(crate) rotation: f64,
    pub(crate) scale: f64,
}

impl Shells {
    /// Of the nodes of `model` as they stand, with meshes and skins in place.
    pub(crate) fn of(model: &Model) -> Self {
        let parents: Vec<Option<usize>> = model.nodes.iter().map(|node| node.parent).collect();
        let mut vertices = vec![0.0_f64; parents.len()];
        for (number, node) in model.nodes.iter().enumerate() {
            let Some(mesh) = node.mesh.map(|mesh| &model.meshes[mesh]) else {
                continue;
            };
            let morph: f64 = mesh.targets.iter().map(|target| target.reach).sum();
            for part in &mesh.parts {
                let positions = part
                    .positions
                    .iter()
                    .map(|p| glam::Vec3::from(*p).as_dvec3());
                let Some(skin) = node.skin.map(|skin| &model.skins[skin]) else {
                    let far = positions.map(DVec3::length).fold(0.0, f64::max);
                    vertices[number] = vertices[number].max(far + morph);
                    continue;
                };
                for (vertex, position) in positions.enumerate() {
                    for (joints, weights) in part.joints.iter().zip(&part.weights) {
                        for (&joint, &weight) in joints[vertex].iter().zip(&weights[vertex]) {
                            if weight > 0.0 {
                                let bind = skin.inverse_bind[usize::from(joint)];
                                let far = bind.transform_point3(position).length();
                                let slot = &mut vertices[skin.joints[usize::from(joint)]];
                                // A vertex moves with a joint as much as it follows it.
                                *slot = slot.max((far + morph) * f64::from(weight));
                            }
                        }
                    }
                }
            }
        }
        Self {
            order: order(&parents),
            parents,
            vertices,
        }
    }

    /// Matrices to the world, for nodes in `order`.
    pub(crate) fn world(&self, pose: &Pose, out: &mut Vec<DAffine3>) {
        out.resize(pose.len(), DAffine3::IDENTITY);
        self.world_where(pose, out, |_| true);
    }

    /// The same for the nodes that `moves` says so of; the others are in `out` already.
    pub(crate) fn world_where(
        &self,
        pose: &Pose,
        out: &mut [DAffine3],
        moves: impl Fn(usize) -> bool,
    ) {
        for &node in self.order.iter().filter(|&&node| moves(node)) {
            let own = pose[node].affine();
            out[node] = match self.parents[node] {
                Some(parent) => out[parent] * own,
                None => own,
            };
        }
    }

    /// The same of `nodes`, parents before children, from matrices to their parents.
    pub(crate) fn world_of(&self, nodes: &[usize], locals: &[DAffine3], out: &mut [DAffine3]) {
        for &node in nodes {
            out[node] = match self.parents[node] {
                Some(parent) => out[parent] * locals[node],
                None => locals[node],
            };
        }
    }

    /// How far two poses are apart, metres; nodes that `moving` leaves out are where they were.
    pub(crate) fn distance(&self, a: &[DAffine3], b: &[DAffine3], moving: &[bool]) -> f64 {
        let mut farthest = 0.0_f64;
        for node in (0..a.len()).filter(|&node| moving[node]) {
            farthest = farthest.max(self.apart(node, &a[node], &b[node]));
        }
        farthest.sqrt()
    }

    /// The squared distance of two places of one node, `m` being where it belongs.
    pub(crate) fn apart(&self, node: usize, m: &DAffine3, n: &DAffine3) -> f64 {
        let shift = n.translation - m.translation;
        let mut farthest = 0.0_f64;
        for axis in 0..3 {
            let (c, d) = (m.matrix3.col(axis), n.matrix3.col(axis));
            let shell = self.vertices[node].max(SHELL / c.length().max(1e-9));
            let swing = (d - c) * shell;
            let far = (shift + swing)
                .length_squared()
                .max((shift - swing).length_squared());
            farthest = farthest.max(far);
        }
        farthest
    }

    /// The shell around a node that stands at `world`, metres.
    pub(crate) fn radius(&self, node: usize, world: &DAffine3) -> f64 {
        (self.vertices[node] * stretch(world)).max(SHELL)
    }

    /// How many times as long a way within the mesh of `node` may be in the world.
    pub(crate) fn widest(&self, model: &Model, node: usize, world: &[DAffine3]) -> f64 {
        match model.nodes[node].skin.map(|skin| &model.skins[skin]) {
            None => norm(&world[node]),
            Some(skin) => {
                let joints = skin.joints.iter().zip(&skin.inverse_bind);
                joints
                    .map(|(&joint, bind)| norm(&(world[joint] * DAffine3::from_mat4(*bind))))
                    .fold(0.0, f64::max)
            }
        }
    }

    /// All nodes, parents before children.
    pub(crate) fn in_order(&self) -> &[usize] {
        &self.order
    }

    /// The node that a node hangs on.
    pub(crate) fn parent(&self, node: usize) -> Option<usize> {
        self.parents[node]
    }

    /// Which nodes move when those in `nodes` do: they and all below them.
    pub(crate) fn moved_by(&self, nodes: impl Iterator<Item = usize>) -> Vec<bool> {
        let mut moving = vec![false; self.parents.len()];
        for node in nodes {
            moving[node] = true;
        }
        for &node in &self.order {
            moving[node] |= self.parents[node].is_some_and(|parent| moving[parent]);
        }
        moving
    }

    /// For each node, the most that its properties move of what hangs on it, over `poses`.
    pub(crate) fn leverage<'a>(&self, poses: impl Iterator<Item = &'a Pose>) -> Vec<Leverage> {
        let mut out = vec![
            Leverage {
                translation: 1e-9,
                rotation: 1e-9,
                scale: 1e-9
            };
            self.parents.len()
        ];
        let mut world = Vec::new();
        let mut reach = vec![0.0_f64; self.parents.len()];
        for pose in poses {
            self.world(pose, &mut world);
            reach.fill(0.0);
            for node in 0..self.parents.len() {
                let m = &world[node];
                let shell = (self.vertices[node] * stretch(m)).max(SHELL);
                let mut above = Some(node);
                while let Some(at) = above {
                    let far = (m.translation - world[at].translation).length() + shell;
                    reach[at] = reach[at].max(far);
                    above = self.parents[at];
                }
            }
            for (node, lever) in out.iter_mut().enumerate() {
                let parent = self.parents[node].map_or(1.0, |parent| stretch(&world[parent]));
                lever.translation = lever.translation.max(parent);
                lever.rotation = lever.rotation.max(reach[node]);
                let own = pose[node].scale.abs().max_element().max(1e-3);
                lever.scale = lever.scale.max(reach[node] / own);
            }
        }
        out
    }
}

/// The most that a matrix makes a way longer by, or a little more: exact where its columns stand at right angles.
fn norm(m: &DAffine3) -> f64 {
    let columns = [0, 1, 2].map(|i| m.matrix3.col(i));
    let row = |i: usize| columns.iter().map(|c| c.dot(columns[i]).abs()).sum::<f64>();
    (0..3).map(row).fold(0.0, f64::max).sqrt()
}

fn stretch(m: &DAffine3) -> f64 {
    let columns = [0, 1, 2].map(|i| m.matrix3.col(i).length());
    columns.into_iter().fold(0.0, f64::max)
}

/// Parents before children. Every node is there once; ufbx's tree has no cycles.
pub(crate) fn order(parents: &[Option<usize>]) -> Vec<usize> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); parents.len()];
    let mut order: Vec<usize> = Vec::with_capacity(parents.len());
    for (node, parent) in parents.iter().enumerate() {
        match parent {
            Some(parent) => children[*parent].push(node),
            None => order.push(node),
        }
    }
    let mut at = 0;
    while at < order.len() {
        let node = order[at];
        order.extend(&children[node]);
        at += 1;
    }
    order
}
