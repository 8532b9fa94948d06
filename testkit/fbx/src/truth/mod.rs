//! What a scene means, in f64: where every node and every vertex is at every time.
//!
//! Written from the format's definition (the SDK's reference on `FbxNode`, `FbxAnimCurveDef`, `FbxAnimLayer` and its
//! sample *Transformations*), from the generator's description and not from the file that it wrote, and without a line
//! in common with what reads and converts that file.
//!
//! Where documents are silent, thousands of random files were held against ufbx and each difference was settled:
//!
//! | what | settled as |
//! |---|---|
//! | slope of an automatic tangent | mean of the neighbours' line and the parabola through the three keys; no document says it |
//! | layers that are not heard | as if they were not there; only the clip's first layer, where it is heard, gives the value whatever its mode and weight, others are laid on the value at rest |
//! | numbers of a property that no curve moves, though others or none beside it are | those of the curves' node, not those at rest |
//! | a property that one layer moves and another does not | ufbx 0.11 takes the curves of the next node there where that one's first property is the same: a mistake ([`beside`](fn@crate::beside) leaves such files out) |
//! | a property that the lowest layer does not move | its value at rest, on which upper layers are laid |
//! | order of added rotations | the upper layer's is applied to a point first |
//! | mode 1 (override) with a weight | the weight does not count: that is what mode 2 is for |
//! | velocity of a key | means nothing: what programs do by it is in the slopes and weights |
//! | a tangent without a weight | a third; the reader in use takes 0.333333, see [`Reading`] |

mod curve;
mod layers;
mod transform;

pub use curve::{Line, seconds};
pub use layers::Layers;
pub use transform::{Chain, Local, Place, rotation, slerp};

use crate::scene::{Channel, Mesh, Node, Scene, Shows, Target, Vec3};
use glam::{DMat3, DMat4, DQuat, DVec3};
use transform::vec3;

/// How exactly numbers are taken. What a file means is [`Reading::EXACT`]; [`Reading::ROUNDED`] is how the reader in use
/// (ufbx 0.11) rounds a few of them. The distance between the two is what a conversion cannot know of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// The weight of a tangent that names none.
    pub third: f64,
    /// Weights of layers above this one are 1.
    pub full: f64,
    /// Tangents are rounded to 32 bits.
    pub single: bool,
}

impl Reading {
    /// As the file says.
    pub const EXACT: Self = Self {
        third: 1.0 / 3.0,
        full: 1.0,
        single: false,
    };

    /// As the reader in use rounds.
    pub const ROUNDED: Self = Self {
        third: 0.333_333_f32 as f64,
        full: 0.99999,
        single: true,
    };

    fn round(self, x: f64) -> f64 {
        if self.single { f64::from(x as f32) } else { x }
    }
}

/// From the file's axes and unit to glTF's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Space {
    /// Of directions.
    pub turn: DMat3,
    /// Metres of a unit.
    pub unit: f64,
}

impl Space {
    /// Of a file.
    pub fn of(scene: &Scene) -> Self {
        let row = |i: usize| {
            let mut row = DVec3::ZERO;
            row[scene.axes[i].axis] = f64::from(scene.axes[i].sign);
            row
        };
        Self {
            turn: DMat3::from_cols(row(0), row(1), row(2)).transpose(),
            unit: scene.unit * 0.01,
        }
    }

    /// Of a place.
    pub fn place(&self, p: DVec3) -> DVec3 {
        self.turn * p * self.unit
    }

    /// The file's axes are a left hand's.
    pub fn mirrored(&self) -> bool {
        self.turn.determinant() < 0.0
    }
}

/// Where everything is, in glTF's axes and metres.
#[derive(Debug, Clone)]
pub struct Pose {
    /// For each node where it is, and its axes, a column each, as long as its scale in the world.
    pub nodes: Vec<(DVec3, DMat3)>,
    /// For each node that shows a mesh, its vertices.
    pub shapes: Vec<(usize, Vec<DVec3>)>,
}

/// A scene, ready to be asked.
pub struct Truth<'a> {
    scene: &'a Scene,
    chains: Vec<Chain>,
    stacks: Vec<Layers<'a>>,
    space: Space,
    /// For each mesh and joint of its skin, from the mesh's node to the joint.
    binds: Vec<Vec<DMat4>>,
}

impl<'a> Truth<'a> {
    /// Of a scene.
    pub fn of(scene: &'a Scene, reading: Reading) -> Self {
        Self {
            scene,
            chains: scene.nodes.iter().map(chain).collect(),
            stacks: scene
                .stacks
                .iter()
                .map(|stack| Layers::of(stack, reading))
                .collect(),
            space: Space::of(scene),
            binds: binds(scene),
        }
    }

    /// Its axes and unit.
    pub fn space(&self) -> Space {
        self.space
    }

    /// Where everything is at a time on the file's clock, seconds, of a clip; `None` is at rest.
    pub fn at(&self, stack: Option<usize>, time: f64) -> Pose {
        let worlds = self.worlds(stack, time);
        let space = &self.space;
        let shapes = self
            .scene
            .nodes
            .iter()
            .enumerate()
            .filter_map(|(number, node)| {
                let Shows::Mesh(mesh) = node.shows else {
                    return None;
                };
                let points = self.shape(
                    &self.scene.meshes[mesh],
                    mesh,
                    node,
                    number,
                    &worlds,
                    stack,
                    time,
                );
                Some((number, points.into_iter().map(|p| space.place(p)).collect()))
            });
        let nodes = worlds.iter().map(|world| {
            let axes = DMat3::from_mat4(world.matrix);
            (
                space.place(world.matrix.w_axis.truncate()),
                space.turn * axes,
            )
        });
        Pose {
            nodes: nodes.collect(),
            shapes: shapes.collect(),
        }
    }

    /// A property of one number in a clip, `rest` where nothing moves it, at a time on the file's clock.
    pub fn number(&self, stack: usize, target: Target, rest: f64, time: f64) -> f64 {
        self.stacks[stack].at(target, [rest, 0.0, 0.0], 0, time)[0]
    }

    fn value(
        &self,
        stack: Option<usize>,
        target: Target,
        rest: Vec3,
        order: i32,
        time: f64,
    ) -> Vec3 {
        match stack {
            Some(stack) => self.stacks[stack].at(target, rest, order, time),
            None => rest,
        }
    }

    fn worlds(&self, stack: Option<usize>, time: f64) -> Vec<Place> {
        let mut worlds: Vec<Place> = Vec::with_capacity(self.scene.nodes.len());
        for (number, node) in self.scene.nodes.iter().enumerate() {
            let value = |target, rest| self.value(stack, target, rest, node.order, time);
            let translation = value(Target::Translation(number), node.translation);
            let turn = value(Target::Rotation(number), node.rotation);
            let scaling = value(Target::Scaling(number), node.scaling);
            let order = if node.active { node.order } else { 0 };
            let local = self.chains[number].local(translation, rotation(turn, order), scaling);
            let above = node.parent.map_or(Place::ROOT, |parent| worlds[parent]);
            worlds.push(above.below(&local, node.inherit));
        }
        worlds
    }

    fn shape(
        &self,
        mesh: &Mesh,
        number: usize,
        node: &Node,
        place: usize,
        worlds: &[Place],
        stack: Option<usize>,
        time: f64,
    ) -> Vec<DVec3> {
        let mut points: Vec<DVec3> = mesh.points.iter().copied().map(vec3).collect();
        for (index, channel) in mesh.channels.iter().enumerate() {
            let rest = [channel.percent, 0.0, 0.0];
            let percent = self.value(stack, Target::Percent(number, index), rest, 0, time)[0];
            for (share, (_, moved)) in shares(channel, percent).into_iter().zip(&channel.shapes) {
                for &(vertex, by) in moved {
                    points[vertex] += vec3(by) * share;
                }
            }
        }
        let geometric = geometric(node);
        let own = worlds[place].matrix * geometric;
        if mesh.skin.is_empty() {
            return points
                .into_iter()
                .map(|p| own.transform_point3(p))
                .collect();
        }
        let mut sums = vec![(DVec3::ZERO, 0.0); points.len()];
        for (cluster, bound) in mesh.skin.iter().zip(&self.binds[number]) {
            let matrix = worlds[cluster.node].matrix * *bound * geometric;
            for &(vertex, weight) in &cluster.weights {
                sums[vertex].0 += matrix.transform_point3(points[vertex]) * weight;
                sums[vertex].1 += weight;
            }
        }
        let placed = sums
            .into_iter()
            .zip(points)
            .map(|((sum, weight), p)| match weight > 0.0 {
                true => sum / weight,
                false => own.transform_point3(p),
            });
        placed.collect()
    }
}

fn geometric(node: &Node) -> DMat4 {
    let Some([translation, turn, scaling]) = node.geometric else {
        return DMat4::IDENTITY;
    };
    DMat4::from_scale_rotation_translation(vec3(scaling), rotation(turn, 0), vec3(translation))
}

fn chain(node: &Node) -> Chain {
    let turn = |angles| match node.active {
        true => rotation(angles, 0),
        false => DQuat::IDENTITY,
    };
    Chain {
        turns: [turn(node.pre), turn(node.post)],
        about: [vec3(node.rotation_offset), vec3(node.rotation_pivot)],
        from: [vec3(node.scaling_offset), vec3(node.scaling_pivot)],
    }
}

/// How much of each of a channel's shapes is there at so many per cent: between two it is their mixture, beyond the last
/// it goes on straight.
fn shares(channel: &Channel, percent: f64) -> Vec<f64> {
    let mut out = vec![0.0; channel.shapes.len()];
    let at = |i: usize| channel.shapes[i].0;
    let Some(last) = channel.shapes.len().checked_sub(1) else {
        return out;
    };
    let next = (0..last).find(|&i| percent < at(i)).unwrap_or(last);
    let from = if next == 0 { 0.0 } else { at(next - 1) };
    let share = (percent - from) / (at(next) - from);
    out[next] = share;
    if next > 0 {
        out[next - 1] = 1.0 - share;
    }
    out
}

/// Where every node is at rest, in the file's axes and unit.
fn still(scene: &Scene) -> Vec<Place> {
    let still = Truth {
        scene,
        chains: scene.nodes.iter().map(chain).collect(),
        stacks: Vec::new(),
        space: Space::of(scene),
        binds: Vec::new(),
    };
    still.worlds(None, 0.0)
}

fn binds(scene: &Scene) -> Vec<Vec<DMat4>> {
    if scene.meshes.iter().all(|mesh| mesh.skin.is_empty()) {
        return vec![Vec::new(); scene.meshes.len()];
    }
    let worlds = still(scene);
    let of_mesh = |(number, mesh): (usize, &Mesh)| {
        let bound = |cluster: &crate::scene::Cluster| bound(scene, &worlds, number, cluster.node).0;
        mesh.skin.iter().map(bound).collect()
    };
    scene.meshes.iter().enumerate().map(of_mesh).collect()
}

fn bound(scene: &Scene, worlds: &[Place], mesh: usize, joint: usize) -> (DMat4, DMat4) {
    let shown = scene
        .nodes
        .iter()
        .position(|node| node.shows == Shows::Mesh(mesh));
    let own = shown.map_or(DMat4::IDENTITY, |node| worlds[node].matrix);
    let link = worlds[joint].matrix;
    (link.inverse() * own, link)
}

/// Of a joint of a mesh's skin, bound at rest: from the mesh's node to the joint, and from the joint to the world.
pub fn bind(scene: &Scene, mesh: usize, joint: usize) -> (DMat4, DMat4) {
    bound(scene, &still(scene), mesh, joint)
}
