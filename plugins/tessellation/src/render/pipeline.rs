//! Shaders, bind group layouts and pipelines; made when the first view needs them.

use std::num::NonZero;

use bevy::core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT;
use bevy::core_pipeline::deferred::{DEFERRED_LIGHTING_PASS_ID_FORMAT, DEFERRED_PREPASS_FORMAT};
use bevy::core_pipeline::prepass::{MOTION_VECTOR_PREPASS_FORMAT, NORMAL_PREPASS_FORMAT};
use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{
    sampler, storage_buffer_read_only_sized, storage_buffer_sized, texture_2d, texture_2d_array,
    uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedComputePipelineId,
    CachedRenderPipelineId, ColorTargetState, ColorWrites, CompareFunction,
    ComputePipelineDescriptor, DepthStencilState, Face, FragmentState, FrontFace, PipelineCache,
    PrimitiveState, RenderPipelineDescriptor, SamplerBindingType, ShaderStages, TextureFormat,
    TextureSampleType, VertexState,
};
use bevy::shader::{Shader, ShaderDefVal};

use super::extract::{ExtractedTerrain, ExtractedTerrainView};
use super::layout::DrawParams;
use crate::layout::ViewParams;

/// Handles of the entry shaders; the modules that they import are kept alive beside them.
#[derive(Resource, Clone)]
pub struct Shaders {
    levels: Handle<Shader>,
    plan: Handle<Shader>,
    emit: Handle<Shader>,
    draw: Handle<Shader>,
    _modules: ModuleShaders,
}

/// Every WGSL file that others import: these handles keep them alive.
#[derive(Resource, Clone)]
pub struct ModuleShaders(#[expect(dead_code, reason = "held, never read")] Vec<Handle<Shader>>);

impl ModuleShaders {
    /// Registers them with the asset system, the first time.
    pub fn load(app: &mut App) -> Self {
        if let Some(known) = app.world().get_resource::<Self>() {
            return known.clone();
        }
        let mut assets = app.world_mut().resource_mut::<Assets<Shader>>();
        let modules = dolomite_shaders::ALL
            .iter()
            .filter(|file| file.is_module())
            .map(|file| assets.add(shader(file.source, file.path)))
            .collect();
        let modules = Self(modules);
        app.insert_resource(modules.clone());
        modules
    }
}

/// A shader asset of ours, validated in debug builds.
pub fn shader(source: impl Into<std::borrow::Cow<'static, str>>, path: &str) -> Shader {
    let mut shader = Shader::from_wgsl(source, path);
    if cfg!(debug_assertions) {
        shader.validate_shader = bevy::shader::ValidateShader::Enabled;
    }
    shader
}

/// Registers every WGSL file with the asset system.
pub fn load_shaders(app: &mut App) -> Shaders {
    let modules = ModuleShaders::load(app);
    let mut assets = app.world_mut().resource_mut::<Assets<Shader>>();
    let mut entry = |path: &str| {
        let file = dolomite_shaders::find(path);
        assets.add(shader(file.source, file.path))
    };
    Shaders {
        levels: entry("tessellation/levels.wgsl"),
        plan: entry("tessellation/plan.wgsl"),
        emit: entry("tessellation/emit.wgsl"),
        draw: entry("tessellation/draw.wgsl"),
        _modules: modules,
    }
}

/// What a G-buffer pipeline is specialised by.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct DrawKey {
    pub lines: bool,
    pub normals: bool,
    pub motion: bool,
}

#[derive(Resource)]
pub struct Pipelines {
    pub levels_layout: BindGroupLayoutDescriptor,
    pub plan_layout: BindGroupLayoutDescriptor,
    pub emit_layout: BindGroupLayoutDescriptor,
    pub terrain_layout: BindGroupLayoutDescriptor,
    pub draw_layout: BindGroupLayoutDescriptor,
    pub line_layout: BindGroupLayoutDescriptor,
    pub material_layout: BindGroupLayoutDescriptor,
    pub levels: CachedComputePipelineId,
    pub plan: CachedComputePipelineId,
    pub emit: CachedComputePipelineId,
    pub shadow: CachedRenderPipelineId,
    draw: Vec<(DrawKey, CachedRenderPipelineId)>,
}

/// Makes layouts and the pipelines that every view needs, once a view and a terrain exist.
pub fn create(
    mut commands: Commands,
    cache: Res<PipelineCache>,
    shaders: Res<Shaders>,
    terrain: Res<ExtractedTerrain>,
    views: Query<(), With<ExtractedTerrainView>>,
) {
    if terrain.current.is_none() || views.is_empty() {
        return;
    }
    commands.insert_resource(Pipelines::new(&cache, &shaders));
}

impl Pipelines {
    fn new(cache: &PipelineCache, shaders: &Shaders) -> Self {
        let compute = ShaderStages::COMPUTE;
        let view = || uniform_buffer_sized(false, NonZero::new(size_of::<ViewParams>() as u64));
        let read = || storage_buffer_read_only_sized(false, None);
        let write = || storage_buffer_sized(false, None);
        let levels_layout = BindGroupLayoutDescriptor::new(
            "terrain_levels",
            &BindGroupLayoutEntries::sequential(compute, (view(), read(), write(), write())),
        );
        let plan_layout = BindGroupLayoutDescriptor::new(
            "terrain_plan",
            &BindGroupLayoutEntries::sequential(
                compute,
                (view(), write(), write(), write(), write()),
            ),
        );
        let emit_layout = BindGroupLayoutDescriptor::new(
            "terrain_emit",
            &BindGroupLayoutEntries::sequential(
                compute,
                (view(), read(), read(), read(), write(), write()),
            ),
        );
        let terrain_layout = BindGroupLayoutDescriptor::new(
            "terrain_heights",
            &BindGroupLayoutEntries::sequential(
                compute,
                (read(), read(), uniform_buffer_sized(false, None)),
            ),
        );
        let draw = || uniform_buffer_sized(true, NonZero::new(size_of::<DrawParams>() as u64));
        let draw_layout = BindGroupLayoutDescriptor::new(
            "terrain_draw",
            &BindGroupLayoutEntries::sequential(ShaderStages::VERTEX_FRAGMENT, (draw(), read())),
        );
        let line_layout = BindGroupLayoutDescriptor::new(
            "terrain_lines",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::VERTEX_FRAGMENT,
                (draw(), read(), read()),
            ),
        );
        let array = || texture_2d_array(TextureSampleType::Float { filterable: true });
        let material_layout = BindGroupLayoutDescriptor::new(
            "terrain_material",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::FRAGMENT,
                (
                    array(),
                    array(),
                    sampler(SamplerBindingType::Filtering),
                    texture_2d(TextureSampleType::Float { filterable: true }),
                    sampler(SamplerBindingType::Filtering),
                ),
            ),
        );
        let pass = |name: &'static str, shader: &Handle<Shader>, layout: Vec<_>| {
            cache.queue_compute_pipeline(ComputePipelineDescriptor {
                label: Some(format!("terrain_{name}").into()),
                layout,
                shader: shader.clone(),
                entry_point: Some(name.into()),
                ..default()
            })
        };
        let levels = pass(
            "levels",
            &shaders.levels,
            vec![levels_layout.clone(), terrain_layout.clone()],
        );
        let plan = pass("plan", &shaders.plan, vec![plan_layout.clone()]);
        let emit = pass(
            "emit",
            &shaders.emit,
            vec![emit_layout.clone(), terrain_layout.clone()],
        );
        let shadow = cache.queue_render_pipeline(RenderPipelineDescriptor {
            label: Some("terrain_shadow".into()),
            layout: vec![draw_layout.clone()],
            vertex: VertexState {
                shader: shaders.draw.clone(),
                shader_defs: vec!["SHADOW".into()],
                entry_point: Some("vertex".into()),
                buffers: Vec::new(),
            },
            // Both sides: the sun may stand behind a slope's back.
            primitive: PrimitiveState {
                cull_mode: None,
                ..default()
            },
            depth_stencil: Some(depth(CompareFunction::GreaterEqual)),
            ..default()
        });
        Self {
            levels_layout,
            plan_layout,
            emit_layout,
            terrain_layout,
            draw_layout,
            line_layout,
            material_layout,
            levels,
            plan,
            emit,
            shadow,
            draw: Vec::new(),
        }
    }

    /// The G-buffer pipeline for `key`, queued on first use.
    pub fn draw(
        &mut self,
        cache: &PipelineCache,
        shaders: &Shaders,
        key: DrawKey,
    ) -> CachedRenderPipelineId {
        if let Some((_, id)) = self.draw.iter().find(|(known, _)| *known == key) {
            return *id;
        }
        let mut defs: Vec<ShaderDefVal> = vec!["GBUFFER".into()];
        for (on, name) in [
            (key.lines, "LINE_MODE"),
            (key.normals, "NORMAL_PREPASS"),
            (key.motion, "MOTION_VECTORS"),
        ] {
            if on {
                defs.push(name.into());
            }
        }
        let target = |format: TextureFormat| {
            Some(ColorTargetState {
                format,
                blend: None,
                write_mask: ColorWrites::ALL,
            })
        };
        let view = if key.lines {
            &self.line_layout
        } else {
            &self.draw_layout
        };
        let id = cache.queue_render_pipeline(RenderPipelineDescriptor {
            label: Some("terrain_gbuffer".into()),
            layout: vec![view.clone(), self.material_layout.clone()],
            vertex: VertexState {
                shader: shaders.draw.clone(),
                shader_defs: defs.clone(),
                entry_point: Some("vertex".into()),
                buffers: Vec::new(),
            },
            fragment: Some(FragmentState {
                shader: shaders.draw.clone(),
                shader_defs: defs,
                entry_point: Some("fragment".into()),
                targets: vec![
                    key.normals.then(|| target(NORMAL_PREPASS_FORMAT)).flatten(),
                    key.motion
                        .then(|| target(MOTION_VECTOR_PREPASS_FORMAT))
                        .flatten(),
                    target(DEFERRED_PREPASS_FORMAT),
                    target(DEFERRED_LIGHTING_PASS_ID_FORMAT),
                ],
            }),
            primitive: PrimitiveState {
                front_face: FrontFace::Ccw,
                cull_mode: Some(Face::Back),
                ..default()
            },
            depth_stencil: Some(depth(CompareFunction::GreaterEqual)),
            ..default()
        });
        self.draw.push((key, id));
        id
    }

    /// Number of pipelines queued so far.
    pub fn count(&self) -> usize {
        4 + self.draw.len()
    }
}

pub(super) fn depth(compare: CompareFunction) -> DepthStencilState {
    DepthStencilState {
        format: CORE_3D_DEPTH_FORMAT,
        depth_write_enabled: Some(true),
        depth_compare: Some(compare),
        stencil: default(),
        bias: default(),
    }
}
