//! Which nodes are hidden. FBX hides a node by its own `Visibility` or `Show`, by a display layer that is
//! off, or with its parent; glTF has an extension that hides a node and all below it.
//!
//! Keys of a clip that plays may show what is hidden at rest. glTF cannot play them, and what would be hidden
//! for good is worse than what is shown too long: such a property counts as shown, for the node and for all
//! that follows it, and a line says for how long that is not so.

use crate::clips::order;
use crate::curves::playing;
use crate::model::Model;
use crate::report::Report;
use std::collections::BTreeSet;
use ufbx::{ElementType, Scene};

/// The property that says it, 0 for hidden.
pub(super) const VISIBILITY: &str = "Visibility";
/// The other one.
pub(super) const SHOW: &str = "Show";
const INHERITANCE: &str = "Visibility Inheritance";

/// Hidden nodes of a scene.
pub(crate) struct Hidden {
    /// For each node, whether it is hidden at rest and at any other time.
    nodes: Vec<bool>,
}

impl Hidden {
    pub(crate) fn of(scene: &Scene) -> Self {
        let shown = shown_by_keys(scene);
        let mut off = BTreeSet::new();
        for layer in &scene.display_layers {
            if !layer.visible {
                off.extend((&layer.nodes).into_iter().map(|n| n.element.typed_id));
            }
        }
        let parents: Vec<Option<usize>> = (&scene.nodes)
            .into_iter()
            .map(|node| node.parent.as_ref().map(|p| p.element.typed_id as usize))
            .collect();
        let mut nodes = vec![false; parents.len()];
        for number in order(&parents) {
            let node: &ufbx::Node = &scene.nodes[number];
            let says = |name: &'static str| {
                let prop = ufbx::find_prop(&node.element.props, name);
                prop.is_none_or(|prop| prop.value_vec4.x != 0.0 || prop.value_int != 0)
                    || shown.contains(&(number, name))
            };
            let own = says(VISIBILITY) && says(SHOW) && !off.contains(&node.element.typed_id);
            let above = parents[number].is_some_and(|parent| nodes[parent]);
            // A helper is part of the node that it helps.
            let helper = node.is_geometry_transform_helper || node.is_scale_helper;
            nodes[number] = !own || above && (helper || says(INHERITANCE));
        }
        Self { nodes }
    }

    /// Whether node number `node` of the scene is hidden.
    pub(crate) fn node(&self, node: usize) -> bool {
        self.nodes.get(node).copied().unwrap_or(false)
    }

    /// Marks nodes of `model` that are hidden with all below them, the topmost only, and says what is
    /// hidden. Nodes beside the tree, of skins, are in `model.hidden` already.
    pub(crate) fn mark(&self, scene: &Scene, model: &mut Model, report: &mut Report) {
        let parents: Vec<Option<usize>> = model.nodes.iter().map(|node| node.parent).collect();
        let order = order(&parents);
        let mut hidden = vec![false; parents.len()];
        for &node in &order {
            hidden[node] = match node < self.nodes.len() {
                true => self.nodes[node],
                false => parents[node].is_some_and(|parent| hidden[parent]),
            } || model.hidden.contains(&node);
        }
        let mut whole = hidden;
        for &node in order.iter().rev() {
            if let Some(parent) = parents[node] {
                whole[parent] &= whole[node];
            }
        }
        for &node in &order {
            match parents[node].is_some_and(|parent| whole[parent]) {
                true => model.hidden.remove(&node),
                false => whole[node] && model.hidden.insert(node),
            };
        }
        for (number, node) in (&scene.nodes).into_iter().enumerate() {
            let shows = node.mesh.is_some() || node.light.is_some();
            if !self.node(number) || !shows {
                continue;
            }
            let made = &model.nodes[number];
            let seen = !whole[number] && (made.mesh.is_some() || made.light.is_some());
            let detail = match seen {
                true => {
                    "is hidden in the file and something below it is not, which glTF cannot say; it is shown"
                }
                false => {
                    "is hidden in the file; loaders without KHR_node_visibility, Bevy's too, show it"
                }
            };
            report.lose("hidden", &made.name, detail);
        }
    }
}

/// Nodes that keys show at some time, by the property that is keyed.
fn shown_by_keys(scene: &Scene) -> BTreeSet<(usize, &'static str)> {
    let mut shown = BTreeSet::new();
    for (_, layer) in (&scene.anim_stacks).into_iter().flat_map(playing) {
        for prop in layer.anim_props.iter() {
            let mut known = [VISIBILITY, SHOW].into_iter();
            let name = known.find(|name| **name == *prop.prop_name);
            let (ElementType::Node, Some(name)) = (prop.element.type_, name) else {
                continue;
            };
            let mut curves = prop.anim_value.curves.iter().flatten();
            if curves.any(|curve| curve.keyframes.iter().any(|key| key.value > 0.0)) {
                shown.insert((prop.element.typed_id as usize, name));
            }
        }
    }
    shown
}
