//! The WGSL files as assets.

use bevy::prelude::*;
use bevy::shader::Shader;

/// Every WGSL file of Dolomite that others import: these handles keep them alive.
#[derive(Resource, Clone)]
pub struct ModuleShaders(#[expect(dead_code, reason = "held, never read")] Vec<Handle<Shader>>);

impl ModuleShaders {
    /// Registers them with the asset system, the first time; `None` in an app without shaders. Call it from
    /// `Plugin::finish`, when Bevy's plugins have been built.
    pub fn load(app: &mut App) -> Option<Self> {
        if let Some(known) = app.world().get_resource::<Self>() {
            return Some(known.clone());
        }
        let mut assets = app.world_mut().get_resource_mut::<Assets<Shader>>()?;
        let modules = dolomite_shaders::ALL
            .iter()
            .filter(|file| file.is_module())
            .map(|file| assets.add(shader_asset(file.source, file.path)))
            .collect();
        let modules = Self(modules);
        app.insert_resource(modules.clone());
        Some(modules)
    }
}

/// A shader asset, validated in debug builds.
pub fn shader_asset(source: impl Into<std::borrow::Cow<'static, str>>, path: &str) -> Shader {
    let mut shader = Shader::from_wgsl(source, path);
    if cfg!(debug_assertions) {
        shader.validate_shader = bevy::shader::ValidateShader::Enabled;
    }
    shader
}
