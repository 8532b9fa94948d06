//! Properties that users gave to objects, as glTF's `extras`.

use super::text::escaped;
use crate::model::{Extras, Model, Properties};
use crate::report::Report;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use ufbx::{ElementType, Prop, PropFlags, PropType, Scene};

/// Those of nodes, meshes, materials, lights and cameras of `scene`, as `model` has them before nodes are
/// taken out.
pub(crate) fn read_extras(scene: &Scene, model: &Model, report: &mut Report) -> Extras {
    let mut extras = Extras::default();
    let mut carried: BTreeSet<u32> = BTreeSet::new();
    let mut put = |map: &mut BTreeMap<usize, Properties>, number, element: &ufbx::Element| {
        carried.insert(element.element_id);
        let own = properties(element);
        if !own.is_empty() {
            map.entry(number).or_default().extend(own);
        }
    };
    let meshes: BTreeSet<u32> = model.meshes.iter().map(|mesh| mesh.source).collect();
    for (number, (node, source)) in model.nodes.iter().zip(&scene.nodes).enumerate() {
        // What hangs at a bone or at nothing that glTF has is the node itself there, and so is what comes to
        // nothing: a mesh without triangles, a light of a kind that glTF has not.
        for attribute in &source.all_attribs {
            let own = match attribute.type_ {
                ElementType::Mesh => !meshes.contains(&attribute.typed_id),
                ElementType::Light => node.light.is_none(),
                ElementType::Camera => node.camera.is_none(),
                _ => source.mesh.is_none(),
            };
            if own {
                put(&mut extras.nodes, number, attribute);
            }
        }
        put(&mut extras.nodes, number, &source.element);
        if let (Some(light), Some(of)) = (node.light, &source.light) {
            put(&mut extras.lights, light, &of.element);
        }
        if let (Some(camera), Some(of)) = (node.camera, &source.camera) {
            put(&mut extras.cameras, camera, &of.element);
        }
    }
    for (number, mesh) in model.meshes.iter().enumerate() {
        if let Some(source) = scene.meshes.get(mesh.source as usize) {
            put(&mut extras.meshes, number, &source.element);
        }
    }
    for (number, material) in (&scene.materials).into_iter().enumerate() {
        if number < model.materials.len() {
            put(&mut extras.materials, number, &material.element);
        }
    }
    report_others(scene, &carried, report);
    extras
}

/// Objects that glTF has no place for, or none with extras that loaders read.
fn report_others(scene: &Scene, carried: &BTreeSet<u32>, report: &mut Report) {
    let mut count = 0;
    let mut example = String::new();
    for element in &scene.elements {
        let own = match carried.contains(&element.element_id) {
            true => 0,
            false => properties(element).len(),
        };
        if own > 0 && count == 0 {
            example = element.name.to_string();
        }
        count += own;
    }
    if count > 0 {
        let detail = format!(
            "properties that a user gave to objects without extras in glTF, {example:?} for one"
        );
        report.lose("user-property", &count.to_string(), detail);
    }
}

/// Properties that a user gave to an object.
pub(super) fn own_properties(element: &ufbx::Element) -> impl Iterator<Item = &Prop> {
    let user = |prop: &&Prop| prop.flags.has_any(PropFlags::USER_DEFINED);
    element.props.props.iter().filter(user)
}

fn properties(element: &ufbx::Element) -> Properties {
    let own = own_properties(element);
    own.filter_map(|prop| Some((prop.name.to_string(), value(prop)?)))
        .collect()
}

/// `None` for what only groups others.
fn value(prop: &Prop) -> Option<Value> {
    let v = &prop.value_vec4;
    // What is no number is none in JSON either.
    let list = |numbers: &[f64]| Value::from(numbers.to_vec());
    Some(match prop.type_ {
        PropType::Compound => return None,
        PropType::Boolean => Value::from(prop.value_int != 0),
        PropType::Integer => Value::from(prop.value_int),
        PropType::Number | PropType::Distance => Value::from(v.x),
        PropType::ColorWithAlpha => list(&[v.x, v.y, v.z, v.w]),
        PropType::Vector
        | PropType::Color
        | PropType::Translation
        | PropType::Rotation
        | PropType::Scaling => list(&[v.x, v.y, v.z]),
        PropType::String | PropType::DateTime | PropType::Reference => text(prop),
        PropType::Unknown | PropType::Blob => {
            let has = |flag| prop.flags.has_any(flag);
            if has(PropFlags::VALUE_VEC4) {
                list(&[v.x, v.y, v.z, v.w])
            } else if has(PropFlags::VALUE_VEC3) {
                list(&[v.x, v.y, v.z])
            } else if has(PropFlags::VALUE_VEC2) {
                list(&[v.x, v.y])
            } else if has(PropFlags::VALUE_STR) && !prop.value_str.is_empty() {
                text(prop)
            } else if has(PropFlags::VALUE_REAL) && v.x != prop.value_int as f64 {
                Value::from(v.x)
            } else if has(PropFlags::VALUE_INT) {
                Value::from(prop.value_int)
            } else {
                text(prop)
            }
        }
    })
}

fn text(prop: &Prop) -> Value {
    match prop.value_blob.is_empty() {
        true => Value::from(prop.value_str.to_string()),
        false => Value::from(escaped(&prop.value_blob)),
    }
}
