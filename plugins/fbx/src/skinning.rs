//! Influences of the file become weights of the result.

use crate::clips::{Samples, Take, in_parts, threads};
use crate::error::FbxError;
use crate::model::{Mesh, Model};
use crate::options::{Budget, Options};
use crate::read::convert::{matrix, vec3};
use crate::read::{Influence, SkinSource};
use crate::report::{Lost, Report};
use crate::weight_error::{Refitted, weight_error};
use crate::weights::{Fit, fit, packed};
use glam::{DAffine3, DMat4, DVec3};
use std::collections::BTreeMap;
use ufbx::{EvaluateOpts, SceneRoot, SkinDeformer};

/// Poses that weights are fitted to, over all clips.
const POSES: usize = 20;

/// Work of fitting a vertex's weights, in poses of nodes.
const FIT: usize = 60;

/// A mesh, its skin and what the file says of them.
pub(crate) struct SkinJob {
    pub(crate) mesh: usize,
    pub(crate) skin: usize,
    pub(crate) source: SkinSource,
    /// Number of the FBX mesh.
    pub(crate) fbx_mesh: usize,
}

/// A pose of all nodes, and when it is.
struct Moment {
    stack: usize,
    time: f64,
    world: Vec<DAffine3>,
}

/// Gives every vertex of every skinned mesh its joints and weights.
pub(crate) fn write_weights(
    scene: &SceneRoot,
    model: &mut Model,
    jobs: &[SkinJob],
    (takes, clips): (&[Take], &[Samples]),
    options: &Options,
    budget: &Budget,
    report: &mut Report,
) -> Result<(), FbxError> {
    let count = options.weights.count();
    let fits = |job: &&SkinJob| {
        job.source.dual || job.source.influences.iter().any(|list| list.len() > count)
    };
    let moments = match jobs.iter().find(fits) {
        Some(_) => moments(model, clips),
        None => Vec::new(),
    };
    for job in jobs {
        let influences = job.source.influences.iter();
        let needy = influences.filter(|list| job.source.dual || list.len() > count);
        let needy = needy.count();
        budget.must(needy * FIT, "the weights of a skin")?;
        if job.source.dual {
            let of_scene = scene.meshes.iter().map(|mesh| mesh.num_vertices);
            budget.must(
                of_scene.sum::<usize>() * moments.len(),
                "the weights of a skin",
            )?;
        }
        let bent = match job.source.dual {
            true => Some(bent_by_ufbx(scene, job.fbx_mesh, &moments)?),
            false => None,
        };
        let matrices = joint_matrices(model, job, &moments);
        let mesh: &ufbx::Mesh = &scene.meshes[job.fbx_mesh];
        // The bind matrices put it back.
        let offset = model.meshes[job.mesh].offset;
        let all = &job.source.influences;
        let positions: Vec<DVec3> = (0..all.len())
            .map(|vertex| vec3(mesh.vertices[vertex]) - offset)
            .collect();
        let mut kept = Vec::with_capacity(all.len());
        let mut dual = Fit::default();
        let mut refitted = BTreeMap::new();
        let enough = enough(mesh, options);
        let fitted = |vertex: usize| {
            if vertex.is_multiple_of(64) {
                options.report("weights", vertex as f64 / all.len() as f64);
            }
            let influences = &all[vertex];
            if bent.is_none() && influences.len() <= count {
                return (packed(influences, count), None);
            }
            let position = positions[vertex];
            let at = |pose: usize, joint: usize| matrices[pose][joint];
            let targets: Vec<DVec3> = match &bent {
                Some(bent) => bent.iter().map(|pose| pose[vertex]).collect(),
                None => (0..moments.len())
                    .map(|pose| blended(influences, position, |joint| at(pose, joint)))
                    .collect(),
            };
            let (few, fit) = fit(influences, count, position, &targets, enough, at);
            (packed(&few, count), Some(fit))
        };
        let threads = threads(needy * FIT, options);
        let parts = in_parts(all.len(), threads, |range| {
            range.map(&fitted).collect::<Vec<_>>()
        });
        for (vertex, (few, fit)) in parts.into_iter().flatten().enumerate() {
            if let Some(fit) = fit {
                match bent.is_some() {
                    true => dual.error = dual.error.max(fit.error),
                    false => {
                        report.refitted += 1;
                        report.weight_error = report.weight_error.max(fit.error);
                        let largest = report.largest_weights_error.max(fit.largest);
                        report.largest_weights_error = largest;
                        refitted.insert(vertex as u32, differences(&all[vertex], &few));
                    }
                }
            }
            kept.push(few);
        }
        if bent.is_some() {
            let skin = &model.skins[job.skin];
            report.lost.push(Lost {
                what: "dual-quaternion",
                name: skin.name.clone(),
                metres: Some(dual.error),
                detail: "bends by dual quaternions, which glTF does not; weights are fitted to come near"
                    .into(),
            });
        }
        give(&mut model.meshes[job.mesh], &kept, count);
        if !refitted.is_empty() {
            let refitted = Refitted {
                mesh: job.mesh,
                skin: job.skin,
                differences: refitted,
            };
            let error = weight_error(&refitted, model, takes, budget)?;
            report.weight_error = report.weight_error.max(error);
        }
    }
    Ok(())
}

/// For each joint how much more a vertex follows it in the file than as it is written.
fn differences(influences: &[Influence], written: &[([u16; 4], [f32; 4])]) -> Vec<(usize, f64)> {
    let mut out: Vec<(usize, f64)> = influences.iter().map(|i| (i.joint, i.weight)).collect();
    let written = written.iter().flat_map(|(j, w)| j.iter().zip(w));
    for (&joint, &weight) in written.filter(|(_, weight)| **weight != 0.0) {
        let joint = usize::from(joint);
        match out.iter_mut().find(|known| known.0 == joint) {
            Some(known) => known.1 -= f64::from(weight),
            None => out.push((joint, -f64::from(weight))),
        }
    }
    out
}

/// A tenth of the error that keys are allowed: metres.
fn enough(mesh: &ufbx::Mesh, options: &Options) -> f64 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for vertex in mesh
        .vertices
        .iter()
        .map(|&v| vec3(v))
        .filter(|v| v.is_finite())
    {
        (low, high) = (low.min(vertex), high.max(vertex));
    }
    let size = (high - low).length();
    let size = if size.is_finite() { size } else { 0.0 };
    0.1 * options.max_error.min(options.max_relative_error * size)
}

/// Poses spread evenly over all clips.
fn moments(model: &Model, clips: &[Samples]) -> Vec<Moment> {
    let shells = crate::clips::Shells::of(model);
    let rest: Vec<_> = model.nodes.iter().map(|node| node.rest).collect();
    let all: usize = clips.iter().map(|clip| clip.grid.len()).sum();
    let step = all.div_ceil(POSES).max(1);
    let mut moments = Vec::new();
    let mut number = 0;
    for (stack, clip) in clips.iter().enumerate() {
        for sample in 0..clip.grid.len() {
            number += 1;
            if (number - 1) % step != 0 {
                continue;
            }
            let mut pose = rest.clone();
            for track in &clip.tracks {
                pose[track.node] = track.poses[sample];
            }
            let mut world = Vec::new();
            shells.world(&pose, &mut world);
            let time = clip.grid.times[sample];
            moments.push(Moment { stack, time, world });
        }
    }
    moments
}

fn joint_matrices(model: &Model, job: &SkinJob, moments: &[Moment]) -> Vec<Vec<DAffine3>> {
    let skin = &model.skins[job.skin];
    let bind: Vec<DAffine3> = skin.inverse_bind.iter().map(affine).collect();
    let of = |moment: &Moment| {
        let joints = skin.joints.iter().zip(&bind);
        joints
            .map(|(&node, bind)| moment.world[node] * *bind)
            .collect()
    };
    moments.iter().map(of).collect()
}

fn affine(m: &DMat4) -> DAffine3 {
    DAffine3::from_mat4(*m)
}

fn blended(influences: &[Influence], position: DVec3, matrix: impl Fn(usize) -> DAffine3) -> DVec3 {
    let part = |i: &Influence| matrix(i.joint).transform_point3(position) * i.weight;
    influences.iter().map(part).sum()
}

/// Where ufbx puts each vertex at each moment, for skins that are more than linear.
fn bent_by_ufbx(
    scene: &SceneRoot,
    mesh: usize,
    moments: &[Moment],
) -> Result<Vec<Vec<DVec3>>, FbxError> {
    let mut out = Vec::with_capacity(moments.len());
    for moment in moments {
        let anim: &ufbx::Anim = &scene.anim_stacks[moment.stack].anim;
        let Ok(posed) = ufbx::evaluate_scene(scene, anim, moment.time, EvaluateOpts::default())
        else {
            continue;
        };
        let mesh: &ufbx::Mesh = &posed.meshes[mesh];
        let Some(skin) = (&mesh.skin_deformers).into_iter().next() else {
            continue;
        };
        let instance = (&mesh.element.instances).into_iter().next();
        let still = instance.map_or_else(ufbx::identity_matrix, |node| node.geometry_to_world);
        out.push(bent(mesh, skin, &still));
    }
    Ok(out)
}

fn bent(mesh: &ufbx::Mesh, skin: &SkinDeformer, still: &ufbx::Matrix) -> Vec<DVec3> {
    (0..mesh.num_vertices)
        .map(|vertex| {
            let position = vec3(mesh.vertices[vertex]);
            let m = match vertex < skin.vertices.len() {
                true => ufbx::get_skin_vertex_matrix(skin, vertex, still),
                false => *still,
            };
            matrix(&m).transform_point3(position)
        })
        .collect()
}

/// Spreads what FBX vertices have over the vertices that came of them.
fn give(mesh: &mut Mesh, kept: &[Vec<([u16; 4], [f32; 4])>], count: usize) {
    for part in &mut mesh.parts {
        part.joints.clear();
        part.weights.clear();
        // One set of four joints after another.
        (0..count / 4).for_each(|set| {
            let of = |&source: &u32| kept[source as usize][set];
            let (joints, weights): (Vec<_>, Vec<_>) = part.sources.iter().map(of).unzip();
            // A second set of nothing but zeros says nothing.
            if set == 0 || weights.iter().any(|w| *w != [0.0; 4]) {
                part.joints.push(joints);
                part.weights.push(weights);
            }
        });
    }
}
