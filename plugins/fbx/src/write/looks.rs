//! Materials, lights and cameras.

use crate::model::{Camera, Light, LightKind, Material, Projection, TextureUse};
use gltf_json::camera::{Orthographic, Perspective, Type};
use gltf_json::extensions::material::{
    Material as MaterialExtension, NormalTexture as NormalExtension,
    OcclusionTexture as OcclusionExtension,
};
use gltf_json::extensions::scene::khr_lights_punctual::{
    Light as JsonLight, Spot, Type as JsonType,
};
use gltf_json::extensions::texture::Info as InfoExtension;
use gltf_json::material::{
    AlphaMode, EmissiveFactor, NormalTexture, OcclusionTexture, PbrBaseColorFactor,
    PbrMetallicRoughness, StrengthFactor,
};
use gltf_json::texture::{Info, Sampler, WrappingMode};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root, Texture};
use serde_json::{Map, Value, json};

/// A material; its textures and samplers are added to `root`.
pub(crate) fn material(root: &mut Root, material: &Material) -> gltf_json::Material {
    let info = |root: &mut Root, texture: &Option<TextureUse>| {
        texture.as_ref().map(|texture| self::info(root, texture))
    };
    gltf_json::Material {
        alpha_cutoff: None,
        alpha_mode: Checked::Valid(match material.blend {
            true => AlphaMode::Blend,
            false => AlphaMode::Opaque,
        }),
        double_sided: material.double_sided,
        name: super::names::name(&material.name),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor(material.base_colour),
            base_color_texture: info(root, &material.base_texture),
            metallic_factor: StrengthFactor(material.metallic),
            roughness_factor: StrengthFactor(material.roughness),
            metallic_roughness_texture: info(root, &material.metallic_roughness_texture),
            extensions: None,
            extras: None,
        },
        normal_texture: material
            .normal_texture
            .as_ref()
            .map(|texture| NormalTexture {
                index: self::texture(root, texture),
                scale: 1.0,
                tex_coord: texture.uv_set,
                extensions: placed(root, texture)
                    .map(|others| with(|new: &mut NormalExtension| new.others = others)),
                extras: None,
            }),
        occlusion_texture: material
            .occlusion_texture
            .as_ref()
            .map(|texture| OcclusionTexture {
                index: self::texture(root, texture),
                strength: StrengthFactor(1.0),
                tex_coord: texture.uv_set,
                extensions: placed(root, texture)
                    .map(|others| with(|new: &mut OcclusionExtension| new.others = others)),
                extras: None,
            }),
        emissive_texture: info(root, &material.emissive_texture),
        emissive_factor: EmissiveFactor(material.emissive),
        extensions: glowing(root, material)
            .map(|others| with(|new: &mut MaterialExtension| new.others = others)),
        extras: None,
    }
}

fn info(root: &mut Root, texture: &TextureUse) -> Info {
    Info {
        index: self::texture(root, texture),
        tex_coord: texture.uv_set,
        extensions: placed(root, texture)
            .map(|others| with(|new: &mut InfoExtension| new.others = others)),
        extras: None,
    }
}

/// The default, changed. How many more fields the crate's types have depends on who else uses it.
fn with<T: Default>(change: impl FnOnce(&mut T)) -> T {
    let mut new = T::default();
    change(&mut new);
    new
}

/// KHR_texture_transform, which any texture may have. Written by hand: the crate's own type says
/// `"texCoord": null`, which is not valid.
fn placed(root: &mut Root, texture: &TextureUse) -> Option<Map<String, Value>> {
    let (offset, rotation, scale) = texture.transform?;
    super::names::uses(root, "KHR_texture_transform");
    let mut said = Map::new();
    said.insert("offset".into(), json!(offset.map(short)));
    if rotation != 0.0 {
        said.insert("rotation".into(), json!(short(rotation)));
    }
    said.insert("scale".into(), json!(scale.map(short)));
    Some(Map::from_iter([(
        "KHR_texture_transform".to_owned(),
        Value::Object(said),
    )]))
}

/// KHR_materials_emissive_strength, where more is emitted than a colour can say.
fn glowing(root: &mut Root, material: &Material) -> Option<Map<String, Value>> {
    if material.emissive_strength <= 1.0 {
        return None;
    }
    const NAME: &str = "KHR_materials_emissive_strength";
    super::names::uses(root, NAME);
    let said = json!({ "emissiveStrength": short(material.emissive_strength) });
    Some(Map::from_iter([(NAME.to_owned(), said)]))
}

/// The f64 whose shortest decimal is that of `x`.
fn short(x: f32) -> f64 {
    x.to_string().parse().unwrap_or_else(|_| f64::from(x))
}

/// The texture of an image and a way to repeat it, made once.
fn texture(root: &mut Root, texture: &TextureUse) -> Index<Texture> {
    let wrap = |repeat: bool| {
        Checked::Valid(match repeat {
            true => WrappingMode::Repeat,
            false => WrappingMode::ClampToEdge,
        })
    };
    let [wrap_s, wrap_t] = texture.repeat.map(wrap);
    let same = root
        .samplers
        .iter()
        .position(|s| s.wrap_s == wrap_s && s.wrap_t == wrap_t);
    let sampler = match same {
        Some(number) => Index::new(number as u32),
        None => root.push(Sampler {
            wrap_s,
            wrap_t,
            ..Sampler::default()
        }),
    };
    let same = root.textures.iter().position(|t| {
        t.source.value() == texture.image && t.sampler.map(|s| s.value()) == Some(sampler.value())
    });
    match same {
        Some(number) => Index::new(number as u32),
        None => root.push(Texture {
            name: None,
            sampler: Some(sampler),
            source: Index::new(texture.image as u32),
            extensions: None,
            extras: None,
        }),
    }
}

/// A light of KHR_lights_punctual. FBX knows no photometric unit; its number is handed on.
pub(crate) fn light(light: &Light) -> JsonLight {
    JsonLight {
        color: light.colour,
        extensions: None,
        extras: None,
        intensity: light.intensity,
        name: super::names::name(&light.name),
        range: None,
        spot: match light.kind {
            LightKind::Spot { inner, outer } => Some(Spot {
                inner_cone_angle: inner,
                outer_cone_angle: outer,
            }),
            _ => None,
        },
        type_: Checked::Valid(match light.kind {
            LightKind::Directional => JsonType::Directional,
            LightKind::Point => JsonType::Point,
            LightKind::Spot { .. } => JsonType::Spot,
        }),
    }
}

/// A camera.
pub(crate) fn camera(camera: &Camera) -> gltf_json::Camera {
    let (mut perspective, mut orthographic) = (None, None);
    let kind = match camera.projection {
        Projection::Perspective(yfov, aspect) => {
            perspective = Some(Perspective {
                aspect_ratio: Some(aspect),
                yfov,
                zfar: camera.far.is_finite().then_some(camera.far),
                znear: camera.near,
                extensions: None,
                extras: None,
            });
            Type::Perspective
        }
        Projection::Orthographic(xmag, ymag) => {
            orthographic = Some(Orthographic {
                xmag,
                ymag,
                zfar: camera.far,
                znear: camera.near,
                extensions: None,
                extras: None,
            });
            Type::Orthographic
        }
    };
    gltf_json::Camera {
        name: super::names::name(&camera.name),
        orthographic,
        perspective,
        type_: Checked::Valid(kind),
        extensions: None,
        extras: None,
    }
}
