//! How far vertices are from where they belong.

use crate::model::{Mesh, Model, Part, Skin};
use glam::{DAffine3, DMat3, DVec3, Vec3};

/// The largest distance of a vertex between two places of the nodes, metres, for meshes on nodes that move.
pub(super) fn vertex_distance(
    model: &Model,
    a: &[DAffine3],
    b: &[DAffine3],
    moving: &[bool],
) -> f64 {
    let mut farthest = 0.0_f64;
    for (number, node) in model.nodes.iter().enumerate() {
        let Some(mesh) = node.mesh.map(|mesh| &model.meshes[mesh]) else {
            continue;
        };
        match node.skin.map(|skin| &model.skins[skin]) {
            None if moving[number] => {
                farthest = farthest.max(rigid(mesh, &difference(&a[number], &b[number])));
            }
            None => {}
            Some(skin) => farthest = farthest.max(skinned(mesh, skin, a, b)),
        }
    }
    farthest
}

/// What is added to a point by going from one place to the other.
fn difference(a: &DAffine3, b: &DAffine3) -> DAffine3 {
    DAffine3 {
        matrix3: DMat3::from_cols(
            b.matrix3.x_axis - a.matrix3.x_axis,
            b.matrix3.y_axis - a.matrix3.y_axis,
            b.matrix3.z_axis - a.matrix3.z_axis,
        ),
        translation: b.translation - a.translation,
    }
}

fn rigid(mesh: &Mesh, difference: &DAffine3) -> f64 {
    let parts = mesh.parts.iter().flat_map(|part| &part.positions);
    parts
        .map(|p| {
            difference
                .transform_point3(Vec3::from(*p).as_dvec3())
                .length_squared()
        })
        .fold(0.0, f64::max)
        .sqrt()
}

fn skinned(mesh: &Mesh, skin: &Skin, a: &[DAffine3], b: &[DAffine3]) -> f64 {
    let joints = skin.joints.iter().zip(&skin.inverse_bind);
    let differences: Vec<DAffine3> = joints
        .map(|(&joint, bind)| difference(&a[joint], &b[joint]) * DAffine3::from_mat4(*bind))
        .collect();
    let far = |(vertex, p): (usize, &[f32; 3]), part: &Part| {
        let p = Vec3::from(*p).as_dvec3();
        let mut sum = DVec3::ZERO;
        for (joints, weights) in part.joints.iter().zip(&part.weights) {
            for (&joint, &weight) in joints[vertex].iter().zip(&weights[vertex]) {
                if weight > 0.0 {
                    sum += differences[usize::from(joint)].transform_point3(p) * f64::from(weight);
                }
            }
        }
        sum.length_squared()
    };
    mesh.parts
        .iter()
        .flat_map(|part| part.positions.iter().enumerate().map(move |v| far(v, part)))
        .fold(0.0, f64::max)
        .sqrt()
}
