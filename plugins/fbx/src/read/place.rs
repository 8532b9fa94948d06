//! Meshes far from their origin, as maps and plans have them: f32 holds seven digits, so that a house
//! at five million metres would stand on a grid of half a metre.

use super::convert::vec3;
use crate::model::{Node, Trs};
use glam::DVec3;

/// A mesh stays where it is while f32 rounds its vertices by no more than this share of the error
/// that keys are allowed, ...
const OF_ERROR: f64 = 1.0 / 8.0;
/// ... and no more than this share of its own size.
const OF_SIZE: f64 = 1e-5;
/// Half a unit in the last place of f32, over the number.
const HALF_PLACE: f64 = 1.0 / (1 << 24) as f64;
/// ufbx's number of no corner.
const NO_INDEX: u32 = u32::MAX;

/// What is to be taken off all positions of `mesh`; zero where f32 holds them well, or would hold them no
/// better elsewhere. `max_error` is what keys are held to, metres.
pub(super) fn offset_of(mesh: &ufbx::Mesh, max_error: f64) -> DVec3 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    // Vertices of no face do not count.
    for (vertex, &first) in mesh.vertices.iter().zip(&mesh.vertex_first_index) {
        let vertex = vec3(*vertex);
        if first != NO_INDEX && vertex.is_finite() {
            (low, high) = (low.min(vertex), high.max(vertex));
        }
    }
    offset(low, high, max_error)
}

fn offset(low: DVec3, high: DVec3, max_error: f64) -> DVec3 {
    let size = (high - low).length();
    let far = low.abs().max(high.abs()).max_element();
    let rounding = far * HALF_PLACE;
    if !(size.is_finite() && far.is_finite() && far < f64::from(f32::MAX)) {
        return DVec3::ZERO;
    }
    // A point alone has no size to be spoilt.
    let coarse = rounding > OF_ERROR * max_error || (size > 0.0 && rounding > OF_SIZE * size);
    // A numbers that f32 holds: the node that puts it back rounds nothing.
    let centre = low.midpoint(high).as_vec3().as_dvec3();
    let left = (low - centre)
        .abs()
        .max((high - centre).abs())
        .max_element();
    match coarse && left < far / 2.0 {
        true => centre,
        false => DVec3::ZERO,
    }
}

/// Whether a node is there for its mesh alone: nothing hangs below it, follows it or moves it.
pub(crate) fn is_alone(scene: &ufbx::Scene, node: &ufbx::Node) -> bool {
    let id = node.element.element_id;
    let keyed = || {
        let props = (&scene.anim_layers)
            .into_iter()
            .flat_map(|layer| layer.anim_props.iter());
        props.into_iter().any(|prop| prop.element.element_id == id)
    };
    let joint = || {
        let bones = (&scene.skin_clusters)
            .into_iter()
            .filter_map(|cluster| cluster.bone_node.as_ref());
        bones.into_iter().any(|bone| bone.element.element_id == id)
    };
    let others = node.children.is_empty() && node.all_attribs.len() <= 1;
    others && !joint() && !keyed()
}

/// Hangs a mesh with an offset below `node`, so that what else hangs there stays: a helper is named after
/// it. A node that is there for the mesh alone, `alone`, and far out itself takes the offset where the two
/// cancel, and it then rounds to f32 no worse.
pub(crate) fn show_at(nodes: &mut Vec<Node>, node: usize, alone: bool, mesh: usize, offset: DVec3) {
    if offset == DVec3::ZERO {
        nodes[node].mesh = Some(mesh);
        return;
    }
    let rest = nodes[node].rest;
    let folded = rest.matrix().transform_point3(offset);
    let nearer = folded.length() < rest.translation.length();
    if alone && nearer && rounding(folded) <= rounding(rest.translation) {
        nodes[node].rest.translation = folded;
        nodes[node].mesh = Some(mesh);
        return;
    }
    nodes.push(Node {
        name: format!("{}.{}", nodes[node].name, crate::load::GEOMETRY_HELPER),
        parent: Some(node),
        rest: Trs {
            translation: offset,
            ..Trs::IDENTITY
        },
        mesh: Some(mesh),
        skin: None,
        light: None,
        camera: None,
    });
}

fn rounding(v: DVec3) -> f64 {
    (v.as_vec3().as_dvec3() - v).length()
}
