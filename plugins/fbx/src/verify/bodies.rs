//! How far vertices are from where they belong.
//!
//! Vertices that follow the same joint and lie beside each other are held together first, in two steps: the balls of joints' spaces
//! that some hundreds of them lie in, and then of every sixteen the error of their mean, and what any of them may
//! be off beside it. Only where that is above what is asked about is each held by itself.

use crate::model::{Mesh, Model, Part, Skin};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::collections::{BTreeMap, BTreeSet};

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

/// What one joint does to a group.
struct Row {
    joint: usize,
    /// The mean of places beside the joint times weights, and of weights.
    place: DVec3,
    weight: f64,
    /// How far those of a vertex are from these at most.
    places: f64,
    weights: f64,
}

/// What a look at a body fills anew.
#[derive(Default)]
pub(super) struct Scratch {
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
                let mut sides: BTreeMap<usize, (DVec3, DVec3)> = BTreeMap::new();
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
                for (&joint, &(low, high)) in &sides {
                    let (all_low, all_high) = &mut boxes[joint];
                    (*all_low, *all_high) = (all_low.min(low), all_high.max(high));
                }
                let ball = |(joint, (low, high)): (usize, (DVec3, DVec3))| Ball {
                    joint,
                    middle: low.midpoint(high),
                    radius: low.distance(high) / 2.0,
                };
                balls.push(sides.into_iter().map(ball).collect());
            }
        }
        let targets = of.targets.len();
        let vertices: usize = of.parts.iter().map(|part| part.positions.len()).sum();
        Self {
            node,
            mesh,
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

    /// The largest distance of a vertex; `floor` where it is less. `off` is what is added to a point by going from where a node
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
            sizes,
            bounds,
            moved,
        } = scratch;
        sizes.clear();
        let joints = self.joints.iter();
        sizes.extend(joints.map(|(joint, _)| size(&off[*joint].matrix3)));
        bounds.clear();
        bounds.extend(self.balls.iter().map(|balls| {
            let far = |ball: &Ball| {
                let middle = off[self.joints[ball.joint].0].transform_point3(ball.middle);
                middle.length() + sizes[ball.joint] * ball.radius
            };
            SUM * (balls.iter().map(far).fold(0.0, f64::max) + morphed)
        }));
        *work += self.balls.len() / 2;
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
    // Bits of three numbers in turn (Morton, 1966).
    let spread = |x: f64| (0..10).fold(0, |sum, bit| sum | (x as u64 >> bit & 1) << (3 * bit));
    let mut keyed: Vec<(usize, u64, u32)> = (0..part.positions.len())
        .map(|vertex| {
            let most = follows(part, vertex, skinned).fold((0, 0.0), |most, next| {
                if next.1 > most.1 { next } else { most }
            });
            let place = (vector(part.positions[vertex]) - low) * scale;
            let code = spread(place.x) | spread(place.y) << 1 | spread(place.z) << 2;
            (most.0, code, vertex as u32)
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
    sides: &mut BTreeMap<usize, (DVec3, DVec3)>,
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
    let held = vertices.iter().map(held).collect();
    let mut rows: Vec<Row> = Vec::new();
    let count = vertices.len() as f64;
    let mut all: Vec<(usize, usize, DVec3, f64)> = Vec::with_capacity(vertices.len() * 4);
    for (number, &vertex) in vertices.iter().enumerate() {
        let place = vector(part.positions[vertex as usize]);
        for (joint, weight) in follows(part, vertex as usize, skinned) {
            let at = rows.iter().position(|row| row.joint == joint);
            let at = at.unwrap_or_else(|| {
                rows.push(Row {
                    joint,
                    place: DVec3::ZERO,
                    weight: 0.0,
                    places: 0.0,
                    weights: 0.0,
                });
                rows.len() - 1
            });
            let beside = joints[joint].1.transform_point3(place);
            let (low, high) = sides.entry(joint).or_insert((beside, beside));
            (*low, *high) = (low.min(beside), high.max(beside));
            rows[at].place += beside * (weight / count);
            rows[at].weight += weight / count;
            match all
                .iter_mut()
                .rev()
                .find(|one| (one.0, one.1) == (number, at))
            {
                // A vertex may follow a joint twice.
                Some(one) => {
                    one.2 += beside * weight;
                    one.3 += weight;
                }
                None => all.push((number, at, beside * weight, weight)),
            }
        }
    }
    for (at, row) in rows.iter_mut().enumerate() {
        let its = all.iter().filter(|one| one.1 == at);
        let (mut seen, mut places, mut weights) = (0, 0.0_f64, 0.0_f64);
        for (_, _, place, weight) in its {
            seen += 1;
            places = places.max(place.distance(row.place));
            weights = weights.max((weight - row.weight).abs());
        }
        if seen < vertices.len() {
            places = places.max(row.place.length());
            weights = weights.max(row.weight);
        }
        (row.places, row.weights) = (places, weights);
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
