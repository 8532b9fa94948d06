//! Meshes in fewer bits, for vertices whose bytes are compressed.
//!
//! Triangles are put into the order that they are drawn fastest in, and vertices into the order that triangles
//! take them, so that neighbours lie together. Positions become multiples of a power of two of a metre that is a
//! small part of the bound; normals and tangents of 2^-10 a component (0.06 degrees), texture coordinates of
//! 2^-16. Joints, weights, colours and morph targets stay as they are.

use crate::codec::{exponent_below, fast_order, power};
use crate::model::{Mesh, Model, Part};
use glam::{DAffine3, DMat3};

/// The share of the bound that rounded positions get.
const SHARE: f64 = 0.05;

/// Steps of normals and tangents, and of texture coordinates, as powers of two.
const NORMALS: i32 = -10;
const UVS: i32 = -16;

/// Rounds all meshes of `model` to within a share of `bound` metres. `stretch` says for each mesh how much longer
/// a way in it may become in the world. Answers how far vertices are moved at most, metres.
pub(crate) fn round_meshes(model: &mut Model, stretch: &[f64], bound: f64) -> f64 {
    let mut farthest = 0.0_f64;
    for (mesh, &stretch) in model.meshes.iter_mut().zip(stretch) {
        // Half a step along each of three axes.
        let step = exponent_below(SHARE * bound / (stretch * 0.75_f64.sqrt())).clamp(-100, 60);
        for part in &mut mesh.parts {
            for position in &mut part.positions {
                let old = glam::Vec3::from(*position).as_dvec3();
                position.iter_mut().for_each(|x| *x = round(*x, step));
                let moved = glam::Vec3::from(*position).as_dvec3().distance(old) * stretch;
                farthest = farthest.max(moved);
            }
            part.normals
                .iter_mut()
                .flatten()
                .for_each(|x| *x = round(*x, NORMALS));
            part.tangents
                .iter_mut()
                .flatten()
                .for_each(|x| *x = round(*x, NORMALS));
            part.uvs
                .iter_mut()
                .flatten()
                .flatten()
                .for_each(|x| *x = round(*x, UVS));
        }
    }
    farthest
}

/// The whole multiple of `2^step` next to `x`; `x` where it has too many digits for that.
fn round(x: f32, step: i32) -> f32 {
    let size = power(step);
    let whole = (f64::from(x) / size).round();
    match whole.abs() < f64::from(1 << 23) {
        true => (whole * size) as f32,
        false => x,
    }
}

/// Reorders triangles and vertices of all meshes.
pub(crate) fn order_meshes(model: &mut Model) {
    let parts = model
        .meshes
        .iter_mut()
        .flat_map(|mesh: &mut Mesh| &mut mesh.parts);
    for part in parts {
        if let Some((indices, old)) = fast_order(&part.indices, part.positions.len()) {
            part.indices = indices;
            reorder(part, &old);
        }
    }
}

/// Vertex `i` becomes what was vertex `old[i]`.
fn reorder(part: &mut Part, old: &[u32]) {
    fn take<T: Copy>(list: &mut Vec<T>, old: &[u32]) {
        if !list.is_empty() {
            *list = old.iter().map(|&i| list[i as usize]).collect();
        }
    }
    take(&mut part.sources, old);
    take(&mut part.positions, old);
    take(&mut part.normals, old);
    take(&mut part.tangents, old);
    part.uvs.iter_mut().for_each(|list| take(list, old));
    part.colours.iter_mut().for_each(|list| take(list, old));
    part.joints.iter_mut().for_each(|list| take(list, old));
    part.weights.iter_mut().for_each(|list| take(list, old));
    for (positions, normals) in &mut part.offsets {
        take(positions, old);
        take(normals, old);
    }
}

/// For each mesh, how much longer a way in it becomes in the world at most, over poses of the tree: `worlds` are
/// those of its nodes. At least 1e-9.
pub(crate) fn stretch<'a>(
    model: &Model,
    worlds: impl Iterator<Item = &'a Vec<DAffine3>>,
) -> Vec<f64> {
    let mut out = vec![1e-9_f64; model.meshes.len()];
    // The largest that a matrix makes of a unit vector is no more than this.
    let most = |m: DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
    for world in worlds {
        for (number, node) in model.nodes.iter().enumerate() {
            let Some(mesh) = node.mesh else { continue };
            let far = match node.skin.map(|skin| &model.skins[skin]) {
                None => most(world[number].matrix3),
                Some(skin) => {
                    let joints = skin.joints.iter().zip(&skin.inverse_bind);
                    let each = joints
                        .map(|(&joint, bind)| most(world[joint].matrix3 * DMat3::from_mat4(*bind)));
                    each.fold(0.0, f64::max)
                }
            };
            if far.is_finite() {
                out[mesh] = out[mesh].max(far);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_keeps_to_its_share_of_the_bound() {
        let mut random = 7_u32;
        let mut next = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(random) / f64::from(u32::MAX) * 4.0 - 2.0
        };
        let positions: Vec<[f32; 3]> = (0..500)
            .map(|_| [next(), next(), next()].map(|x| x as f32))
            .collect();
        let part = Part {
            positions: positions.clone(),
            ..Part::default()
        };
        let mut model = Model {
            meshes: vec![Mesh {
                parts: vec![part],
                ..Mesh::default()
            }],
            ..Model::default()
        };
        let moved = round_meshes(&mut model, &[3.0], 1e-3);
        assert!(moved > 1e-6 && moved <= SHARE * 1e-3, "{moved:e}");
        let pairs = model.meshes[0].parts[0].positions.iter().zip(&positions);
        let farthest = pairs.map(|(a, b)| {
            glam::Vec3::from(*a)
                .as_dvec3()
                .distance(glam::Vec3::from(*b).as_dvec3())
        });
        assert_eq!(farthest.fold(0.0, f64::max) * 3.0, moved);
    }
}
