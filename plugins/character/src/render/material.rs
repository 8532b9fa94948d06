//! The material of a crowd: Bevy's standard one, with our vertex shader.

use bevy::app::App;
use bevy::asset::{Asset, Assets, Handle, uuid_handle};
use bevy::math::Vec3;
use bevy::mesh::{Mesh, MeshVertexAttribute, MeshVertexBufferLayoutRef};
use bevy::pbr::{
    ExtendedMaterial, MaterialExtension, MaterialExtensionKey, MaterialExtensionPipeline,
    StandardMaterial,
};
use bevy::reflect::TypePath;
use bevy::render::render_resource::{
    AsBindGroup, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError, VertexFormat,
};
use bevy::render::storage::ShaderBuffer;
use bevy::shader::{Shader, ShaderRef};
use dolomite_shaders::ShaderFile;

/// Bevy's standard material on a crowd.
pub type CrowdMaterial = ExtendedMaterial<StandardMaterial, CrowdExtension>;

/// What the vertex shader reads besides.
#[derive(Asset, AsBindGroup, TypePath, Clone, Debug)]
pub struct CrowdExtension {
    /// Rows of the palette.
    #[storage(100, read_only, visibility(vertex))]
    pub palette: Handle<ShaderBuffer>,
    /// Figures, 16 bytes each.
    #[storage(101, read_only, visibility(vertex))]
    pub figures: Handle<ShaderBuffer>,
    /// What all figures share.
    #[uniform(102, visibility(vertex))]
    pub crowd: CrowdUniform,
}

/// `Crowd` in `character/types.wgsl`.
#[derive(ShaderType, Clone, Copy, Debug, Default, PartialEq)]
pub struct CrowdUniform {
    /// World coordinates that figures are placed from, metres.
    pub anchor: Vec3,
    /// Joints of a frame of the palette.
    pub joints: u32,
}

/// Joint numbers of a vertex. Not Bevy's attribute, which would make the mesh a skinned one of Bevy's.
pub(super) const JOINTS: MeshVertexAttribute =
    MeshVertexAttribute::new("CrowdJoints", 0x0d01_0417_c0c0_0001, VertexFormat::Uint16x4);
/// Their weights.
pub(super) const WEIGHTS: MeshVertexAttribute = MeshVertexAttribute::new(
    "CrowdWeights",
    0x0d01_0417_c0c0_0002,
    VertexFormat::Float32x4,
);

const DRAW: Handle<Shader> = uuid_handle!("6f0f7d34-5a3d-4c6c-9b77-6d1f0c9a2b51");

/// Makes the shaders known, the first time.
pub(super) fn load_shaders(app: &mut App) {
    let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
    let ours = dolomite_shaders::ALL
        .iter()
        .filter(|file| file.path.starts_with("character/"));
    let mut modules = Vec::new();
    for file in ours {
        if file.is_module() {
            modules.push(shaders.add(shader(file)));
        } else if file.path == "character/draw.wgsl"
            && let Err(refusal) = shaders.insert(&DRAW, shader(file))
        {
            bevy::log::error!("{}: {refusal}", file.path);
        }
    }
    app.insert_resource(Modules(modules));
}

/// Keeps imported files alive.
#[derive(bevy::ecs::prelude::Resource)]
struct Modules(#[expect(dead_code, reason = "held, never read")] Vec<Handle<Shader>>);

fn shader(file: &ShaderFile) -> Shader {
    let mut shader = Shader::from_wgsl(file.source, file.path);
    if cfg!(debug_assertions) {
        shader.validate_shader = bevy::shader::ValidateShader::Enabled;
    }
    shader
}

impl MaterialExtension for CrowdExtension {
    fn vertex_shader() -> ShaderRef {
        DRAW.into()
    }

    fn prepass_vertex_shader() -> ShaderRef {
        DRAW.into()
    }

    fn deferred_vertex_shader() -> ShaderRef {
        DRAW.into()
    }

    fn specialize(
        _: &MaterialExtensionPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        _: MaterialExtensionKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        descriptor.vertex.shader_defs.push("CROWD_MATERIAL".into());
        descriptor.vertex.buffers = vec![layout.0.get_layout(&[
            Mesh::ATTRIBUTE_POSITION.at_shader_location(0),
            Mesh::ATTRIBUTE_NORMAL.at_shader_location(1),
            Mesh::ATTRIBUTE_UV_0.at_shader_location(2),
            JOINTS.at_shader_location(3),
            WEIGHTS.at_shader_location(4),
        ])?];
        Ok(())
    }
}
