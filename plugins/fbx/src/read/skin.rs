//! Skins: joints, bind matrices, and who follows whom.

use super::convert::matrix;
use crate::model::{Node, Skin, Trs};
use glam::DMat4;
use ufbx::{Mesh, SkinCluster, SkinDeformer, SkinningMethod};

/// A joint of a skin and how much a vertex follows it; a vertex's weights sum to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Influence {
    pub(crate) joint: usize,
    pub(crate) weight: f64,
}

/// A skin with all influences of the file.
pub(crate) struct SkinSource {
    pub(crate) skin: Skin,
    /// For each vertex of the FBX mesh, largest weight first.
    pub(crate) influences: Vec<Vec<Influence>>,
    /// The skin bends by dual quaternions somewhere.
    pub(crate) dual: bool,
}

/// Reads the first skin of `mesh` as `node` shows it. Vertices that follow no joint follow the node.
/// Joints that glTF cannot name twice get helper nodes.
pub(crate) fn read_skin(
    mesh: &Mesh,
    deformer: &SkinDeformer,
    node: &ufbx::Node,
    nodes: &mut Vec<Node>,
) -> SkinSource {
    let mut skin = Skin {
        name: deformer.element.name.to_string(),
        ..Skin::default()
    };
    let mut joint_of_cluster = Vec::new();
    for cluster in &deformer.clusters {
        let Some(bone) = cluster.bone_node.as_ref() else {
            joint_of_cluster.push(None);
            continue;
        };
        let bind = sound(bind(cluster, node, nodes));
        joint_of_cluster.push(Some(joint(
            &mut skin,
            nodes,
            bone.element.typed_id as usize,
            bind,
        )));
    }
    let mut influences = Vec::with_capacity(mesh.num_vertices);
    for vertex in 0..mesh.num_vertices {
        influences.push(influences_of(deformer, vertex, &joint_of_cluster));
    }
    if influences.iter().any(Vec::is_empty) {
        let bind = sound(matrix(&node.geometry_to_node));
        let still = joint(&mut skin, nodes, node.element.typed_id as usize, bind);
        for list in influences.iter_mut().filter(|list| list.is_empty()) {
            list.push(Influence {
                joint: still,
                weight: 1.0,
            });
        }
    }
    let dual = match deformer.skinning_method {
        SkinningMethod::DualQuaternion => true,
        SkinningMethod::BlendedDqLinear => deformer.vertices.iter().any(|v| v.dq_weight > 0.0),
        SkinningMethod::Linear | SkinningMethod::Rigid => false,
    };
    SkinSource {
        skin,
        influences,
        dual,
    }
}

/// From the mesh to a joint. Where the file says none, it is what the joint's matrix and the mesh's node come to at rest, and
/// ufbx may have the node elsewhere ([`rest_of`](super::rest_of)).
fn bind(cluster: &SkinCluster, node: &ufbx::Node, nodes: &[Node]) -> DMat4 {
    let given = matrix(&cluster.geometry_to_bone);
    let (shown, geometry) = match node.parent.as_ref() {
        Some(parent) if node.is_geometry_transform_helper => {
            (parent.as_ref(), matrix(&node.node_to_parent))
        }
        _ => (node, matrix(&node.geometry_to_node)),
    };
    let to_bone = ufbx::matrix_invert(&cluster.bind_to_world);
    let by_ufbx = ufbx::matrix_mul(&to_bone, &shown.node_to_world);
    if matrix(&by_ufbx) != matrix(&cluster.mesh_node_to_bone) {
        return given;
    }
    let world = world(nodes, shown.element.typed_id as usize);
    let same = (world - matrix(&shown.node_to_world)).abs_diff_eq(DMat4::ZERO, 1e-12);
    match same {
        true => given,
        false => matrix(&to_bone) * world * geometry,
    }
}

/// Where a node is at rest.
fn world(nodes: &[Node], node: usize) -> DMat4 {
    let mut world = DMat4::IDENTITY;
    let mut above = Some(node);
    while let Some(node) = above.and_then(|number| nodes.get(number)) {
        world = node.rest.matrix() * world;
        above = node.parent;
    }
    world
}

fn sound(bind: DMat4) -> DMat4 {
    match bind.is_finite() {
        true => bind,
        false => DMat4::IDENTITY,
    }
}

/// Number of the joint for `node` bound by `bind`, made if it is not there.
fn joint(skin: &mut Skin, nodes: &mut Vec<Node>, node: usize, bind: DMat4) -> usize {
    let same_node = skin.joints.iter().position(|&other| other == node);
    let same = (0..skin.joints.len()).find(|&i| {
        let at = skin.joints[i];
        (at == node || helps(&nodes[at], node)) && skin.inverse_bind[i] == bind
    });
    if let Some(number) = same {
        return number;
    }
    let node = match same_node {
        None => node,
        Some(_) => {
            nodes.push(Node {
                name: format!("{}.bind", nodes[node].name),
                parent: Some(node),
                rest: Trs::IDENTITY,
                mesh: None,
                skin: None,
                light: None,
                camera: None,
            });
            nodes.len() - 1
        }
    };
    skin.joints.push(node);
    skin.inverse_bind.push(bind);
    skin.joints.len() - 1
}

fn helps(helper: &Node, node: usize) -> bool {
    helper.parent == Some(node) && helper.name.ends_with(".bind") && helper.rest == Trs::IDENTITY
}

fn influences_of(
    deformer: &SkinDeformer,
    vertex: usize,
    joint_of_cluster: &[Option<usize>],
) -> Vec<Influence> {
    let Some(entry) = deformer.vertices.get(vertex) else {
        return Vec::new();
    };
    let begin = (entry.weight_begin as usize).min(deformer.weights.len());
    let end = (begin + entry.num_weights as usize).min(deformer.weights.len());
    let mut list: Vec<Influence> = Vec::with_capacity(end - begin);
    for weight in &deformer.weights.as_ref()[begin..end] {
        let joint = joint_of_cluster
            .get(weight.cluster_index as usize)
            .copied()
            .flatten();
        let Some(joint) = joint.filter(|_| weight.weight > 0.0 && weight.weight.is_finite()) else {
            continue;
        };
        match list.iter_mut().find(|known| known.joint == joint) {
            Some(known) => known.weight += weight.weight,
            None => list.push(Influence {
                joint,
                weight: weight.weight,
            }),
        }
    }
    let sum: f64 = list.iter().map(|influence| influence.weight).sum();
    if !(sum > 1e-12 && sum.is_finite()) {
        return Vec::new();
    }
    for influence in &mut list {
        influence.weight /= sum;
    }
    list.sort_by(|a, b| b.weight.total_cmp(&a.weight).then(a.joint.cmp(&b.joint)));
    list
}
