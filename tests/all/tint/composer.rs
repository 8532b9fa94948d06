//! From a shader and its definitions to the WGSL that a browser is given: composed by Bevy's own cache, checked by
//! naga as plain WebGPU would have it, and written out by naga, as wgpu does on the web.

use bevy::asset::AssetId;
use bevy::asset::uuid::Uuid;
use bevy::prelude::*;
use bevy::shader::{
    Shader, ShaderCache, ShaderCacheError, ShaderCacheSource, ShaderDefVal, ValidateShader,
};
use naga::back::wgsl::{WriterFlags, write_string};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Binding, Module, ScalarKind, ShaderStage, Type, TypeInner};
use serde_json::{Value, json};

/// A composed shader.
#[derive(Clone, Debug)]
pub struct Composed {
    pub wgsl: String,
    /// Its entry points, as `compile.mjs` reads them.
    pub entries: Value,
}

/// Composes shaders that import each other.
pub struct Composer(ShaderCache<Composed, ()>);

impl Composer {
    /// `known` are the modules that shaders may import.
    pub fn new(known: impl IntoIterator<Item = Shader>) -> Self {
        let mut composer = Self(ShaderCache::new(
            (),
            wgpu::Features::empty(),
            wgpu::DownlevelFlags::all(),
            load,
        ));
        for shader in known {
            composer.add(shader);
        }
        composer
    }

    /// Adds a shader under a number of its own.
    pub fn add(&mut self, mut shader: Shader) -> AssetId<Shader> {
        // What Bevy sets for all shaders; WebGPU grants eight.
        let buffers = ShaderDefVal::UInt("AVAILABLE_STORAGE_BUFFER_BINDINGS".into(), 8);
        shader.shader_defs.push(buffers);
        let id = AssetId::Uuid {
            uuid: Uuid::new_v4(),
        };
        let _ = self.0.set_shader(id, shader);
        id
    }

    /// # Errors
    /// What naga_oil or naga said.
    pub fn compose(
        &mut self,
        id: AssetId<Shader>,
        defs: &[ShaderDefVal],
    ) -> Result<Composed, String> {
        match self.0.get(0, id, defs) {
            Ok(composed) => Ok((*composed).clone()),
            Err(ShaderCacheError::ProcessShaderError(fault)) => {
                Err(fault.emit_to_string(&self.0.composer))
            }
            Err(fault) => Err(fault.to_string()),
        }
    }
}

fn load(
    (): &(),
    source: ShaderCacheSource,
    _: &ValidateShader,
) -> Result<Composed, ShaderCacheError> {
    let refused = |reason: String| ShaderCacheError::CreateShaderModule(reason);
    let ShaderCacheSource::Naga(module) = source else {
        return Err(refused("this is not WGSL".into()));
    };
    written(&module).map_err(refused)
}

/// A module as a browser is given it.
pub fn written(module: &Module) -> Result<Composed, String> {
    // naga counts `pack2x16float` and its inverse, which plain WebGPU has, as an extra.
    // WebGPU has arrays of cubes, as shadow maps of point lights are, without a feature.
    let granted = Capabilities::SHADER_FLOAT16_IN_FLOAT32 | Capabilities::CUBE_ARRAY_TEXTURES;
    let info = Validator::new(ValidationFlags::all(), granted)
        .validate(module)
        .map_err(|fault| format!("naga: {:?}", fault.into_inner()))?;
    let wgsl =
        write_string(module, &info, WriterFlags::empty()).map_err(|fault| fault.to_string())?;
    Ok(Composed {
        wgsl,
        entries: entries(module),
    })
}

fn entries(module: &Module) -> Value {
    let of = |stage| module.entry_points.iter().filter(move |e| e.stage == stage);
    let compute: Vec<&str> = of(ShaderStage::Compute).map(|e| e.name.as_str()).collect();
    let vertex = of(ShaderStage::Vertex).next().map(|entry| {
        let arguments = entry.function.arguments.iter();
        let located =
            arguments.flat_map(|argument| located(module, argument.ty, argument.binding.as_ref()));
        let inputs: Vec<Value> = located
            .map(|(location, ty)| json!({ "location": location, "format": vertex_format(ty) }))
            .collect();
        json!({ "entry": entry.name, "inputs": inputs })
    });
    let fragment = of(ShaderStage::Fragment).next().map(|entry| {
        let mut targets = Vec::new();
        let result = entry.function.result.iter();
        for (location, ty) in result.flat_map(|r| located(module, r.ty, r.binding.as_ref())) {
            let at = location as usize;
            targets.resize(targets.len().max(at + 1), Value::Null);
            targets[at] = Value::from(target_format(ty));
        }
        json!({ "entry": entry.name, "targets": targets })
    });
    json!({ "compute": compute, "vertex": vertex, "fragment": fragment })
}

/// What of an argument or a result has a location, with its type.
fn located<'a>(
    module: &'a Module,
    ty: naga::Handle<Type>,
    binding: Option<&Binding>,
) -> Vec<(u32, &'a TypeInner)> {
    let inner = &module.types[ty].inner;
    match (binding, inner) {
        (Some(Binding::Location { location, .. }), _) => vec![(*location, inner)],
        (None, TypeInner::Struct { members, .. }) => members
            .iter()
            .flat_map(|member| located(module, member.ty, member.binding.as_ref()))
            .collect(),
        _ => Vec::new(),
    }
}

fn scalar_and_size(ty: &TypeInner) -> (ScalarKind, u8) {
    match ty {
        TypeInner::Scalar(scalar) => (scalar.kind, 1),
        TypeInner::Vector { size, scalar } => (scalar.kind, *size as u8),
        other => panic!("{other:?} cannot have a location"),
    }
}

fn vertex_format(ty: &TypeInner) -> String {
    let (kind, size) = scalar_and_size(ty);
    let kind = match kind {
        ScalarKind::Uint => "uint32",
        ScalarKind::Sint => "sint32",
        _ => "float32",
    };
    match size {
        1 => kind.into(),
        size => format!("{kind}x{size}"),
    }
}

/// Formats of Bevy's G-buffer where the types are those of it: together they fill what WebGPU grants.
fn target_format(ty: &TypeInner) -> &'static str {
    match scalar_and_size(ty) {
        (ScalarKind::Uint, 1) => "r8uint",
        (ScalarKind::Uint, _) => "rgba32uint",
        (ScalarKind::Sint, _) => "rgba32sint",
        (_, 1) => "r16float",
        (_, 2) => "rg16float",
        _ => "rgb10a2unorm",
    }
}
