//! How far refitted weights leave vertices from the file's own deformation, at any time.
//!
//! Weights are fitted to a few poses; in others they may be further off. So the largest distance is bounded between the
//! file's keys, as the errors of keys are ([`Found`]). Where vertices and keys are too many for that it is looked for at pseudo-random
//! times between keys and on them, and around the largest distances.

use crate::clips::{MorphCurves, Pose, Shells, Stretch, Take};
use crate::curves::{Majorant, NodeCurves, Over, Rates, Reading};
use crate::error::FbxError;
use crate::model::{Model, Skin};
use crate::options::Budget;
use crate::verify::{Chain, Found, Span, Subject, dice, down};
use glam::{DAffine3, DVec3, Vec3};
use std::collections::BTreeMap;

/// Poses of vertices that are looked at, of all clips together, about.
const LOOKS: usize = 300_000;

/// The same where distances are bounded: products of vertices and spans between keys.
const BOUNDED: usize = 100_000;

/// A distance that does not matter, metres.
const NOTHING: f64 = 1e-8;

/// Times of a clip that are looked at, at least and at most.
const TIMES: (usize, usize) = (16, 300);

/// Times around which the largest distance is searched for, looks of each step of that, and steps.
const PEAKS: usize = 4;
const SEARCH: usize = 7;
const STEPS: usize = 3;

/// What a search may have missed, as a share.
const MISSED: f64 = 1.01;

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

/// A time, how far a vertex is off there, and around which other times it stands for.
struct Look {
    error: f64,
    time: f64,
    begin: f64,
    end: f64,
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
    let mut farthest = off(&vertices, skin, &world, &rest);
    let count = (LOOKS / (vertices.len() * takes.len()).max(1)).clamp(TIMES.0, TIMES.1);
    let mut searched = 0.0_f64;
    for take in takes {
        let stretches: Vec<Stretch> = take.plan.gaps().collect();
        let mut poser = Poser::of(
            take,
            refitted,
            (model, &vertices),
            &shells,
            pose.clone(),
            rest.clone(),
        );
        match stretches.len() * vertices.len() <= BOUNDED {
            true => farthest = farthest.max(bounded(&stretches, &mut poser, farthest)),
            false => searched = searched.max(sampled(&stretches, count, &mut poser, budget)?),
        }
    }
    Ok(farthest.max(searched * MISSED))
}

/// Work that a bound may cost, in places of vertices: at most, and for each vertex and each span between keys.
const WORK: (usize, usize) = (1_000_000, 100);

/// A bound of the largest distance in a clip; what is above `expected` is of interest.
fn bounded(stretches: &[Stretch], poser: &mut Poser, expected: f64) -> f64 {
    let mut found = Found::new(expected, NOTHING, f64::INFINITY);
    let most = WORK.0 + WORK.1 * stretches.len() * poser.vertices.len();
    for stretch in stretches {
        for time in [stretch.begin, stretch.end] {
            found.key(poser, time);
        }
        if stretch.end > stretch.begin {
            let span = Span {
                from: stretch.begin,
                to: stretch.end,
                skew: 0.0,
                within: false,
                depth: 0,
            };
            found.first(poser, span, most);
        }
    }
    found.finish(poser, most);
    found.bounds()[0]
}

/// The largest distance at about `count` times of a clip, and around the largest of these.
fn sampled(
    stretches: &[Stretch],
    count: usize,
    poser: &mut Poser,
    budget: &Budget,
) -> Result<f64, FbxError> {
    let mut peaks: Vec<Look> = Vec::new();
    let mut at = |time: f64| poser.look(time, 0.0);
    for mut look in looks(stretches, count) {
        if budget.is_late() {
            break;
        }
        look.error = at(look.time);
        let place = peaks.partition_point(|known| known.error >= look.error);
        peaks.insert(place, look);
        peaks.truncate(PEAKS);
    }
    budget.in_time("weights")?;
    let around = peaks.iter().map(|look| search(look, &mut at));
    Ok(around.fold(0.0, f64::max))
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

/// The largest distance in one pose; `weights` are those of morph targets.
fn off(vertices: &[Vertex], skin: &Skin, world: &[DAffine3], weights: &[f64]) -> f64 {
    let joints = skin.joints.iter().zip(&skin.inverse_bind);
    let matrices: Vec<DAffine3> = joints
        .map(|(&joint, bind)| world[joint] * DAffine3::from_mat4(*bind))
        .collect();
    let far = |vertex: &Vertex| {
        let mut p = vertex.position;
        for (offset, weight) in vertex.offsets.iter().zip(weights) {
            p += *offset * *weight;
        }
        let parts = vertex.differences.iter();
        parts
            .map(|&(joint, weight)| matrices[joint].transform_point3(p) * weight)
            .sum::<DVec3>()
            .length()
    };
    vertices
        .iter()
        .map(far)
        .filter(|far| far.is_finite())
        .fold(0.0, f64::max)
}

/// About `count` times, spread over the stretches: on keys and between them.
fn looks(stretches: &[Stretch], count: usize) -> Vec<Look> {
    let each = (count / stretches.len().max(1)).max(1);
    let step = stretches.len().div_ceil(count).max(1);
    let mut out = Vec::new();
    for (number, stretch) in stretches.iter().enumerate().step_by(step) {
        let at = |share: f64| stretch.begin + (stretch.end - stretch.begin) * share;
        for i in 0..=each {
            let place = match i {
                0 => 0.0,
                _ => (i - 1) as f64 + dice(number, 0, i),
            };
            let share = |off: f64| ((place + off) / each as f64).clamp(0.0, 1.0);
            out.push(Look {
                error: 0.0,
                time: at(share(0.0)),
                begin: at(share(-1.5)),
                end: at(share(1.5)),
            });
        }
    }
    if let Some(last) = stretches.last() {
        out.push(Look {
            error: 0.0,
            time: last.end,
            begin: last.end,
            end: last.end,
        });
    }
    out
}

/// The largest distance around a look.
fn search(look: &Look, at: &mut impl FnMut(f64) -> f64) -> f64 {
    let (mut begin, mut end) = (look.begin, look.end);
    let (mut time, mut error) = (look.time, look.error);
    for _ in 0..STEPS {
        if end <= begin {
            break;
        }
        let step = (end - begin) / (SEARCH - 1) as f64;
        for i in 0..SEARCH {
            let now = begin + step * i as f64;
            let off = at(now);
            if off > error {
                (time, error) = (now, off);
            }
        }
        (begin, end) = ((time - step).max(look.begin), (time + step).min(look.end));
    }
    error
}

/// Puts all nodes to where the file has them, and holds the vertices.
struct Poser<'a> {
    curves: Vec<(usize, NodeCurves<'a>)>,
    morph: Option<MorphCurves<'a>>,
    shells: &'a Shells,
    vertices: &'a [Vertex<'a>],
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
    rates: Vec<Rates>,
    chains: Vec<Chain>,
    work: usize,
}

impl<'a> Poser<'a> {
    fn of(
        take: &Take<'a>,
        refitted: &Refitted,
        (model, vertices): (&'a Model, &'a [Vertex<'a>]),
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
            work: 0,
        }
    }

    fn to(&mut self, time: f64) {
        self.work += 4 * self.movers.len() + self.vertices.len();
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

impl Subject for Poser<'_> {
    fn look(&mut self, time: f64, floor: f64) -> f64 {
        self.to(time);
        off(self.vertices, self.skin, &self.world, &self.weights).max(floor)
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
