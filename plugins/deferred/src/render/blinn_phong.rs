//! A material of the second shading model.

use bevy::asset::{Asset, Assets, Handle, uuid_handle};
use bevy::color::LinearRgba;
use bevy::image::Image;
use bevy::material::OpaqueRendererMethod;
use bevy::math::Vec4;
use bevy::mesh::MeshVertexBufferLayoutRef;
use bevy::pbr::{Material, MaterialPipeline, MaterialPipelineKey, MaterialPlugin};
use bevy::prelude::*;
use bevy::reflect::TypePath;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::{
    AsBindGroup, AsBindGroupShaderType, RenderPipelineDescriptor, ShaderType,
    SpecializedMeshPipelineError,
};
use bevy::render::texture::GpuImage;
use bevy::shader::{Shader, ShaderRef};

use crate::gbuffer::PHONG;
use crate::model::{BLINN_PHONG, ShadingModels};

/// What is raised to the exponent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Lobe {
    /// The cosine between the normal and the direction halfway to the light (Blinn 1977).
    #[default]
    Blinn,
    /// The cosine between the mirrored light and the eye (Phong 1975).
    Phong,
}

/// Diffuse light by Lambert, a highlight by Blinn (1977) or Phong (1975).
///
/// It is opaque, and seen by cameras with [`DeferredLighting`](crate::DeferredLighting) alone: Bevy's own lighting
/// pass leaves it black. Maps need texture coordinates on the mesh, a normal map tangents as well.
#[derive(Asset, AsBindGroup, TypePath, Clone, Debug, PartialEq)]
#[uniform(0, Uniform)]
#[bind_group_data(Key)]
pub struct BlinnPhongMaterial {
    /// Albedo of the diffuse part, `0..=1` a channel.
    pub diffuse: LinearRgba,
    /// Albedo of the highlight for an eye on the normal, `0..=1` a channel.
    pub specular: LinearRgba,
    /// Radiance that it sends out, cd/m²; exposure does not change it.
    pub emissive: LinearRgba,
    /// The higher, the smaller is the highlight: 1 to 65536, kept in steps of 0.017 %.
    pub exponent: f32,
    /// What the highlight is made of.
    pub lobe: Lobe,
    /// Each triangle has one normal, its own.
    pub faceted: bool,
    /// Multiplies `diffuse`.
    #[texture(1)]
    #[sampler(2)]
    pub diffuse_map: Option<Handle<Image>>,
    /// Multiplies `specular`.
    #[texture(3)]
    #[sampler(4)]
    pub specular_map: Option<Handle<Image>>,
    /// Normals in tangent space, +y up, as in glTF.
    #[texture(5)]
    #[sampler(6)]
    pub normal_map: Option<Handle<Image>>,
}

impl Default for BlinnPhongMaterial {
    fn default() -> Self {
        Self {
            diffuse: LinearRgba::gray(0.5),
            specular: LinearRgba::gray(0.04),
            emissive: LinearRgba::BLACK,
            exponent: 32.0,
            lobe: Lobe::Blinn,
            faceted: false,
            diffuse_map: None,
            specular_map: None,
            normal_map: None,
        }
    }
}

/// `BlinnPhong` in `shaders/src/deferred/write_blinn_phong.wgsl`.
#[derive(ShaderType, Clone, Copy, Debug, Default)]
struct Uniform {
    diffuse: Vec4,
    specular: Vec4,
    emissive: Vec4,
    exponent: f32,
    flags: u32,
}

impl AsBindGroupShaderType<Uniform> for BlinnPhongMaterial {
    fn as_bind_group_shader_type(&self, _: &RenderAssets<GpuImage>) -> Uniform {
        Uniform {
            diffuse: self.diffuse.to_vec4(),
            specular: self.specular.to_vec4(),
            emissive: self.emissive.to_vec4(),
            exponent: self.exponent,
            flags: match self.lobe {
                Lobe::Blinn => 0,
                Lobe::Phong => PHONG,
            },
        }
    }
}

/// What its pipelines differ in: what is not used is not compiled.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Key {
    faceted: bool,
    diffuse_map: bool,
    specular_map: bool,
    normal_map: bool,
}

impl From<&BlinnPhongMaterial> for Key {
    fn from(material: &BlinnPhongMaterial) -> Self {
        Self {
            faceted: material.faceted,
            diffuse_map: material.diffuse_map.is_some(),
            specular_map: material.specular_map.is_some(),
            normal_map: material.normal_map.is_some(),
        }
    }
}

const WRITE: Handle<Shader> = uuid_handle!("b19d5a0e-8a5c-4d6b-8a44-0b8f0a6f5e21");

impl Material for BlinnPhongMaterial {
    fn deferred_fragment_shader() -> ShaderRef {
        WRITE.into()
    }

    fn opaque_render_method(&self) -> OpaqueRendererMethod {
        OpaqueRendererMethod::Deferred
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _: &MeshVertexBufferLayoutRef,
        key: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        let Key {
            faceted,
            diffuse_map,
            specular_map,
            normal_map,
        } = key.bind_group_data;
        let defs = [
            (faceted, "FACETED"),
            (diffuse_map, "DIFFUSE_MAP"),
            (specular_map, "SPECULAR_MAP"),
            (normal_map, "NORMAL_MAP"),
        ];
        if let Some(fragment) = &mut descriptor.fragment {
            let used = defs.into_iter().filter(|(used, _)| *used);
            fragment.shader_defs.extend(used.map(|(_, def)| def.into()));
        }
        Ok(())
    }
}

/// Adds [`BlinnPhongMaterial`] and its shading model. Add before [`DeferredPlugin`](crate::DeferredPlugin) is
/// finished, that is, before the first frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct BlinnPhongPlugin;

impl Plugin for BlinnPhongPlugin {
    fn build(&self, app: &mut App) {
        let file = dolomite_shaders::find("deferred/write_blinn_phong.wgsl");
        let model = dolomite_shaders::find("deferred/blinn_phong.wgsl");
        let mut models = app.world_mut().get_resource_or_init::<ShadingModels>();
        if let Err(refusal) = models.add(BLINN_PHONG, model.source, "blinn_phong") {
            bevy::log::error!("BlinnPhongPlugin: {refusal}");
            return;
        }
        models.dark_from_behind(BLINN_PHONG);
        let Some(mut shaders) = app.world_mut().get_resource_mut::<Assets<Shader>>() else {
            return;
        };
        let mut shader = Shader::from_wgsl(file.source, file.path);
        if cfg!(debug_assertions) {
            shader.validate_shader = bevy::shader::ValidateShader::Enabled;
        }
        if let Err(refusal) = shaders.insert(&WRITE, shader) {
            bevy::log::error!("{}: {refusal}", file.path);
            return;
        }
        app.add_plugins(MaterialPlugin::<BlinnPhongMaterial>::default());
    }
}
