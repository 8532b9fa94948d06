//! Materials of the metallic-roughness model, from what the file has.

use super::convert::finite;
use super::opacity::opacity;
use super::textures::{Textures, is_laid_alike};
use super::unsaid::{Unsaid, is_physical};
use super::uv_sets::{UvNames, UvOrder, settle, wearers};
use crate::model::{Material, TextureUse};
use crate::report::Report;
use std::collections::BTreeMap;
use ufbx::{MaterialMap, Scene, ShaderType, TextureType};

/// A colour that is this much above 1 is 1.
const RANGE: f64 = 1e-6;

/// Reads every material, and in which order the meshes that wear it have to write their UV sets.
/// `textures` finds their pictures.
pub(crate) fn read_materials(
    scene: &Scene,
    textures: &mut Textures,
    report: &mut Report,
) -> (Vec<Material>, Vec<UvOrder>) {
    let wearers = wearers(scene);
    let mut unsaid = Unsaid::default();
    let mut made = Vec::new();
    for (source, wearers) in (&scene.materials).into_iter().zip(&wearers) {
        let mut reader = Reader {
            source,
            name: source.element.name.to_string(),
            names: UvNames::default(),
            textures: &mut *textures,
            unsaid: &mut unsaid,
            report: &mut *report,
        };
        let mut material = reader.read();
        let names = reader.names;
        let order = settle(&mut material, names, wearers, report);
        made.push((material, order));
    }
    unsaid.report(report);
    made.into_iter().unzip()
}

/// Reads one material.
struct Reader<'a, 't> {
    source: &'a ufbx::Material,
    name: String,
    /// The UV sets that its textures use.
    names: UvNames,
    textures: &'a mut Textures<'t>,
    unsaid: &'a mut Unsaid,
    report: &'a mut Report,
}

impl Reader<'_, '_> {
    fn read(&mut self) -> Material {
        let (pbr, features) = (&self.source.pbr, &self.source.features);
        self.unsaid.look(self.source, &self.name);
        self.several();
        let mut base_texture = self.picture(&pbr.base_color);
        let factor = number(&pbr.base_factor, 1.0);
        // A texture replaces the colour in FBX; in glTF the two are multiplied.
        let colour = match &base_texture {
            Some(_) => [factor; 3],
            None => rgb(&pbr.base_color, 0.8).map(|c| c * factor),
        };
        if colour.iter().any(|c| !(0.0..=1.0 + RANGE).contains(c)) {
            let detail = "its colour lies outside of 0 to 1, where glTF's end; it is cut there";
            self.unsaid.add("colour-range", &self.name, detail);
        }
        let (alpha, own_alpha) = self.alpha(&mut base_texture);
        let (emissive, emissive_strength, emissive_texture) = self.emission();
        let normal_texture = self.normals();
        let (metallic_roughness_texture, metallic, roughness) = self.metallic_roughness();
        Material {
            base_colour: [colour[0], colour[1], colour[2], alpha]
                .map(|c| finite(c).clamp(0.0, 1.0)),
            base_texture,
            metallic: finite(metallic).clamp(0.0, 1.0),
            roughness: finite(roughness).clamp(0.0, 1.0),
            metallic_roughness_texture,
            emissive,
            emissive_strength,
            emissive_texture,
            normal_texture,
            occlusion_texture: self.picture(&pbr.ambient_occlusion),
            blend: alpha < 1.0 || own_alpha,
            double_sided: features.double_sided.enabled,
            name: self.name.clone(),
        }
    }

    fn picture(&mut self, map: &MaterialMap) -> Option<TextureUse> {
        self.textures.of_map(map, &mut self.names, self.report)
    }

    /// Several textures on one property: all but the first are lost.
    fn several(&mut self) {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for texture in &self.source.textures {
            *counts.entry(&texture.material_prop).or_default() += 1;
        }
        for (property, count) in counts.into_iter().filter(|(_, count)| *count > 1) {
            let detail = format!("has {count} textures as its {property}; one is taken");
            self.report.lose("texture-layers", &self.name, detail);
        }
    }

    /// Opacity, and whether the colour's picture has it. Where another picture has it, the two are put
    /// together, as far as it is known what that one means.
    ///
    /// A picture stands for the number that it hangs at, which files leave at whatever it was, often at what
    /// would be invisible: where the picture is not there or is not carried, the material is opaque.
    fn alpha(&mut self, base: &mut Option<TextureUse>) -> (f64, bool) {
        const OPAQUE: (f64, bool) = (1.0, false);
        let (pbr, fbx) = (&self.source.pbr, &self.source.fbx);
        let classic = !is_physical(self.source.shader_type);
        let maps = [
            &pbr.opacity,
            &fbx.transparency_color,
            &fbx.transparency_factor,
        ];
        let maps = maps.into_iter().take(if classic { 3 } else { 1 });
        let maps = maps.filter(|map| map.texture_enabled && map.texture.is_some());
        let Some((map, texture)) = maps.filter_map(|m| Some((m, m.texture.as_deref()?))).next()
        else {
            return (opacity(self.source), false);
        };
        let of_colour = pbr.base_color.texture.as_deref();
        let same = of_colour.filter(|colour| is_same_picture(colour, texture));
        let detail = match (base.as_ref(), same) {
            (Some(base), Some(colour)) if self.textures.has_alpha(base) => {
                if is_laid_alike(colour, texture) {
                    return (1.0, true);
                }
                "colour and opacity are laid on in two ways, and lie in one picture; it is opaque"
            }
            // That it was not found is said already.
            (None, Some(_)) => return OPAQUE,
            (Some(_), Some(_)) => {
                "opacity lies in the picture of the colour, which has no alpha channel; it is opaque"
            }
            // Some programs write opacity as the colour of transparency, some the inverse, and none says
            // which. A picture of an opacity is white where it is opaque.
            (_, None) if !std::ptr::eq(map, &pbr.opacity) => {
                "opacity lies in a picture of its own, of which is not known whether white is opaque; it is opaque until that lies in the alpha channel of the colour's"
            }
            (_, None) => {
                let Some(found) = self.picture(map) else {
                    return OPAQUE;
                };
                match self.textures.with_opacity(base.as_ref(), &found) {
                    Ok(made) => {
                        *base = Some(made);
                        return (1.0, true);
                    }
                    Err(detail) => detail,
                }
            }
        };
        self.unsaid.add("opacity-map", &self.name, detail);
        OPAQUE
    }

    /// Emission with its hue, what it is multiplied by (1 or more), and its picture.
    fn emission(&mut self) -> ([f32; 3], f32, Option<TextureUse>) {
        let pbr = &self.source.pbr;
        let factor = number(&pbr.emission_factor, 1.0);
        let texture = match factor > 0.0 {
            true => self.picture(&pbr.emission_color),
            false => None,
        };
        let colour = match &texture {
            Some(_) => [factor; 3],
            // A picture that is not there glows nowhere.
            None if pbr.emission_color.texture.is_some() && pbr.emission_color.texture_enabled => {
                [0.0; 3]
            }
            None => rgb(&pbr.emission_color, 0.0).map(|c| c * factor),
        };
        let colour = colour.map(|c| f64::from(finite(c).max(0.0)));
        let strength = colour.into_iter().fold(1.0, f64::max);
        (
            colour.map(|c| finite(c / strength)),
            finite(strength),
            texture,
        )
    }

    fn normals(&mut self) -> Option<TextureUse> {
        let (pbr, fbx) = (&self.source.pbr, &self.source.fbx);
        // What 3ds Max calls bump is a height map, unless a map of normals is put between.
        let between = matches!(
            self.source.shader_type,
            ShaderType::E3DsMaxPhysicalMaterial | ShaderType::OpenpbrMaterial
        );
        let is_file = |map: &MaterialMap| {
            let texture = map.texture.as_deref();
            texture.is_some_and(|texture| texture.type_ == TextureType::File)
        };
        let heights = between && is_file(&pbr.normal_map);
        let found = match heights {
            true => None,
            false => self.picture(&pbr.normal_map),
        };
        let found = found.or_else(|| self.picture(&fbx.normal_map));
        let bump = fbx.bump.texture.as_deref();
        let apart = bump.is_some_and(|bump| {
            let normals = [&pbr.normal_map, &fbx.normal_map];
            let mut normals = normals.into_iter().filter_map(|map| map.texture.as_deref());
            heights || !normals.any(|normals| is_same_picture(normals, bump))
        });
        if heights || apart {
            let detail = "a height map for bumps has no place in glTF; bake it into a normal map";
            self.unsaid.add("bump-map", &self.name, detail);
        }
        found
    }

    /// Metalness and roughness share one picture in glTF, in blue and green.
    fn metallic_roughness(&mut self) -> (Option<TextureUse>, f64, f64) {
        let material = self.source;
        let pbr = &material.pbr;
        let metallic = number(&pbr.metalness, 0.0);
        let glossy = material.features.roughness_as_glossiness.enabled;
        let roughness = match pbr.roughness.has_value || !pbr.glossiness.has_value {
            true if glossy => 1.0 - number(&pbr.roughness, 0.0),
            true => number(&pbr.roughness, 1.0),
            false => 1.0 - number(&pbr.glossiness, 0.0),
        };
        // A picture of shininess is none of roughness, which `Unsaid` says.
        if matches!(
            material.shader_type,
            ShaderType::Unknown | ShaderType::FbxLambert | ShaderType::FbxPhong
        ) {
            return (None, metallic, roughness);
        }
        let has = |map: &MaterialMap| map.texture_enabled && map.texture.is_some();
        let (rough_map, is_gloss) = match has(&pbr.glossiness) {
            true => (&pbr.glossiness, true),
            false => (&pbr.roughness, false),
        };
        let (of_metal, of_rough) = (has(&pbr.metalness), has(rough_map));
        if !of_metal && !of_rough {
            return (None, metallic, roughness);
        }
        let rough = self.picture(rough_map);
        // Without metal nothing of the picture but its green is read, and in a picture of roughness
        // that is grey: it serves as it is.
        if !of_metal && metallic == 0.0 && !is_gloss {
            return match rough {
                Some(map) => (Some(map), 0.0, 1.0),
                None => (None, metallic, roughness),
            };
        }
        let id = |map: &MaterialMap| map.texture.as_ref().map(|t| t.element.typed_id);
        if of_metal && of_rough && id(&pbr.metalness) == id(rough_map) {
            if matches!(material.shader_type, ShaderType::GltfMaterial) {
                return match rough {
                    Some(map) => (Some(map), 1.0, 1.0),
                    None => (None, metallic, roughness),
                };
            }
            let detail =
                "metalness and roughness lie in one picture, and not known in which channels";
            self.unsaid.add("metal-roughness-map", &self.name, detail);
            return (None, metallic, roughness);
        }
        let metal = self.picture(&pbr.metalness);
        if metal.is_none() && rough.is_none() {
            return (None, metallic, roughness);
        }
        let of_rough = rough.as_ref().map(|rough| (rough, is_gloss));
        match self.textures.metal_rough(metal.as_ref(), of_rough) {
            Ok(map) => {
                // A texture replaces the number.
                let number = |has: bool, without: f64| if has { 1.0 } else { without };
                let metallic = number(metal.is_some(), metallic);
                (Some(map), metallic, number(rough.is_some(), roughness))
            }
            Err(detail) => {
                self.unsaid.add("metal-roughness-map", &self.name, detail);
                (None, metallic, roughness)
            }
        }
    }
}

/// The same picture by the same file, though it may be two textures.
fn is_same_picture(a: &ufbx::Texture, b: &ufbx::Texture) -> bool {
    let video = |texture: &ufbx::Texture| texture.video.as_ref().map(|v| v.element.typed_id);
    a.element.typed_id == b.element.typed_id
        || (a.has_file && b.has_file && a.file_index == b.file_index)
        || (video(a).is_some() && video(a) == video(b))
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
