//! How opaque a material is, by its own model.

use ufbx::{Material, MaterialMap, ShaderType};

/// Opacity, 0 to 1, without what pictures say of it.
///
/// The lambert and phong of FBX say how transparent a material is by a colour and a factor, and some
/// programs write the outcome beside them as `Opacity`. Physically based materials have an opacity of
/// their own.
pub(crate) fn opacity(material: &Material) -> f64 {
    let opacity = match material.shader_type {
        ShaderType::Unknown | ShaderType::FbxLambert | ShaderType::FbxPhong => of_fbx(material),
        // Blender writes 1 - alpha as the factor, and the base colour as the colour of transparency.
        ShaderType::BlenderPhong => own(material)
            .or_else(|| value(&material.fbx.transparency_factor).map(|factor| 1.0 - factor))
            .unwrap_or(1.0),
        ShaderType::ShaderfxGraph => of_graph(material).unwrap_or(1.0),
        _ => value(&material.pbr.opacity).unwrap_or(1.0),
    };
    match opacity.is_finite() {
        true => opacity.clamp(0.0, 1.0),
        false => 1.0,
    }
}

fn of_fbx(material: &Material) -> f64 {
    if let Some(own) = own(material) {
        return own;
    }
    let factor = value(&material.fbx.transparency_factor);
    let colour = value(&material.fbx.transparency_color);
    match (factor, colour) {
        (Some(factor), Some(colour)) => 1.0 - factor * colour,
        (Some(factor), None) => 1.0 - factor,
        // White without a factor is the colour of a filter that nothing applies.
        (None, Some(colour)) if colour < 1.0 => 1.0 - colour,
        (None, _) => 1.0,
    }
}

/// What the file writes down as the outcome.
fn own(material: &Material) -> Option<f64> {
    let prop = material.element.props.find_prop("Opacity")?;
    Some(prop.value_vec4.x)
}

/// Stingray's materials are graphs; those of the preset that is transparent call it `opacity`.
fn of_graph(material: &Material) -> Option<f64> {
    let shader = material.shader.as_ref()?;
    let bindings = ufbx::find_shader_prop_bindings(shader, "opacity");
    let name = bindings.first().map(|binding| &*binding.material_prop)?;
    Some(material.element.props.find_prop(name)?.value_vec4.x)
}

/// A number, or the mean of a colour: glTF has no transparent colours.
fn value(map: &MaterialMap) -> Option<f64> {
    let v = map.value_vec4;
    map.has_value.then_some(match map.value_components {
        0 | 1 => v.x,
        _ => (v.x + v.y + v.z) / 3.0,
    })
}
