//! How far refitted weights leave vertices from the file's own deformation, at times of its own.
//!
//! Weights are fitted to a few poses; in others they may be further off. So the file's curves are asked at
//! pseudo-random times between its keys and on them, and around the largest distances for the largest.

use crate::clips::{MorphCurves, Pose, Shells, Stretch, Take};
use crate::curves::{NodeCurves, Reading};
use crate::error::FbxError;
use crate::model::{Model, Skin};
use crate::options::Budget;
use crate::verify::dice;
use glam::{DAffine3, DVec3, Vec3};
use std::collections::BTreeMap;

/// Poses of vertices that are looked at, of all clips together, about.
const LOOKS: usize = 300_000;

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
    for take in takes {
        let mut poser = Poser::of(take, refitted.mesh, &shells, pose.clone(), rest.clone());
        let mut at = |time: f64| {
            poser.to(time);
            off(&vertices, skin, &poser.world, &poser.weights)
        };
        let stretches: Vec<Stretch> = take.plan.gaps().collect();
        let mut peaks: Vec<Look> = Vec::new();
        for mut look in looks(&stretches, count) {
            if budget.is_late() {
                break;
            }
            look.error = at(look.time);
            let place = peaks.partition_point(|known| known.error >= look.error);
            peaks.insert(place, look);
            peaks.truncate(PEAKS);
        }
        budget.in_time("weights")?;
        for look in &mut peaks {
            farthest = farthest.max(search(look, &mut at));
        }
    }
    Ok(farthest * MISSED)
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

/// Puts all nodes to where the file has them.
struct Poser<'a> {
    curves: Vec<(usize, NodeCurves<'a>)>,
    morph: Option<MorphCurves<'a>>,
    shells: &'a Shells,
    pose: Pose,
    world: Vec<DAffine3>,
    weights: Vec<f64>,
}

impl<'a> Poser<'a> {
    fn of(take: &Take<'a>, mesh: usize, shells: &'a Shells, pose: Pose, rest: Vec<f64>) -> Self {
        let layers = take.layers(Reading::Usual);
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
            pose,
            world: Vec::new(),
            weights: rest,
        }
    }

    fn to(&mut self, time: f64) {
        for (node, curves) in &mut self.curves {
            self.pose[*node] = curves.at(time);
        }
        if let Some(morph) = &mut self.morph {
            self.weights.clear();
            morph.at(time, &mut self.weights);
        }
        self.shells.world(&self.pose, &mut self.world);
    }
}
