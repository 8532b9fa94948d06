//! Materials of the metallic-roughness model, from what the file has.

use super::convert::finite;
use super::textures::Textures;
use crate::model::{Material, TextureUse};
use crate::report::Report;
use ufbx::{MaterialMap, Scene, ShaderType};

/// Reads every material. `textures` finds their pictures.
pub(crate) fn read_materials(
    scene: &Scene,
    textures: &mut Textures,
    report: &mut Report,
) -> Vec<Material> {
    let sets = uv_sets_by_material(scene);
    (&scene.materials)
        .into_iter()
        .zip(&sets)
        .map(|(material, sets)| read_material(material, sets, textures, report))
        .collect()
}

/// Names of the UV sets of the first mesh that wears each material: texture coordinates are found by
/// name in FBX and by number in glTF.
fn uv_sets_by_material(scene: &Scene) -> Vec<Vec<String>> {
    let mut sets = vec![Vec::new(); scene.materials.len()];
    for mesh in &scene.meshes {
        let names: Vec<String> = mesh
            .uv_sets
            .iter()
            .map(|set| set.name.to_string())
            .collect();
        let of_nodes = (&mesh.element.instances)
            .into_iter()
            .flat_map(|node| &node.materials);
        for material in (&mesh.materials).into_iter().chain(of_nodes) {
            if let Some(slot) = sets.get_mut(material.element.typed_id as usize)
                && slot.is_empty()
            {
                slot.clone_from(&names);
            }
        }
    }
    sets
}

fn read_material(
    material: &ufbx::Material,
    uv_sets: &[String],
    textures: &mut Textures,
    report: &mut Report,
) -> Material {
    let (pbr, fbx, features) = (&material.pbr, &material.fbx, &material.features);
    let name = material.element.name.to_string();
    let mut picture =
        |map: &MaterialMap, report: &mut Report| textures.of_map(map, uv_sets, report);

    let base_texture = picture(&pbr.base_color, report);
    let factor = number(&pbr.base_factor, 1.0);
    // A texture replaces the colour in FBX; in glTF the two are multiplied.
    let colour = match &base_texture {
        Some(_) => [factor; 3],
        None => rgb(&pbr.base_color, 0.8).map(|c| c * factor),
    };
    let opacity = opacity(material);
    let emission_factor = number(&pbr.emission_factor, 1.0);
    let emissive_texture = match emission_factor > 0.0 {
        true => picture(&pbr.emission_color, report),
        false => None,
    };
    let emissive = match &emissive_texture {
        Some(_) => [emission_factor; 3],
        None => rgb(&pbr.emission_color, 0.0).map(|c| c * emission_factor),
    };
    let normal_texture = match picture(&pbr.normal_map, report) {
        Some(map) => Some(map),
        None => picture(&fbx.normal_map, report),
    };
    if normal_texture.is_none() && fbx.bump.texture.is_some() {
        report.lose(
            "bump-map",
            &name,
            "a height map for bumps has no place in glTF",
        );
    }
    let (metallic_roughness_texture, metallic, roughness) =
        metallic_roughness(material, &name, &mut picture, report);
    let opacity_texture = pbr
        .opacity
        .texture
        .as_ref()
        .or(fbx.transparency_color.texture.as_ref());
    let base_image = pbr.base_color.texture.as_ref();
    let own_alpha = opacity_texture.is_some()
        && opacity_texture.map(|t| t.element.typed_id) == base_image.map(|t| t.element.typed_id);
    if opacity_texture.is_some() && !own_alpha {
        let detail = "opacity lies in a picture of its own; glTF wants it in the colour's alpha";
        report.lose("opacity-map", &name, detail);
    }
    Material {
        base_colour: [colour[0], colour[1], colour[2], 1.0].map(|c| finite(c).clamp(0.0, 1.0)),
        base_texture,
        metallic: finite(metallic).clamp(0.0, 1.0),
        roughness: finite(roughness).clamp(0.0, 1.0),
        metallic_roughness_texture,
        emissive: emissive.map(|c| finite(c).clamp(0.0, 1.0)),
        emissive_texture,
        normal_texture,
        occlusion_texture: picture(&pbr.ambient_occlusion, report),
        blend: opacity < 1.0 || own_alpha,
        double_sided: features.double_sided.enabled,
        name,
    }
    .with_opacity(opacity)
}

impl Material {
    fn with_opacity(mut self, opacity: f64) -> Self {
        self.base_colour[3] = finite(opacity).clamp(0.0, 1.0);
        self
    }
}

/// Metalness and roughness share one picture in glTF, in blue and green.
fn metallic_roughness(
    material: &ufbx::Material,
    name: &str,
    picture: &mut impl FnMut(&MaterialMap, &mut Report) -> Option<TextureUse>,
    report: &mut Report,
) -> (Option<TextureUse>, f64, f64) {
    let pbr = &material.pbr;
    let metallic = number(&pbr.metalness, 0.0);
    let glossy = material.features.roughness_as_glossiness.enabled;
    let roughness = match pbr.roughness.has_value || !pbr.glossiness.has_value {
        true if glossy => 1.0 - number(&pbr.roughness, 0.0),
        true => number(&pbr.roughness, 1.0),
        false => 1.0 - number(&pbr.glossiness, 0.0),
    };
    let id = |map: &MaterialMap| map.texture.as_ref().map(|t| t.element.typed_id);
    let (of_metal, of_rough) = (id(&pbr.metalness), id(&pbr.roughness));
    if of_metal.is_none() && of_rough.is_none() {
        return (None, metallic, roughness);
    }
    // Without metal nothing of the picture but its green is read, and in a picture of roughness that is
    // grey: it serves as it is.
    if of_metal.is_none() && metallic == 0.0 && !glossy && !pbr.glossiness.has_value {
        return match picture(&pbr.roughness, report) {
            Some(map) => (Some(map), 0.0, 1.0),
            None => (None, metallic, roughness),
        };
    }
    let packed = of_metal == of_rough && matches!(material.shader_type, ShaderType::GltfMaterial);
    if !packed {
        let detail = "metalness and roughness lie in pictures of their own; glTF wants them in one";
        report.lose("metal-roughness-map", name, detail);
        return (None, metallic, roughness);
    }
    match picture(&pbr.roughness, report) {
        Some(map) => (Some(map), 1.0, 1.0),
        None => (None, metallic, roughness),
    }
}

fn opacity(material: &ufbx::Material) -> f64 {
    let pbr = &material.pbr.opacity;
    match pbr.has_value {
        true => match pbr.value_components {
            0 | 1 => pbr.value_vec4.x,
            // Transparent colours are not in glTF: their mean.
            _ => (pbr.value_vec4.x + pbr.value_vec4.y + pbr.value_vec4.z) / 3.0,
        },
        false => 1.0,
    }
}

fn number(map: &MaterialMap, without: f64) -> f64 {
    let value = if map.has_value {
        map.value_vec4.x
    } else {
        without
    };
    if value.is_finite() { value } else { without }
}

fn rgb(map: &MaterialMap, without: f64) -> [f64; 3] {
    match map.has_value {
        true => [map.value_vec4.x, map.value_vec4.y, map.value_vec4.z],
        false => [without; 3],
    }
}
