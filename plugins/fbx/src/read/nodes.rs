//! The tree of nodes.

use super::convert::trs;
use super::names::Names;
use crate::curves::{NodeCurves, aside};
use crate::model::{Node, Trs};
use ufbx::Scene;

/// Where a node is at rest; identity where the file says something that is no transform.
pub(crate) fn rest_of(node: &ufbx::Node) -> Trs {
    let own_way = |node: &ufbx::Node| node.scale_helper.is_some() || aside(node).is_some();
    let beside = node.is_scale_helper
        || own_way(node)
        || node.parent.as_ref().is_some_and(|parent| own_way(parent));
    let rest = match beside {
        true => NodeCurves::rest(node),
        false => trs(&node.local_transform),
    };
    match rest.is_sound() {
        true => rest,
        false => Trs::IDENTITY,
    }
}

/// One node for each of the scene's, under the same number: number 0 is the root, which no file shows.
/// Meshes, lights and cameras are hung in later.
pub(crate) fn read_nodes(scene: &Scene, names: &Names) -> Vec<Node> {
    (&scene.nodes)
        .into_iter()
        .map(|node| Node {
            name: name_of(node, names),
            parent: node
                .parent
                .as_ref()
                .map(|parent| parent.element.typed_id as usize),
            rest: rest_of(node),
            mesh: None,
            skin: None,
            light: None,
            camera: None,
        })
        .collect()
}

/// A helper is named after the node that it helps, so that names stay apart.
fn name_of(node: &ufbx::Node, names: &Names) -> String {
    let own = names.name(&node.element);
    if !node.is_geometry_transform_helper && !node.is_scale_helper {
        return own;
    }
    match &node.parent {
        Some(parent) => format!("{}.{own}", name_of(parent, names)),
        None => own,
    }
}
