//! What is keyed in a file and no channel of core glTF moves: visibility, and properties of lights,
//! cameras, materials, textures and of the user. (KHR_animation_pointer could carry some; loaders that
//! do not know it, Bevy's among them, refuse a file that has it.)

use super::names::Names;
use super::visibility::{Hidden, SHOW, VISIBILITY};
use crate::clips::{BLENDS, MOVES};
use crate::curves::{Layers, Meaning, Reading, Value, playing};
use crate::report::Report;
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use ufbx::{AnimCurve, AnimProp, Element, ElementType, Interpolation, Scene};

/// More than so many lines of a kind are put into one.
const LINES: usize = 64;

/// One line for each property of each object whose keys change it in a clip that plays them. What is hidden
/// whatever keys say has its line already.
pub(crate) fn report_keyed(scene: &Scene, names: &Names, hidden: &Hidden, report: &mut Report) {
    // By object and property: keys, in all layers.
    let mut found: BTreeMap<(u32, &str), usize> = BTreeMap::new();
    let mut seen = BTreeSet::new();
    for (_, layer) in (&scene.anim_stacks).into_iter().flat_map(playing) {
        if !seen.insert(layer.element.element_id) {
            continue;
        }
        for prop in layer.anim_props.iter() {
            let name: &str = &prop.prop_name;
            let element: &Element = &prop.element;
            if !is_carried(element.type_, name) && !is_shape(scene, element, name) && changes(prop)
            {
                let curves = prop.anim_value.curves.iter().flatten();
                let keys = curves.map(|c| c.keyframes.len()).max().unwrap_or(0);
                *found.entry((prop.element.element_id, name)).or_default() += keys;
            }
        }
    }
    let mut counts = [0; 2];
    for ((element, property), keys) in found {
        let Some(element) = scene.elements.get(element as usize) else {
            continue;
        };
        let shows = element.type_ == ElementType::Node && [VISIBILITY, SHOW].contains(&property);
        if shows && hidden.node(element.typed_id as usize) {
            continue;
        }
        counts[usize::from(shows)] += 1;
        if counts[usize::from(shows)] > LINES {
            continue;
        }
        let object = match names.name(element) {
            // Attributes have the names of their nodes, or none.
            name if name.is_empty() => (&element.instances)
                .into_iter()
                .next()
                .map_or(name, |node| names.name(&node.element)),
            name => name,
        };
        match shows {
            true => {
                let (hidden, all) = hidden_for(scene, element, property);
                report.lose(
                    "keyed-visibility",
                    &object,
                    format!(
                        "is shown and hidden by {keys} keys, which glTF cannot play; it is shown for {hidden:.3} s of {all:.3} s in which it should not be"
                    ),
                );
            }
            false => report.lose(
                "keyed-property",
                &format!("{object}.{property}"),
                format!(
                    "{} is keyed ({keys} keys), which glTF cannot play; it has its value at rest",
                    kind(element.type_)
                ),
            ),
        }
    }
    for (what, count) in ["keyed-property", "keyed-visibility"]
        .into_iter()
        .zip(counts)
    {
        if count > LINES {
            let detail = "further ones like those above";
            report.lose(what, &(count - LINES).to_string(), detail);
        }
    }
}

/// For how long an object is hidden by the keys of a property, and for how long the clips play that have these, seconds.
fn hidden_for(scene: &Scene, element: &Element, property: &str) -> (f64, f64) {
    let (mut hidden, mut all) = (0.0, 0.0);
    for stack in &scene.anim_stacks {
        let (begin, end) = (stack.time_begin, stack.time_end);
        let layers = Layers::of(scene, stack, Reading::Usual);
        let mut value = Value::of(&layers, element, property, DVec3::ONE);
        if !value.moves() || end.partial_cmp(&begin) != Some(Ordering::Greater) {
            continue;
        }
        let playing = layers.playing.iter();
        let own = playing.filter_map(|layer| ufbx::find_anim_prop(layer.source, element, property));
        let curves = own.flat_map(|prop| prop.anim_value.curves.iter().flatten());
        let mut times: Vec<f64> = curves
            .flat_map(|curve| curve.keyframes.iter().map(|key| key.time))
            .filter(|time| *time > begin && *time < end)
            .chain([begin, end])
            .collect();
        times.sort_by(f64::total_cmp);
        // Programs write steps, so that the middle says what is so between two keys.
        for pair in times.windows(2) {
            let middle = f64::midpoint(pair[0], pair[1]);
            if value.at(middle, Meaning::Plain).x <= 0.0 {
                hidden += pair[1] - pair[0];
            }
        }
        all += end - begin;
    }
    (hidden, all)
}

fn is_carried(element: ElementType, property: &str) -> bool {
    match element {
        ElementType::Node => MOVES.contains(&property),
        ElementType::BlendChannel => property == BLENDS,
        // Weights of layers are in what the layers do; whether they play is as it is at rest.
        ElementType::AnimLayer => property == "Weight",
        ElementType::AnimStack => true,
        _ => false,
    }
}

/// Blender keys the weight of a shape at its mesh too, under the name of the shape's channel.
fn is_shape(scene: &Scene, element: &Element, property: &str) -> bool {
    if element.type_ != ElementType::Mesh {
        return false;
    }
    let Some(mesh) = scene.meshes.get(element.typed_id as usize) else {
        return false;
    };
    let keyed = |channel: u32| {
        let mut layers = (&scene.anim_layers).into_iter();
        layers.any(|layer| {
            let mut props = layer.anim_props.iter();
            props.any(|p| p.element.element_id == channel && *p.prop_name == *BLENDS)
        })
    };
    let mut channels = (&mesh.blend_deformers)
        .into_iter()
        .flat_map(|deformer| &deformer.channels);
    channels.any(|c| *c.element.name == *property && keyed(c.element.element_id))
}

/// Whether any key, or what lies between two, is other than what the property is without.
fn changes(prop: &AnimProp) -> bool {
    let Some(rest) = ufbx::find_prop(&prop.element.props, &prop.prop_name) else {
        return prop.anim_value.curves.iter().flatten().next().is_some();
    };
    let rest = [rest.value_vec4.x, rest.value_vec4.y, rest.value_vec4.z];
    let curves = prop.anim_value.curves.iter().zip(rest);
    curves
        .filter_map(|(curve, rest)| Some((curve.as_ref()?, rest)))
        .any(|(curve, rest)| leaves(curve, rest))
}

fn leaves(curve: &AnimCurve, rest: f64) -> bool {
    let counts = |by: f64| by.abs() > 1e-6 * rest.abs().max(1e-3);
    let keys = &curve.keyframes;
    // Between equal keys a curve bulges as far as its tangents lead away from them.
    let bent = keys.windows(2).any(|two| {
        let by = [two[0].right.dy, two[1].left.dy];
        two[0].interpolation == Interpolation::Cubic && by.iter().any(|&dy| counts(f64::from(dy)))
    });
    bent || keys.iter().any(|key| counts(key.value - rest))
}

fn kind(element: ElementType) -> &'static str {
    match element {
        ElementType::Node => "a property of a node",
        ElementType::Light => "a property of a light",
        ElementType::Camera => "a property of a camera",
        ElementType::Material => "a property of a material",
        ElementType::Texture => "how a texture is laid on",
        ElementType::Constraint | ElementType::Character => "a property of a constraint",
        _ => "a property",
    }
}
