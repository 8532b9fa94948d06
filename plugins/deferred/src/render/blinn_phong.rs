//! A material of the second shading model.

use bevy::asset::{Asset, Assets, Handle, uuid_handle};
use bevy::color::LinearRgba;
use bevy::material::OpaqueRendererMethod;
use bevy::pbr::{Material, MaterialPlugin};
use bevy::prelude::*;
use bevy::reflect::TypePath;
use bevy::render::render_resource::AsBindGroup;
use bevy::shader::{Shader, ShaderRef};

use crate::model::{BLINN_PHONG, ShadingModels};

/// Diffuse light by Lambert, a highlight by Blinn (1977).
///
/// It is opaque, and seen by cameras with [`DeferredLighting`](crate::DeferredLighting) alone: Bevy's own lighting
/// pass leaves it black. Textures of its own it has none yet.
#[derive(Asset, AsBindGroup, TypePath, Clone, Copy, Debug, PartialEq)]
pub struct BlinnPhongMaterial {
    /// Albedo of the diffuse part, `0..=1` a channel.
    #[uniform(0)]
    pub diffuse: LinearRgba,
    /// Albedo of the highlight for an eye on the normal, `0..=1` a channel.
    #[uniform(0)]
    pub specular: LinearRgba,
    /// Radiance that it sends out, cd/m²; exposure does not change it.
    #[uniform(0)]
    pub emissive: LinearRgba,
    /// The higher, the smaller is the highlight: 1 to 65536, kept in steps of 0.017 %.
    #[uniform(0)]
    pub exponent: f32,
}

impl Default for BlinnPhongMaterial {
    fn default() -> Self {
        Self {
            diffuse: LinearRgba::gray(0.5),
            specular: LinearRgba::gray(0.04),
            emissive: LinearRgba::BLACK,
            exponent: 32.0,
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
