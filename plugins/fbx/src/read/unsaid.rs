//! What materials say that glTF's metallic-roughness material does not.

use crate::report::Report;
use std::collections::BTreeMap;
use ufbx::{Material, MaterialMap, ShaderType};

/// Names that a line lists before it counts the others.
const LISTED: usize = 3;

/// Kinds of properties that were met, each with the materials that use it.
#[derive(Debug, Default)]
pub(crate) struct Unsaid {
    kinds: BTreeMap<&'static str, (&'static str, Vec<String>)>,
}

impl Unsaid {
    /// `material` has something of the kind `what`; `detail` says what becomes of it.
    pub(crate) fn add(&mut self, what: &'static str, material: &str, detail: &'static str) {
        let (_, names) = self.kinds.entry(what).or_insert((detail, Vec::new()));
        if !names.iter().any(|name| name == material) {
            names.push(material.to_owned());
        }
    }

    /// One line for each kind.
    pub(crate) fn report(self, report: &mut Report) {
        for (what, (detail, names)) in self.kinds {
            let mut listed = names[..names.len().min(LISTED)].join(", ");
            if names.len() > LISTED {
                listed += &format!(" and {} more", names.len() - LISTED);
            }
            report.lose(what, &listed, detail);
        }
    }

    /// Looks through all that this module knows of. `name` is the material's.
    pub(crate) fn look(&mut self, material: &Material, name: &str) {
        let kinds = match is_physical(material.shader_type) {
            true => physical(material),
            false => classic(material),
        };
        for (what, used, detail) in kinds.into_iter().chain(both(material)) {
            if used {
                self.add(what, name, detail);
            }
        }
    }
}

/// Whether the material is of a physically based model, and not FBX's own lambert or phong.
pub(crate) fn is_physical(shader: ShaderType) -> bool {
    !matches!(
        shader,
        ShaderType::Unknown
            | ShaderType::FbxLambert
            | ShaderType::FbxPhong
            | ShaderType::BlenderPhong
    )
}

type Kind = (&'static str, bool, &'static str);

/// Properties of FBX's own materials, whatever else they are.
fn both(material: &Material) -> Vec<Kind> {
    let (fbx, pbr) = (&material.fbx, &material.pbr);
    let displaced = has_texture(&fbx.displacement) || has_texture(&pbr.displacement_map);
    vec![
        (
            "displacement",
            displaced,
            "displacement by a picture is not in glTF; the surface is as its vertices have it",
        ),
        (
            "vector-displacement",
            has_texture(&fbx.vector_displacement),
            "displacement by a picture is not in glTF; the surface is as its vertices have it",
        ),
        (
            "ambient-map",
            has_texture(&fbx.ambient_color) || has_texture(&fbx.ambient_factor),
            "a picture of ambient light is not in glTF",
        ),
    ]
}

/// Lambert and phong.
fn classic(material: &Material) -> Vec<Kind> {
    let fbx = &material.fbx;
    // Blender writes metalness as the factor of reflection, and roughness as the picture of shininess.
    let blender = matches!(material.shader_type, ShaderType::BlenderPhong);
    let reflects = has_texture(&fbx.reflection_color)
        || has_texture(&fbx.reflection_factor)
        || strength(&fbx.reflection_color) * number(&fbx.reflection_factor, 1.0) > 0.0;
    let shines = number(&fbx.specular_factor, 1.0) * strength(&fbx.specular_color) > 0.0;
    vec![
        (
            "reflection",
            reflects && !blender,
            "reflection by a factor or a picture is not in glTF; metalness is 0",
        ),
        (
            "specular-map",
            has_texture(&fbx.specular_color) || has_texture(&fbx.specular_factor),
            "a picture of highlights is not in glTF's metallic-roughness material",
        ),
        (
            "specular-colour",
            shines && is_coloured(&fbx.specular_color),
            "coloured highlights are not in glTF's metallic-roughness material; they are white",
        ),
        (
            "shininess-map",
            has_texture(&fbx.specular_exponent) && !blender,
            "a picture of shininess is none of roughness; one roughness holds everywhere",
        ),
        (
            "factor-map",
            has_texture(&fbx.diffuse_factor) || has_texture(&fbx.emission_factor),
            "a picture that scales a colour is not in glTF; the colour is as it is without",
        ),
    ]
}

/// Materials of physically based models.
fn physical(material: &Material) -> Vec<Kind> {
    let (pbr, features) = (&material.pbr, &material.features);
    let used = |map: &MaterialMap| number(map, 0.0) > 0.0 || has_texture(map);
    let tinted = is_coloured(&pbr.specular_color) && used(&pbr.specular_factor);
    vec![
        (
            "transmission",
            features.transmission.enabled && used(&pbr.transmission_factor),
            "light that passes through is not carried over; the material is as opaque as its opacity",
        ),
        (
            "coat",
            features.coat.enabled && used(&pbr.coat_factor),
            "a clear coat is not carried over",
        ),
        (
            "sheen",
            features.sheen.enabled && used(&pbr.sheen_factor),
            "sheen is not carried over",
        ),
        (
            "subsurface",
            used(&pbr.subsurface_factor),
            "light below the surface is not carried over",
        ),
        (
            "anisotropy",
            used(&pbr.specular_anisotropy),
            "stretched highlights are not carried over",
        ),
        (
            "thin-film",
            used(&pbr.thin_film_factor) && used(&pbr.thin_film_thickness),
            "a thin film is not carried over",
        ),
        (
            "specular-colour",
            tinted || has_texture(&pbr.specular_color) || has_texture(&pbr.specular_factor),
            "coloured highlights are not in glTF's metallic-roughness material; they are white",
        ),
        (
            "factor-map",
            has_texture(&pbr.base_factor) || has_texture(&pbr.emission_factor),
            "a picture that scales a colour is not in glTF; the colour is as it is without",
        ),
        (
            "unlit",
            features.unlit.enabled,
            "is to be shown without light; it is lit",
        ),
    ]
}

fn has_texture(map: &MaterialMap) -> bool {
    map.texture.is_some() && map.texture_enabled
}

fn number(map: &MaterialMap, without: f64) -> f64 {
    match map.has_value && map.value_vec4.x.is_finite() {
        true => map.value_vec4.x,
        false => without,
    }
}

fn strength(map: &MaterialMap) -> f64 {
    let v = map.value_vec4;
    match map.has_value {
        true => v.x.max(v.y).max(v.z),
        false => 0.0,
    }
}

fn is_coloured(map: &MaterialMap) -> bool {
    let v = map.value_vec4;
    map.has_value && map.value_components >= 3 && (v.x - v.y).abs().max((v.x - v.z).abs()) > 1e-3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_is_one_line() {
        let mut unsaid = Unsaid::default();
        for name in ["a", "b", "b", "c", "d", "e"] {
            unsaid.add("coat", name, "is lost");
        }
        unsaid.add("sheen", "a", "is lost");
        let mut report = Report::default();
        unsaid.report(&mut report);
        let names: Vec<&str> = report.lost.iter().map(|lost| &*lost.name).collect();
        assert_eq!(names, ["a, b, c and 2 more", "a"]);
    }
}
