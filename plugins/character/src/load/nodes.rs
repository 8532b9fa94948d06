//! Nodes become joints.

use super::{LoadError, Skin, accessor};
use crate::pose::JointTransform;
use crate::skeleton::{Joint, Skeleton};
use bevy::math::{Affine3A, Mat4, Quat, Vec3};
use gltf::animation::Property;

/// The skeleton, and which node is which joint.
pub(super) struct Nodes {
    pub skeleton: Skeleton,
    pub joint_of_node: Vec<Option<usize>>,
}

pub(super) fn read(document: &gltf::Document) -> Result<Nodes, LoadError> {
    let parents = parents(document)?;
    let mut wanted = vec![false; parents.len()];
    let joints = document
        .skins()
        .flat_map(|skin| skin.joints().collect::<Vec<_>>());
    let moved = document.animations().flat_map(|animation| {
        animation
            .channels()
            .filter(|channel| channel.target().property() != Property::MorphTargetWeights)
            .map(|channel| channel.target().node())
            .collect::<Vec<_>>()
    });
    for node in joints.chain(moved) {
        let mut at = Some(node.index());
        while let Some(here) = at.filter(|here| !wanted[*here]) {
            wanted[here] = true;
            at = parents[here];
        }
    }
    let nodes: Vec<gltf::Node> = document.nodes().collect();
    let mut joint_of_node = vec![None; nodes.len()];
    let mut list = Vec::new();
    // Parents first, and a branch at a time: joints that hang together lie together.
    let mut open: Vec<usize> = (0..nodes.len())
        .filter(|node| parents[*node].is_none())
        .rev()
        .collect();
    while let Some(index) = open.pop() {
        if !wanted[index] {
            continue;
        }
        let node = &nodes[index];
        joint_of_node[index] = Some(list.len());
        list.push(Joint {
            name: node
                .name()
                .map_or_else(|| format!("node {index}"), str::to_owned),
            parent: parents[index].and_then(|parent| joint_of_node[parent]),
            rest: rest(node),
        });
        let first = open.len();
        open.extend(node.children().map(|child| child.index()));
        open[first..].reverse();
    }
    if list.is_empty() {
        return Err(LoadError::NothingToMove);
    }
    // What hangs from itself has no root, and was not reached.
    if let Some(lost) =
        (0..nodes.len()).find(|node| wanted[*node] && joint_of_node[*node].is_none())
    {
        return Err(LoadError::NotATree(lost));
    }
    Ok(Nodes {
        skeleton: Skeleton::new(list)?,
        joint_of_node,
    })
}

fn parents(document: &gltf::Document) -> Result<Vec<Option<usize>>, LoadError> {
    let mut parents = vec![None; document.nodes().len()];
    for node in document.nodes() {
        for child in node.children() {
            if parents[child.index()].replace(node.index()).is_some()
                || child.index() == node.index()
            {
                return Err(LoadError::NotATree(child.index()));
            }
        }
    }
    Ok(parents)
}

fn rest(node: &gltf::Node) -> JointTransform {
    let (translation, rotation, scale) = node.transform().decomposed();
    JointTransform {
        translation: Vec3::from_array(translation),
        rotation: Quat::from_array(rotation),
        scale: Vec3::from_array(scale),
    }
}

pub(super) fn skin(
    skin: &gltf::Skin,
    joint_of_node: &[Option<usize>],
    buffers: &[Vec<u8>],
) -> Result<Skin, LoadError> {
    let refuse = |reason: String| LoadError::Skin {
        skin: skin.index(),
        reason,
    };
    let joints: Vec<usize> = skin
        .joints()
        .map(|node| {
            joint_of_node[node.index()].ok_or_else(|| refuse("a joint hangs from itself".into()))
        })
        .collect::<Result<_, _>>()?;
    let inverse_binds = match skin.inverse_bind_matrices() {
        None => vec![Affine3A::IDENTITY; joints.len()],
        Some(matrices) => accessor::floats::<16>(&matrices, buffers, "inverse bind matrices")?
            .iter()
            .map(|columns| Affine3A::from_mat4(Mat4::from_cols_array(columns)))
            .collect(),
    };
    if inverse_binds.len() < joints.len() {
        let reason = format!(
            "{} inverse bind matrices for {} joints",
            inverse_binds.len(),
            joints.len()
        );
        return Err(refuse(reason));
    }
    if !inverse_binds.iter().all(|matrix| matrix.is_finite()) {
        return Err(refuse("an inverse bind matrix is not finite".into()));
    }
    Ok(Skin {
        name: skin.name().unwrap_or_default().to_owned(),
        inverse_binds: inverse_binds[..joints.len()].to_vec(),
        joints,
    })
}
