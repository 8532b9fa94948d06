//! What rounding to f32 does to vertices, lights and cameras at rest, measured: the numbers that are
//! written, played in f64, against the file's.

use crate::clips::order;
use crate::model::{Mesh, Model, Node, Part, Trs};
use crate::read::convert::vec3;
use crate::report::{Lost, Report};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use ufbx::Scene;

/// Measures what rounding to f32 does, and says so where it is more than keys are allowed.
pub(crate) fn report_position_error(scene: &Scene, model: &Model, report: &mut Report) {
    report.position_error = position_error(scene, model);
    if report.position_error > report.bound {
        report.lost.push(Lost {
            what: "far-place",
            name: "vertices, lights and cameras at rest".into(),
            metres: Some(report.position_error),
            detail: "lie so far from the origin that f32, which glTF's nodes are in, rounds their places"
                .into(),
        });
    }
}

/// The largest distance of a vertex, a light or a camera at rest from where it is without rounding, metres.
/// What is beyond f32 or no number is left out: it is no place.
fn position_error(scene: &Scene, model: &Model) -> f64 {
    let order = order(&model.nodes.iter().map(|n| n.parent).collect::<Vec<_>>());
    let exact = worlds(model, &order, |rest| *rest);
    let rounded = worlds(model, &order, written);
    let mut farthest = 0.0_f64;
    for (number, node) in model.nodes.iter().enumerate() {
        if node.light.is_some() || node.camera.is_some() {
            let off = (exact[number].translation - rounded[number].translation).length();
            if off.is_finite() {
                farthest = farthest.max(off);
            }
        }
        let Some(mesh) = node.mesh.map(|mesh| &model.meshes[mesh]) else {
            continue;
        };
        let Some(source) = scene.meshes.get(mesh.source as usize) else {
            continue;
        };
        let matrices = matrices(model, node, number, &exact, &rounded);
        let mut own = 0.0_f64;
        for part in &mesh.parts {
            own = own.max(of_part(part, mesh, source, node, &matrices));
        }
        farthest = farthest.max(own + of_targets(mesh, &matrices));
    }
    farthest
}

/// For each joint, or for the node alone: the matrix from the mesh to the world, exact and rounded.
fn matrices(
    model: &Model,
    node: &Node,
    number: usize,
    exact: &[DAffine3],
    rounded: &[DAffine3],
) -> Vec<(DAffine3, DAffine3)> {
    let Some(skin) = node.skin.map(|skin| &model.skins[skin]) else {
        return vec![(exact[number], rounded[number])];
    };
    let joints = skin.joints.iter().zip(&skin.inverse_bind);
    let of = |(&joint, bind): (&usize, &glam::DMat4)| {
        let as_written = DAffine3::from_mat4(bind.as_mat4().as_dmat4());
        (
            exact[joint] * DAffine3::from_mat4(*bind),
            rounded[joint] * as_written,
        )
    };
    joints.map(of).collect()
}

/// What rounding the offsets of morph targets can do at most: at weights to 1, all together.
fn of_targets(mesh: &Mesh, matrices: &[(DAffine3, DAffine3)]) -> f64 {
    let reach = mesh.targets.iter().map(|t| t.reach * t.rest.abs().max(1.0));
    let stretch = matrices.iter().flat_map(|(exact, _)| {
        let m = exact.matrix3;
        [m.x_axis.length(), m.y_axis.length(), m.z_axis.length()]
    });
    let off = reach.sum::<f64>() * stretch.fold(0.0, f64::max) / f64::from(1 << 24);
    if off.is_finite() { off } else { 0.0 }
}

fn of_part(
    part: &Part,
    mesh: &Mesh,
    source: &ufbx::Mesh,
    node: &Node,
    matrices: &[(DAffine3, DAffine3)],
) -> f64 {
    let mut farthest = 0.0_f64;
    for (vertex, (&number, position)) in part.sources.iter().zip(&part.positions).enumerate() {
        let Some(truth) = source.vertices.get(number as usize) else {
            continue;
        };
        let truth = vec3(*truth) - mesh.offset;
        let position = Vec3::from(*position).as_dvec3();
        let apart = |(exact, rounded): &(DAffine3, DAffine3)| {
            rounded.transform_point3(position) - exact.transform_point3(truth)
        };
        let off = match node.skin {
            None => matrices.first().map_or(DVec3::ZERO, apart),
            Some(_) => {
                let sets = part.joints.iter().zip(&part.weights);
                let pairs = sets.flat_map(|(j, w)| j[vertex].into_iter().zip(w[vertex]));
                pairs
                    .filter(|(_, weight)| *weight > 0.0)
                    .filter_map(|(joint, weight)| {
                        Some(apart(matrices.get(usize::from(joint))?) * f64::from(weight))
                    })
                    .sum()
            }
        };
        let off = off.length();
        if off.is_finite() {
            farthest = farthest.max(off);
        }
    }
    farthest
}

/// Matrices to the world of all nodes at rest.
fn worlds(model: &Model, order: &[usize], of: impl Fn(&Trs) -> Trs) -> Vec<DAffine3> {
    let mut out = vec![DAffine3::IDENTITY; model.nodes.len()];
    for &number in order {
        let node = &model.nodes[number];
        let Trs {
            translation,
            rotation,
            scale,
        } = of(&node.rest);
        let own = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
        out[number] = match node.parent {
            Some(parent) => out[parent] * own,
            None => own,
        };
    }
    out
}

/// A transform as a reader of the file sees it.
fn written(rest: &Trs) -> Trs {
    Trs {
        translation: rest.translation.as_vec3().as_dvec3(),
        rotation: DQuat::from_array(
            rest.rotation
                .normalize()
                .as_quat()
                .to_array()
                .map(f64::from),
        )
        .normalize(),
        scale: rest.scale.as_vec3().as_dvec3(),
    }
}
