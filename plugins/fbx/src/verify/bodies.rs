//! How far vertices are from where they belong.
//!
//! Vertices that follow the same joint and lie beside each other are held together first, in two steps: the balls of joints' spaces
//! that some hundreds of them lie in, and then of every sixteen the error of their mean, and what any of them may
//! be off beside it. Only where that is above what is asked about is each held by itself.

use crate::model::{Mesh, Model, Part, Skin};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::collections::BTreeSet;

/// Vertices that are held together.
const TOGETHER: usize = 16;

/// Of these groups, those that are held together first.
const GROUPS: usize = 12;

/// Products of vertices and morph targets that are worked out; of larger meshes only a bound is.
const TARGETS: usize = 100_000;

/// Weights of a vertex sum to 1 as f32 has it.
const SUM: f64 = 1.0 + 1e-6;

/// A mesh on a node that moves, or with joints that do.
pub(crate) struct Body {
    /// The node that shows it.
    pub(super) node: usize,
    pub(super) mesh: usize,
    /// Nodes that its vertices follow, and the way to them from the mesh.
    joints: Vec<(usize, DAffine3)>,
    /// For each of these, the box of what follows it, in the node's own unit.
    boxes: Vec<(DVec3, DVec3)>,
    groups: Vec<Group>,
    /// For each joint that anything follows, the ball of all that does.
    wholes: Vec<Ball>,
    /// For every [`GROUPS`] of them, the balls that they lie in.
    balls: Vec<Vec<Ball>>,
    /// How far each morph target reaches.
    reaches: Vec<f64>,
    each_target: bool,
    /// What vertices follow, those of a vertex together: numbers of joints, and weights.
    follows: Vec<(u32, f64)>,
}

/// Some vertices of a part.
struct Group {
    part: usize,
    vertices: Vec<Held>,
    rows: Vec<Row>,
}

/// A vertex of a group.
struct Held {
    number: u32,
    place: DVec3,
    /// Where in [`Body::follows`] what it follows begins and ends.
    follows: (u32, u32),
}

/// Where what follows a joint lies beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ball {
    joint: usize,
    middle: DVec3,
    radius: f64,
}

impl Ball {
    /// Around a box.
    fn around(joint: usize, (low, high): &(DVec3, DVec3)) -> Self {
        Self {
            joint,
            middle: low.midpoint(*high),
            radius: low.distance(*high) / 2.0,
        }
    }

    /// How far what lies in it is moved at most; `size` is that of the matrix that moves it.
    fn far(&self, off: &DAffine3, size: f64) -> f64 {
        off.transform_point3(self.middle).length() + size * self.radius
    }
}

/// What one joint does to a group.
struct Row {
    joint: usize,
    /// The mean of places beside the joint times weights, and of weights.
    place: DVec3,
    weight: f64,
    /// How far those of a vertex are from these at most.
    places: f64,
    weights: f64,
    /// How many vertices do not follow it.
    misses: usize,
}

/// What a look at a body fills anew.
#[derive(Default)]
pub(super) struct Scratch {
    /// The largest distance of all that follows one joint alone, over all joints: in the last look at a body, where that is a
    /// sum over joints and nothing else. No mixture of looks is off by more than the same mixture of these, all added.
    pub(super) reach: f64,
    reaches: Vec<f64>,
    sizes: Vec<f64>,
    bounds: Vec<f64>,
    moved: Vec<(DAffine3, DMat3)>,
}

/// All of a model's.
pub(crate) struct Bodies(pub(super) Vec<Body>);

/// Weights of a mesh's morph targets: the file's, and the keys'.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Weights {
    pub(super) wanted: Vec<f64>,
    pub(super) played: Vec<f64>,
}

impl Bodies {
    /// Of a model as it stands, of which clips move some nodes and the morph targets of some meshes.
    pub(crate) fn of(model: &Model, moved: &[bool], morphed: &BTreeSet<usize>) -> Self {
        let nodes = model.nodes.iter().enumerate();
        let bodies = nodes.filter_map(|(number, node)| {
            let mesh = node.mesh?;
            let skin = node.skin.map(|skin| &model.skins[skin]);
            let moves = match skin {
                None => moved[number],
                Some(skin) => skin.joints.iter().any(|&joint| moved[joint]),
            };
            if !moves && !morphed.contains(&mesh) {
                return None;
            }
            Some(Body::of(number, mesh, &model.meshes[mesh], skin))
        });
        Self(bodies.collect())
    }
}

/// What a vertex follows: numbers of joints in the skin, and weights.
fn follows(part: &Part, vertex: usize, skinned: bool) -> impl Iterator<Item = (usize, f64)> {
    let sets = part.joints.iter().zip(&part.weights);
    let pairs = sets.flat_map(move |(joints, weights)| {
        joints[vertex]
            .into_iter()
            .map(usize::from)
            .zip(weights[vertex].map(f64::from))
    });
    let pairs = pairs.filter(move |(_, weight)| skinned && *weight > 0.0);
    pairs.chain((!skinned).then_some((0, 1.0)))
}

fn vector(p: [f32; 3]) -> DVec3 {
    Vec3::from(p).as_dvec3()
}

impl Body {
    fn of(node: usize, mesh: usize, of: &Mesh, skin: Option<&Skin>) -> Self {
        let joints: Vec<(usize, DAffine3)> = match skin {
            None => vec![(node, DAffine3::IDENTITY)],
            Some(skin) => {
                let binds = skin.inverse_bind.iter();
                let pairs = skin.joints.iter().zip(binds);
                pairs
                    .map(|(&joint, bind)| (joint, DAffine3::from_mat4(*bind)))
                    .collect()
            }
        };
        let mut boxes = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); joints.len()];
        let (mut groups, mut balls, mut all_follows) = (Vec::new(), Vec::new(), Vec::new());
        for (number, part) in of.parts.iter().enumerate() {
            let order = order(part, skin.is_some());
            for some in order.chunks(GROUPS * TOGETHER) {
                // Few joints.
                let mut sides: Vec<(usize, (DVec3, DVec3))> = Vec::new();
                for vertices in some.chunks(TOGETHER) {
                    groups.push(group(
                        part,
                        number,
                        vertices,
                        skin.is_some(),
                        &joints,
                        &mut sides,
                        &mut all_follows,
                    ));
                }
                for &(joint, (low, high)) in &sides {
                    let (all_low, all_high) = &mut boxes[joint];
                    (*all_low, *all_high) = (all_low.min(low), all_high.max(high));
                }
                let ball = |(joint, sides): &(usize, (DVec3, DVec3))| Ball::around(*joint, sides);
                balls.push(sides.iter().map(ball).collect());
            }
        }
        let has_some = |(_, (low, _)): &(usize, &(DVec3, DVec3))| low.is_finite();
        let wholes = boxes.iter().enumerate().filter(has_some);
        let wholes = wholes.map(|(joint, sides)| Ball::around(joint, sides));
        let targets = of.targets.len();
        let vertices: usize = of.parts.iter().map(|part| part.positions.len()).sum();
        Self {
            node,
            mesh,
            wholes: wholes.collect(),
            joints,
            boxes,
            groups,
            balls,
            reaches: of.targets.iter().map(|target| target.reach).collect(),
            each_target: vertices * targets <= TARGETS,
            follows: all_follows,
        }
    }

    /// Whether anything that it follows is in `moving`.
    pub(super) fn moves(&self, moving: &[bool]) -> bool {
        self.joints.iter().any(|(joint, _)| moving[*joint])
    }

    pub(super) fn has_targets(&self) -> bool {
        !self.reaches.is_empty()
    }

    /// The sum of what morph targets move vertices by at most.
    pub(super) fn reach(&self, weights: impl Iterator<Item = f64>) -> f64 {
        let each = self.reaches.iter().zip(weights);
        each.map(|(reach, weight)| reach * weight.abs()).sum()
    }

    pub(super) fn reaches(&self) -> &[f64] {
        &self.reaches
    }

    /// Nodes that it follows, and for each how far a vertex that follows is from it and how much longer a way within
    /// the mesh is there.
    pub(super) fn levers(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let joints = self.joints.iter().zip(&self.boxes);
        joints.map(|((joint, bind), (low, high))| {
            let far = low.abs().max(high.abs()).length();
            (
                *joint,
                if far.is_finite() { far } else { 0.0 },
                size(&bind.matrix3),
            )
        })
    }

    /// The largest distance of a vertex; `floor`, which is not below 0, where it is less. `off` is what is added to a point by going from where a node
    /// belongs to where it is, and `world` where it belongs.
    pub(super) fn farthest(
        &self,
        model: &Model,
        off: &[DAffine3],
        world: &[DAffine3],
        weights: &Weights,
        floor: f64,
        (scratch, work): (&mut Scratch, &mut usize),
    ) -> f64 {
        let mut morphed = 0.0;
        if self.has_targets() {
            let changes = weights.wanted.iter().zip(&weights.played);
            let change = self.reach(changes.map(|(a, b)| b - a));
            let reach = self.reach(weights.played.iter().copied());
            let each = self.joints.iter().map(|(joint, bind)| {
                let (off, world) = (off[*joint].matrix3, world[*joint].matrix3);
                size(&(off * bind.matrix3)) * reach + size(&(world * bind.matrix3)) * change
            });
            morphed = each.fold(0.0, f64::max);
        }
        let Scratch {
            reach,
            reaches,
            sizes,
            bounds,
            moved,
        } = scratch;
        *work += self.balls.len() / 2;
        sizes.clear();
        let joints = self.joints.iter();
        sizes.extend(joints.map(|(joint, _)| size(&off[*joint].matrix3)));
        reaches.clear();
        reaches.resize(self.joints.len(), 0.0);
        *reach = 0.0;
        for ball in &self.wholes {
            let far = ball.far(&off[self.joints[ball.joint].0], sizes[ball.joint]);
            reaches[ball.joint] = SUM * (far + morphed);
            *reach = reach.max(reaches[ball.joint]);
        }
        let is_above = *reach > floor;
        if self.has_targets() {
            *reach = f64::INFINITY;
        }
        if !is_above {
            return floor;
        }
        bounds.clear();
        bounds.extend(self.balls.iter().map(|balls| {
            // Most joints are off by less than is asked about, wherever what follows them lies.
            let above = balls.iter().filter(|ball| reaches[ball.joint] > floor);
            let far = |ball: &Ball| {
                SUM * (ball.far(&off[self.joints[ball.joint].0], sizes[ball.joint]) + morphed)
            };
            above.map(far).fold(floor, f64::max)
        }));
        let Some(first) = (0..bounds.len()).max_by(|&a, &b| bounds[a].total_cmp(&bounds[b])) else {
            return floor;
        };
        if bounds[first] <= floor {
            return floor;
        }
        moved.clear();
        moved.extend(
            self.joints
                .iter()
                .map(|(joint, bind)| (off[*joint] * *bind, world[*joint].matrix3 * bind.matrix3)),
        );
        let mut farthest = floor;
        // What is expected to be the farthest goes first.
        let others = (0..bounds.len()).filter(|&at| at != first);
        for at in [first].into_iter().chain(others) {
            if bounds[at] <= farthest {
                continue;
            }
            let some = self.groups[at * GROUPS..].iter().take(GROUPS);
            for group in some {
                *work += 1;
                let bound = SUM * (group.bound(&self.joints, off, sizes) + morphed);
                if bound <= farthest {
                    continue;
                }
                farthest = match self.has_targets() && !self.each_target {
                    true => bound,
                    false => {
                        *work += group.vertices.len() / 2;
                        farthest.max(self.each(group, model, moved, weights))
                    }
                };
            }
        }
        farthest
    }

    /// The largest distance of the vertices of a group.
    fn each(
        &self,
        group: &Group,
        model: &Model,
        moved: &[(DAffine3, DMat3)],
        weights: &Weights,
    ) -> f64 {
        let part = &model.meshes[self.mesh].parts[group.part];
        let mut farthest = 0.0_f64;
        for held in &group.vertices {
            let mut place = held.place;
            let mut change = DVec3::ZERO;
            let follows = &self.follows[held.follows.0 as usize..held.follows.1 as usize];
            if !self.has_targets() {
                let mut sum = DVec3::ZERO;
                for &(joint, weight) in follows {
                    sum += moved[joint as usize].0.transform_point3(place) * weight;
                }
                farthest = farthest.max(sum.length_squared());
                continue;
            }
            let pairs = weights.wanted.iter().zip(&weights.played);
            for ((offsets, _), (wanted, played)) in part.offsets.iter().zip(pairs) {
                let offset = vector(offsets[held.number as usize]);
                place += offset * *played;
                change += offset * (played - wanted);
            }
            let parts = follows.iter().map(|&(joint, weight)| {
                let (off, world) = &moved[joint as usize];
                (off.transform_point3(place) + *world * change) * weight
            });
            farthest = farthest.max(parts.sum::<DVec3>().length_squared());
        }
        farthest.sqrt()
    }
}

/// The vertices of a part, those that follow the same joint beside each other, and of these those that lie near together.
fn order(part: &Part, skinned: bool) -> Vec<u32> {
    let places = part.positions.iter().map(|p| vector(*p));
    let (low, high) = places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    let scale = (high - low).max_element().max(1e-30).recip() * 1023.0;
    // Bits of three numbers in turn (Morton, 1966): of ten bits each goes to the place of three times its number.
    let spread = |x: f64| {
        [
            (16, 0x0300_00ff),
            (8, 0x0300_f00f),
            (4, 0x030c_30c3),
            (2, 0x0924_9249),
        ]
        .iter()
        .fold(x as u32, |bits, (by, mask)| (bits | bits << by) & mask)
    };
    let mut keyed: Vec<(u32, u32, u32)> = (0..part.positions.len())
        .map(|vertex| {
            let most = follows(part, vertex, skinned).fold((0, 0.0), |most, next| {
                if next.1 > most.1 { next } else { most }
            });
            let place = (vector(part.positions[vertex]) - low) * scale;
            let code = spread(place.x) | spread(place.y) << 1 | spread(place.z) << 2;
            (most.0 as u32, code, vertex as u32)
        })
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, _, vertex)| vertex).collect()
}

fn group(
    part: &Part,
    number: usize,
    vertices: &[u32],
    skinned: bool,
    joints: &[(usize, DAffine3)],
    sides: &mut Vec<(usize, (DVec3, DVec3))>,
    all_follows: &mut Vec<(u32, f64)>,
) -> Group {
    let held = |&number: &u32| {
        let from = all_follows.len() as u32;
        let its = follows(part, number as usize, skinned);
        all_follows.extend(its.map(|(joint, weight)| (joint as u32, weight)));
        Held {
            number,
            place: vector(part.positions[number as usize]),
            follows: (from, all_follows.len() as u32),
        }
    };
    let held: Vec<Held> = vertices.iter().map(held).collect();
    let mut rows: Vec<Row> = Vec::new();
    let share = 1.0 / vertices.len() as f64;
    // What each vertex has of each row.
    let mut all: Vec<(usize, DVec3, f64)> = Vec::with_capacity(vertices.len() * 4);
    for vertex in &held {
        let begin = all.len();
        for &(joint, weight) in &all_follows[vertex.follows.0 as usize..vertex.follows.1 as usize] {
            let joint = joint as usize;
            let at = rows.iter().position(|row| row.joint == joint);
            let at = at.unwrap_or_else(|| {
                rows.push(Row {
                    joint,
                    place: DVec3::ZERO,
                    weight: 0.0,
                    places: 0.0,
                    weights: 0.0,
                    misses: vertices.len(),
                });
                rows.len() - 1
            });
            let beside = joints[joint].1.transform_point3(vertex.place);
            match sides.iter_mut().find(|(known, _)| *known == joint) {
                Some((_, (low, high))) => (*low, *high) = (low.min(beside), high.max(beside)),
                None => sides.push((joint, (beside, beside))),
            }
            let row = &mut rows[at];
            row.place += beside * (weight * share);
            row.weight += weight * share;
            match all[begin..].iter_mut().find(|one| one.0 == at) {
                // A vertex may follow a joint twice.
                Some(one) => {
                    one.1 += beside * weight;
                    one.2 += weight;
                }
                None => {
                    row.misses -= 1;
                    all.push((at, beside * weight, weight));
                }
            }
        }
    }
    for (at, place, weight) in all {
        let row = &mut rows[at];
        row.places = row.places.max(place.distance(row.place));
        row.weights = row.weights.max((weight - row.weight).abs());
    }
    for row in rows.iter_mut().filter(|row| row.misses > 0) {
        row.places = row.places.max(row.place.length());
        row.weights = row.weights.max(row.weight);
    }
    Group {
        part: number,
        vertices: held,
        rows,
    }
}

impl Group {
    fn bound(&self, joints: &[(usize, DAffine3)], off: &[DAffine3], sizes: &[f64]) -> f64 {
        let (mut mean, mut beside) = (DVec3::ZERO, 0.0);
        for row in &self.rows {
            let off = &off[joints[row.joint].0];
            mean += off.matrix3 * row.place + off.translation * row.weight;
            beside += sizes[row.joint] * row.places + off.translation.length() * row.weights;
        }
        mean.length() + beside
    }
}

/// The most that a matrix makes of a way of one.
fn size(m: &DMat3) -> f64 {
    let columns = [m.x_axis, m.y_axis, m.z_axis];
    columns
        .map(DVec3::length_squared)
        .iter()
        .sum::<f64>()
        .sqrt()
}
