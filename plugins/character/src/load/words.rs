//! Words of the JSON that are none of glTF's, and numbers of things that are not there. The `gltf` crate's
//! own validation lets some of them pass and stumbles over others, so all that is read here is looked at
//! here.

use super::LoadError;
use gltf::json::Root;
use gltf::json::validation::Checked;

pub(super) fn check(root: &Root) -> Result<(), LoadError> {
    fn valid<T>(word: &Checked<T>, place: impl FnOnce() -> String) -> Result<(), LoadError> {
        match word {
            Checked::Valid(_) => Ok(()),
            Checked::Invalid => Err(LoadError::Word(place())),
        }
    }
    fn there(number: usize, count: usize, place: impl FnOnce() -> String) -> Result<(), LoadError> {
        if number < count {
            Ok(())
        } else {
            Err(LoadError::Word(place()))
        }
    }
    if !root.asset.version.starts_with("2.") {
        return Err(LoadError::Word("asset.version".into()));
    }
    for (index, animation) in root.animations.iter().enumerate() {
        for (channel, of) in animation.channels.iter().enumerate() {
            let place = |what: &str| format!("animations[{index}].channels[{channel}].{what}");
            valid(&of.target.path, || place("target.path"))?;
            there(of.target.node.value(), root.nodes.len(), || {
                place("target.node")
            })?;
            there(of.sampler.value(), animation.samplers.len(), || {
                place("sampler")
            })?;
        }
        for (sampler, of) in animation.samplers.iter().enumerate() {
            let place = |what: &str| format!("animations[{index}].samplers[{sampler}].{what}");
            valid(&of.interpolation, || place("interpolation"))?;
            there(of.input.value(), root.accessors.len(), || place("input"))?;
            there(of.output.value(), root.accessors.len(), || place("output"))?;
        }
    }
    for (index, node) in root.nodes.iter().enumerate() {
        let place = |what: &str| format!("nodes[{index}].{what}");
        for child in node.children.iter().flatten() {
            there(child.value(), root.nodes.len(), || place("children"))?;
        }
        if let Some(mesh) = &node.mesh {
            there(mesh.value(), root.meshes.len(), || place("mesh"))?;
        }
        if let Some(skin) = &node.skin {
            there(skin.value(), root.skins.len(), || place("skin"))?;
        }
    }
    for (index, skin) in root.skins.iter().enumerate() {
        let place = |what: &str| format!("skins[{index}].{what}");
        for joint in &skin.joints {
            there(joint.value(), root.nodes.len(), || place("joints"))?;
        }
        if let Some(binds) = &skin.inverse_bind_matrices {
            there(binds.value(), root.accessors.len(), || {
                place("inverseBindMatrices")
            })?;
        }
    }
    for (index, view) in root.buffer_views.iter().enumerate() {
        let place = || format!("bufferViews[{index}].buffer");
        there(view.buffer.value(), root.buffers.len(), place)?;
    }
    for (index, accessor) in root.accessors.iter().enumerate() {
        if let Some(view) = &accessor.buffer_view {
            let place = || format!("accessors[{index}].bufferView");
            there(view.value(), root.buffer_views.len(), place)?;
        }
        valid(&accessor.component_type, || {
            format!("accessors[{index}].componentType")
        })?;
        valid(&accessor.type_, || format!("accessors[{index}].type"))?;
    }
    for (index, mesh) in root.meshes.iter().enumerate() {
        for (primitive, of) in mesh.primitives.iter().enumerate() {
            valid(&of.mode, || {
                format!("meshes[{index}].primitives[{primitive}].mode")
            })?;
            let place = |what: &str| format!("meshes[{index}].primitives[{primitive}].{what}");
            for (semantic, accessor) in &of.attributes {
                valid(semantic, || place("attributes"))?;
                there(accessor.value(), root.accessors.len(), || {
                    place("attributes")
                })?;
            }
            if let Some(indices) = &of.indices {
                there(indices.value(), root.accessors.len(), || place("indices"))?;
            }
            if let Some(material) = &of.material {
                there(material.value(), root.materials.len(), || place("material"))?;
            }
        }
    }
    Ok(())
}
