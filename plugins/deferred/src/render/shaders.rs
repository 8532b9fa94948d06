//! The WGSL files as assets.

use bevy::prelude::*;
use bevy::shader::{Shader, ValidateShader};

use super::dither::Dithered;
use crate::model::ShadingModels;

/// The entry points; and modules, which are kept alive.
#[derive(Resource, Clone)]
pub struct Shaders {
    /// `deferred/light.wgsl`.
    pub light: Handle<Shader>,
    /// `deferred/volume.wgsl`.
    pub volume: Handle<Shader>,
    /// `deferred/tiles.wgsl`.
    pub tiles: Handle<Shader>,
    /// `deferred/pyramid_build.wgsl`.
    pub pyramid_build: Handle<Shader>,
    /// `deferred/pyramid_lights.wgsl`.
    pub pyramid_lights: Handle<Shader>,
    /// `deferred/occlusion_trace.wgsl`.
    pub occlusion_trace: Handle<Shader>,
    /// `deferred/occlusion_filter.wgsl`.
    pub occlusion_filter: Handle<Shader>,
    /// `deferred/difference.wgsl`.
    pub difference: Handle<Shader>,
    /// Lighting ids of all models.
    pub models: Vec<u8>,
    #[expect(dead_code, reason = "held, never read")]
    modules: Vec<Handle<Shader>>,
}

/// A shader asset, validated in debug builds.
fn asset(source: String, path: &str) -> Shader {
    let mut shader = Shader::from_wgsl(source, path);
    if cfg!(debug_assertions) {
        shader.validate_shader = ValidateShader::Enabled;
    }
    shader
}

/// Registers all files of the folder, and the module that chooses among the app's models; `None` in an app without
/// shaders.
pub fn load(app: &mut App) -> Option<Shaders> {
    let models = app.world().get_resource::<ShadingModels>()?.clone();
    let dithered = app.world().contains_resource::<Dithered>();
    let mut assets = app.world_mut().get_resource_mut::<Assets<Shader>>()?;
    let mut modules = Vec::new();
    let folder = dolomite_shaders::ALL
        .iter()
        .filter(|file| file.path.starts_with("deferred/") && file.is_module());
    for file in folder {
        let mut module = asset(file.source.to_owned(), file.path);
        if dithered && file.path == "deferred/dither.wgsl" {
            module.shader_defs.push("DITHERED".into());
        }
        modules.push(assets.add(module));
    }
    // A model of ours is in the folder already.
    let known = |path: &str| {
        dolomite_shaders::ALL
            .iter()
            .any(|f| f.import_path() == Some(path))
    };
    for (path, source) in models.sources().filter(|(path, _)| !known(path)) {
        modules.push(assets.add(asset(source.to_owned(), path)));
    }
    modules.push(assets.add(asset(models.module(), "deferred/models.wgsl")));
    let mut entry = |path: &str| {
        let file = dolomite_shaders::find(path);
        assets.add(asset(file.source.to_owned(), path))
    };
    Some(Shaders {
        light: entry("deferred/light.wgsl"),
        volume: entry("deferred/volume.wgsl"),
        tiles: entry("deferred/tiles.wgsl"),
        pyramid_build: entry("deferred/pyramid_build.wgsl"),
        pyramid_lights: entry("deferred/pyramid_lights.wgsl"),
        occlusion_trace: entry("deferred/occlusion_trace.wgsl"),
        occlusion_filter: entry("deferred/occlusion_filter.wgsl"),
        difference: entry("deferred/difference.wgsl"),
        models: models.ids().collect(),
        modules,
    })
}
