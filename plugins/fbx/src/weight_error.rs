//! How far refitted weights leave vertices from the file's own deformation, at any time.
//!
//! Weights are fitted to a few poses; in others they may be further off. So the largest distance is bounded between the
//! file's keys, as the errors of keys are ([`Found`]), vertices beside each other together ([`groups`]).

use crate::clips::{MorphCurves, Pose, Shells, Stretch, Take};
use crate::curves::{Majorant, NodeCurves, Over, Rates, Reading};
use crate::error::FbxError;
use crate::model::{Model, Skin};
use crate::options::Budget;
use crate::verify::{Chain, Found, Span, Subject, down};
use crate::weight_groups::{Group, Held, groups};
use glam::{DAffine3, DVec3, Vec3};
use std::collections::BTreeMap;

/// Products of vertices and spans between keys of a clip that a bound may cost so many times more of; where there are more, it is less near.
const BOUNDED: usize = 100_000;

/// A distance that does not matter, metres. Fitted weights are off by tenths of a micrometre where they fit: a share of what keys may be
/// off by would be as much as that.
const NOTHING: f64 = 1e-8;

/// Vertices of one mesh whose weights are not the file's.
pub(crate) struct Refitted {
    /// Number of the mesh in the model.
    pub(crate) mesh: usize,
    pub(crate) skin: usize,
    /// For each number of a vertex in the FBX mesh, for each joint the weight in the file less that in the result.
    pub(crate) differences: BTreeMap<u32, Vec<(usize, f64)>>,
}

/// A vertex of the result.
struct Vertex<'a> {
    position: DVec3,
    /// What each morph target adds.
    offsets: Vec<DVec3>,
    differences: &'a [(usize, f64)],
}

impl Vertex<'_> {
    /// How far it is off where joints have the mesh at `matrices`.
    fn off(&self, matrices: &[DAffine3], weights: &[f64]) -> f64 {
        let mut p = self.position;
        for (offset, weight) in self.offsets.iter().zip(weights) {
            p += *offset * *weight;
        }
        let parts = self.differences.iter();
        parts
            .map(|&(joint, weight)| matrices[joint].transform_point3(p) * weight)
            .sum::<DVec3>()
            .length()
    }
}

/// The largest distance, metres, at rest and at any time of the clips.
pub(crate) fn weight_error(
    refitted: &Refitted,
    model: &Model,
    takes: &[Take],
    budget: &Budget,
) -> Result<f64, FbxError> {
    let vertices = vertices(refitted, model);
    let shells = Shells::of(model);
    let skin = &model.skins[refitted.skin];
    let rest: Vec<f64> = model.meshes[refitted.mesh]
        .targets
        .iter()
        .map(|target| target.rest)
        .collect();
    let mut world = Vec::new();
    let pose: Pose = model.nodes.iter().map(|node| node.rest).collect();
    shells.world(&pose, &mut world);
    let groups = match rest.is_empty() {
        true => groups(&held(&vertices)),
        // Morph targets move the vertices themselves.
        false => Vec::new(),
    };
    // What a look costs, in places of vertices.
    let each = if groups.is_empty() {
        vertices.len()
    } else {
        4 * groups.len()
    };
    let there = matrices(skin, &world);
    let mut farthest = off(&vertices, &groups, &there, &rest, 0.0, &mut Vec::new()).0;
    for take in takes {
        let stretches: Vec<Stretch> = take.plan.gaps().collect();
        let mut poser = Poser::of(
            take,
            refitted,
            (model, &vertices, &groups),
            &shells,
            pose.clone(),
            rest.clone(),
        );
        budget.must(stretches.len() * each / VERTICES, "the weights of a skin")?;
        farthest = farthest.max(bounded(&stretches, &mut poser, farthest, budget));
    }
    Ok(farthest)
}

fn held<'a>(vertices: &[Vertex<'a>]) -> Vec<Held<'a>> {
    let one = |vertex: &Vertex<'a>| Held {
        place: vertex.position,
        differences: vertex.differences,
    };
    vertices.iter().map(one).collect()
}

/// Work that a bound may cost, in places of vertices: at most, and for each vertex and each span between keys.
const WORK: (usize, usize) = (1_000_000, 100);

/// Places of vertices that are as much work as a pose of a node.
const VERTICES: usize = 20;

/// A bound of the largest distance in a clip; what is above `expected` is of interest.
fn bounded(stretches: &[Stretch], poser: &mut Poser, expected: f64, budget: &Budget) -> f64 {
    let mut found = Found::new(expected, NOTHING, f64::INFINITY);
    let each = match poser.groups.len() {
        0 => poser.vertices.len(),
        groups => 4 * groups,
    };
    let most = WORK.0 + WORK.1 * (stretches.len() * each).min(BOUNDED);
    let left = usize::try_from(budget.left()).unwrap_or(usize::MAX);
    let most = most.min(left.saturating_mul(VERTICES));
    for stretch in stretches {
        let lasts = stretch.end > stretch.begin;
        // What lasts is bounded at its ends too, but for both sides of what jumps.
        for (time, counts) in [
            (stretch.begin, stretch.jumps || !lasts),
            (stretch.end, stretch.jumps_after),
        ] {
            if counts {
                found.key(poser, time);
            }
        }
        if lasts {
            let span = Span {
                from: stretch.begin,
                to: stretch.end,
                skew: 0.0,
                within: false,
                ends: !stretch.jumps && !stretch.jumps_after,
                depth: 0,
            };
            found.first(poser, span, most);
        }
    }
    found.finish(poser, most);
    budget.pay(poser.work / VERTICES);
    found.bounds()[0]
}

fn vertices<'a>(refitted: &'a Refitted, model: &Model) -> Vec<Vertex<'a>> {
    let mut out = BTreeMap::new();
    let vector = |v: &[f32; 3]| Vec3::from(*v).as_dvec3();
    for part in &model.meshes[refitted.mesh].parts {
        for (vertex, source) in part.sources.iter().enumerate() {
            let Some(differences) = refitted.differences.get(source) else {
                continue;
            };
            out.entry(source).or_insert_with(|| Vertex {
                position: vector(&part.positions[vertex]),
                offsets: part
                    .offsets
                    .iter()
                    .map(|(p, _)| vector(&p[vertex]))
                    .collect(),
                differences,
            });
        }
    }
    out.into_values().collect()
}

/// Where joints have the mesh.
fn matrices(skin: &Skin, world: &[DAffine3]) -> Vec<DAffine3> {
    let joints = skin.joints.iter().zip(&skin.inverse_bind);
    joints
        .map(|(&joint, bind)| world[joint] * DAffine3::from_mat4(*bind))
        .collect()
}

/// The largest distance in one pose, `floor` where it is less, and how many vertices were held by themselves; `matrices` are
/// where joints have the mesh, and `weights` those of morph targets; `bounds` become those of the groups.
fn off(
    vertices: &[Vertex],
    groups: &[Group],
    matrices: &[DAffine3],
    weights: &[f64],
    floor: f64,
    bounds: &mut Vec<f64>,
) -> (f64, usize) {
    let far = |vertex: &Vertex| vertex.off(matrices, weights);
    if groups.is_empty() {
        let each = vertices.iter().map(far).filter(|far| far.is_finite());
        return (each.fold(floor, f64::max), vertices.len());
    }
    let (mut farthest, mut count) = (floor, 0);
    bounds.clear();
    for group in groups {
        let bound = group.bound(matrices);
        bounds.push(bound);
        if bound <= farthest {
            continue;
        }
        count += group.members.len();
        for &member in &group.members {
            farthest = farthest.max(far(&vertices[member]));
        }
    }
    (farthest, count)
}

/// Puts all nodes to where the file has them, and holds the vertices.
struct Poser<'a> {
    curves: Vec<(usize, NodeCurves<'a>)>,
    morph: Option<MorphCurves<'a>>,
    shells: &'a Shells,
    vertices: &'a [Vertex<'a>],
    groups: &'a [Group],
    skin: &'a Skin,
    /// How far each morph target reaches.
    reaches: Vec<f64>,
    /// For each joint that weights differ of: the node, how far vertices are from it, and how much longer a way of a morph
    /// target is there.
    joints: Vec<(usize, f64, f64)>,
    /// The largest sum of differences of one vertex.
    differences: f64,
    moving: Vec<bool>,
    movers: Vec<usize>,
    pose: Pose,
    world: Vec<DAffine3>,
    weights: Vec<f64>,
    /// The time that all of this is of.
    posed: Option<f64>,
    /// Where joints have the mesh: at the last look, at those of a span that were kept, and at the end of the span before.
    matrices: Vec<DAffine3>,
    /// Bounds of the groups there.
    bounds: Vec<f64>,
    kept: Vec<(Vec<DAffine3>, Vec<f64>)>,
    end: (Vec<DAffine3>, Vec<f64>),
    rates: Vec<Rates>,
    chains: Vec<Chain>,
    work: usize,
}

impl<'a> Poser<'a> {
    fn of(
        take: &Take<'a>,
        refitted: &Refitted,
        (model, vertices, groups): (&'a Model, &'a [Vertex<'a>], &'a [Group]),
        shells: &'a Shells,
        pose: Pose,
        rest: Vec<f64>,
    ) -> Self {
        let (layers, mesh) = (take.layers(Reading::Usual), refitted.mesh);
        let skin = &model.skins[refitted.skin];
        let mut joints: BTreeMap<usize, f64> = BTreeMap::new();
        let mut differences = 0.0_f64;
        for vertex in vertices {
            let all = vertex.differences.iter();
            differences = differences.max(all.map(|(_, weight)| weight.abs()).sum());
            for &(joint, _) in vertex.differences {
                let far = skin.inverse_bind[joint].transform_point3(vertex.position);
                let known = joints.entry(joint).or_default();
                *known = known.max(far.length());
            }
        }
        let longer = |joint: usize| {
            let m = skin.inverse_bind[joint];
            let columns = [m.x_axis, m.y_axis, m.z_axis].map(|c| c.truncate().length_squared());
            columns.iter().sum::<f64>().sqrt()
        };
        let moving = shells.moved_by(take.moving.iter().copied());
        let order = shells.in_order().iter().copied();
        let mut world = Vec::new();
        shells.world(&pose, &mut world);
        Self {
            curves: take
                .moving
                .iter()
                .map(|&node| (node, take.curves(&layers, node)))
                .collect(),
            morph: take
                .meshes
                .contains(&mesh)
                .then(|| take.morph(&layers, mesh)),
            shells,
            vertices,
            groups,
            skin,
            reaches: model.meshes[mesh].targets.iter().map(|t| t.reach).collect(),
            joints: joints
                .into_iter()
                .map(|(joint, far)| (joint, far, longer(joint)))
                .collect(),
            differences,
            movers: order.filter(|&node| moving[node]).collect(),
            moving,
            rates: vec![Rates::UNKNOWN; pose.len()],
            chains: vec![Chain::ROOT; pose.len()],
            pose,
            world,
            weights: rest,
            posed: None,
            matrices: Vec::new(),
            bounds: Vec::new(),
            kept: Vec::new(),
            end: <_>::default(),
            work: 0,
        }
    }

    fn to(&mut self, time: f64) {
        if self.posed.replace(time) == Some(time) {
            return;
        }
        self.work += 4 * self.movers.len();
        for (node, curves) in &mut self.curves {
            self.pose[*node] = curves.at(time);
        }
        if let Some(morph) = &mut self.morph {
            self.weights.clear();
            morph.at(time, &mut self.weights);
        }
        let moves = |node: usize| self.moving[node];
        self.shells.world_where(&self.pose, &mut self.world, moves);
    }
}

impl Poser<'_> {
    /// Mixes where joints had the mesh.
    fn mix(&mut self, row: &[f64]) {
        for (joint, out) in self.matrices.iter_mut().enumerate() {
            *out = DAffine3::ZERO;
            for (weight, (matrices, _)) in row.iter().zip(&self.kept) {
                out.matrix3 += matrices[joint].matrix3 * *weight;
                out.translation += matrices[joint].translation * *weight;
            }
        }
    }
}

impl Subject for Poser<'_> {
    fn look(&mut self, time: f64, floor: f64) -> f64 {
        self.to(time);
        self.matrices = matrices(self.skin, &self.world);
        let (vertices, groups) = (self.vertices, self.groups);
        let (matrices, bounds) = (&self.matrices, &mut self.bounds);
        let (far, held) = off(vertices, groups, matrices, &self.weights, floor, bounds);
        self.work += 4 * groups.len() + held;
        far
    }

    fn keep(&mut self, index: usize) {
        if self.kept.len() <= index {
            self.kept.resize(index + 1, <_>::default());
        }
        let (matrices, bounds) = &mut self.kept[index];
        matrices.clone_from(&self.matrices);
        bounds.clone_from(&self.bounds);
    }

    fn keep_end(&mut self, index: usize) {
        self.end.clone_from(&self.kept[index]);
    }

    fn keep_again(&mut self) {
        if self.kept.is_empty() {
            self.kept.push(<_>::default());
        }
        std::mem::swap(&mut self.kept[0], &mut self.end);
    }

    /// A vertex is off by so much of each matrix, but where morph targets move it too.
    fn mixed(&mut self, rows: &[Vec<f64>], floor: f64) -> Option<f64> {
        if self.groups.is_empty() {
            return None;
        }
        // Bounds are lengths of sums over matrices, so that a mixture's is no larger than the same mixture of theirs, all added.
        let long = |row: &Vec<f64>| row.iter().map(|weight| weight.abs()).sum::<f64>();
        let longest = rows.iter().map(long).fold(0.0, f64::max) * (1.0 + 1e-12);
        let looks = rows.first().map_or(0, Vec::len);
        let of_looks = |group: usize| self.kept[..looks].iter().map(move |kept| kept.1[group]);
        let above: Vec<usize> = (0..self.groups.len())
            .filter(|&group| longest * of_looks(group).fold(0.0, f64::max) > floor)
            .collect();
        self.work += self.groups.len();
        let mut most = floor;
        if above.is_empty() {
            return Some(most);
        }
        for row in rows {
            self.mix(row);
            self.work += 4 * above.len();
            for &number in &above {
                let group = &self.groups[number];
                if group.bound(&self.matrices) <= most {
                    continue;
                }
                self.work += group.members.len();
                for &member in &group.members {
                    most = most.max(self.vertices[member].off(&self.matrices, &self.weights));
                }
            }
        }
        Some(most)
    }

    /// A vertex is off by a sum of where its joints would have it, times differences of weights.
    fn rate(&mut self, from: f64, to: f64) -> Majorant {
        let over = Over {
            from,
            to,
            slack: 1e-9,
        };
        self.to(over.middle());
        for &node in &self.movers {
            self.rates[node] = Rates::still(&self.pose[node]);
        }
        for (node, curves) in &mut self.curves {
            self.rates[*node] = curves.over(over);
        }
        let place = (&self.world[..], &self.pose);
        let (movers, moving) = (&self.movers, &self.moving);
        down(
            self.shells,
            movers,
            moving,
            &self.rates,
            place,
            &mut self.chains,
        );
        let mut parts: Vec<Majorant> = self.weights.iter().map(|&w| Majorant::still(w)).collect();
        if let Some(morph) = &mut self.morph {
            parts.clear();
            morph.over(over, &mut parts);
        }
        let morphs = self.reaches.iter().zip(&parts);
        let morphs = morphs.fold(Majorant::ZERO, |sum, (reach, part)| {
            sum.plus(&part.scaled(*reach))
        });
        let mut out = Majorant::ZERO;
        for &(joint, far, longer) in &self.joints {
            let node = self.skin.joints[joint];
            let chain = match self.moving[node] {
                true => self.chains[node],
                false => Chain::still(&self.world[node]),
            };
            let reach = Majorant::still(far).plus(&morphs.scaled(longer));
            out = out.max(&chain.origin.plus(&chain.axes.product(&reach)));
        }
        out.scaled(self.differences)
    }

    fn work(&self) -> usize {
        self.work
    }
}
