//! Shaders, layouts and pipelines of a kind; made when a camera first sees one of its patches.

use std::num::NonZero;

use bevy::core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT;
use bevy::core_pipeline::deferred::{DEFERRED_LIGHTING_PASS_ID_FORMAT, DEFERRED_PREPASS_FORMAT};
use bevy::core_pipeline::prepass::{MOTION_VECTOR_PREPASS_FORMAT, NORMAL_PREPASS_FORMAT};
use bevy::mesh::VertexBufferLayout;
use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedComputePipelineId,
    CachedPipelineState, CachedRenderPipelineId, ColorTargetState, ColorWrites, CompareFunction,
    ComputePipelineDescriptor, DepthStencilState, Face, FragmentState, FrontFace, PipelineCache,
    PrimitiveState, PrimitiveTopology, RenderPipelineDescriptor, ShaderStages, TextureFormat,
    VertexAttribute, VertexFormat, VertexState, VertexStepMode,
};
use bevy::shader::{Shader, ShaderCacheError, ShaderDefVal};

use super::kind::{PatchKind, PatchShader};
use super::library::{ModuleShaders, shader};
use super::prepare::{Kind, KindTraits};
use super::variants::{self, Look, PASSES, RANGES, STRIPS, Target};
use crate::layout::{
    EVALUATED_BYTES, MATERIAL_ROWS, MaterialRow, StageDraw, StageParams, VERTEX_BYTES,
};
use crate::Domain;

/// Entry shaders of a kind, the user's functions named in them.
#[derive(Clone)]
pub struct KindShaders {
    passes: [Handle<Shader>; PASSES.len()],
    strips: Handle<Shader>,
    draw: Handle<Shader>,
    /// Of kinds with a bounds function.
    ranges: Option<Handle<Shader>>,
    /// The user's file, unless the functions stand in a library.
    pub user: Option<Handle<Shader>>,
    _modules: ModuleShaders,
    defs: Vec<ShaderDefVal>,
}

impl KindShaders {
    /// Puts the user's functions into the stage's shaders.
    pub fn new<K: PatchKind>(app: &mut App, name: &str) -> Self {
        let modules = ModuleShaders::load(app);
        let user = match K::shader() {
            PatchShader::File(path) => Some(app.world().resource::<AssetServer>().load(path)),
            PatchShader::Library(_) => None,
        };
        let mut assets = app.world_mut().resource_mut::<Assets<Shader>>();
        let mut entry = |file: &str| {
            let source = variants::source::<K>(file);
            assets.add(shader(source, &format!("{file}#{name}")))
        };
        Self {
            passes: PASSES.map(|(file, ..)| entry(file)),
            strips: entry(STRIPS.0),
            draw: entry(variants::DRAW),
            ranges: K::BOUNDED.then(|| entry(RANGES.0)),
            user,
            _modules: modules,
            defs: variants::kind_defs::<K>(),
        }
    }
}

/// What the pipeline of a view's draw is specialised by.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DrawKey {
    /// Whether edges are drawn.
    pub lines: bool,
    pub normals: bool,
    pub motion: bool,
    /// Of a view without G-buffer.
    pub direct: Option<Picture>,
}

/// What a view without G-buffer draws into.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Picture {
    pub format: TextureFormat,
    /// Whether it holds sRGB numbers that the device takes as they are.
    pub encoded: bool,
}

/// Layouts and pipelines of a kind.
pub struct KindPipelines {
    pub work_layout: BindGroupLayoutDescriptor,
    pub emit_layout: BindGroupLayoutDescriptor,
    /// What the user's functions read, for vertex shaders.
    pub given_layout: BindGroupLayoutDescriptor,
    pub draw_layout: BindGroupLayoutDescriptor,
    /// Of draws that fetch vertices by themselves: amplified ones, and those of lines.
    pub fetch_layout: BindGroupLayoutDescriptor,
    data_layout: BindGroupLayoutDescriptor,
    /// control, measure, plan, place, vertices, grid.
    pub compute: [CachedComputePipelineId; PASSES.len()],
    /// Not of isolines, which have no sides.
    pub strips: Option<CachedComputePipelineId>,
    pub shadow: CachedRenderPipelineId,
    /// Of kinds with a bounds function: what shadow views see.
    pub ranges: Option<(BindGroupLayoutDescriptor, CachedComputePipelineId)>,
    draw: Vec<(DrawKey, CachedRenderPipelineId)>,
    /// Whether a fault was told of.
    pub told: bool,
}

impl KindPipelines {
    /// Queues what every view needs.
    pub fn new(
        kind: &Kind,
        data_layout: &BindGroupLayoutDescriptor,
        cache: &PipelineCache,
    ) -> Self {
        let compute = ShaderStages::COMPUTE;
        let params = || uniform_buffer_sized(false, NonZero::new(size_of::<StageParams>() as u64));
        let read = || storage_buffer_read_only_sized(false, None);
        let write = || storage_buffer_sized(false, None);
        let work_layout = BindGroupLayoutDescriptor::new(
            "stage_work",
            &BindGroupLayoutEntries::sequential(compute, (params(), read(), read(), write())),
        );
        let emit_layout = if kind.traits.moves {
            BindGroupLayoutDescriptor::new(
                "stage_emit",
                &BindGroupLayoutEntries::sequential(
                    compute,
                    (params(), read(), read(), read(), write(), write(), write()),
                ),
            )
        } else {
            BindGroupLayoutDescriptor::new(
                "stage_emit",
                &BindGroupLayoutEntries::sequential(
                    compute,
                    (params(), read(), read(), read(), write(), write()),
                ),
            )
        };
        let given_layout = BindGroupLayoutDescriptor::new(
            "stage_given",
            &BindGroupLayoutEntries::sequential(ShaderStages::VERTEX, (params(), read(), read())),
        );
        let draw = uniform_buffer_sized(true, NonZero::new(size_of::<StageDraw>() as u64));
        let rows = (MATERIAL_ROWS * size_of::<MaterialRow>()) as u64;
        let materials = uniform_buffer_sized(false, NonZero::new(rows));
        let both = ShaderStages::VERTEX_FRAGMENT;
        let draw_layout = BindGroupLayoutDescriptor::new(
            "stage_draw",
            &BindGroupLayoutEntries::sequential(both, (draw, materials)),
        );
        let fetch_layout = if kind.traits.moves {
            BindGroupLayoutDescriptor::new(
                "stage_fetch",
                &BindGroupLayoutEntries::sequential(
                    both,
                    (draw, materials, read(), read(), read()),
                ),
            )
        } else {
            BindGroupLayoutDescriptor::new(
                "stage_fetch",
                &BindGroupLayoutEntries::sequential(both, (draw, materials, read(), read())),
            )
        };
        let shaders = &kind.shaders;
        let pass = |(_, name, reads): (&str, &'static str, bool),
                    shader: &Handle<Shader>,
                    layout: &BindGroupLayoutDescriptor| {
            cache.queue_compute_pipeline(ComputePipelineDescriptor {
                label: Some(format!("stage_{name} {}", kind.name).into()),
                layout: vec![layout.clone(), data_layout.clone()],
                shader: shader.clone(),
                shader_defs: variants::pass_defs(&shaders.defs, reads),
                entry_point: Some(name.into()),
                ..default()
            })
        };
        let compute = std::array::from_fn(|at| {
            let (_, _, reads) = PASSES[at];
            let layout = if reads { &emit_layout } else { &work_layout };
            pass(PASSES[at], &shaders.passes[at], layout)
        });
        let strips = (kind.traits.layout.domain != Domain::Isolines)
            .then(|| pass(STRIPS, &shaders.strips, &emit_layout));
        let ranges = shaders
            .ranges
            .as_ref()
            .filter(|_| kind.traits.bounded)
            .map(|shader| {
                let layout = super::ranges::layout();
                let id = pass(RANGES, shader, &layout);
                (layout, id)
            });
        let shadow_defs = variants::shadow_defs(&shaders.defs, &kind.traits);
        let shadow = cache.queue_render_pipeline(RenderPipelineDescriptor {
            label: Some(format!("stage_shadow {}", kind.name).into()),
            layout: vec![
                given_layout.clone(),
                data_layout.clone(),
                if kind.traits.amplified > 0 {
                    fetch_layout.clone()
                } else {
                    draw_layout.clone()
                },
            ],
            vertex: vertex_state(&kind.shaders, &kind.traits, shadow_defs, false),
            primitive: PrimitiveState {
                topology: topology(&kind.traits),
                // The light falls on front faces alone: behind each back face of a closed surface
                // there is one.
                cull_mode: (!kind.traits.double_sided).then_some(Face::Back),
                ..default()
            },
            depth_stencil: Some(depth(CompareFunction::GreaterEqual)),
            ..default()
        });
        Self {
            work_layout,
            emit_layout,
            given_layout,
            draw_layout,
            fetch_layout,
            data_layout: data_layout.clone(),
            compute,
            strips,
            shadow,
            ranges,
            draw: Vec::new(),
            told: false,
        }
    }

    /// The pipeline of the draw for `key`, queued on first use.
    pub fn draw(
        &mut self,
        kind: &KindView,
        cache: &PipelineCache,
        key: DrawKey,
    ) -> CachedRenderPipelineId {
        if let Some((_, id)) = self.draw.iter().find(|(known, _)| *known == key) {
            return *id;
        }
        let look = Look {
            lines: key.lines,
            target: match key.direct {
                Some(picture) => Target::Picture {
                    encoded: picture.encoded,
                },
                None => Target::GBuffer {
                    normals: key.normals,
                    motion: key.motion,
                },
            },
        };
        let defs = look.defs(&kind.shaders.defs, kind.traits);
        let fetched = fetches(kind.traits, key.lines);
        let target = |format: TextureFormat| {
            Some(ColorTargetState {
                format,
                blend: None,
                write_mask: ColorWrites::ALL,
            })
        };
        let id = cache.queue_render_pipeline(RenderPipelineDescriptor {
            label: Some(
                match key.direct {
                    Some(_) => format!("stage_direct {}", kind.name),
                    None => format!("stage_gbuffer {}", kind.name),
                }
                .into(),
            ),
            layout: vec![
                self.given_layout.clone(),
                self.data_layout.clone(),
                if fetched {
                    self.fetch_layout.clone()
                } else {
                    self.draw_layout.clone()
                },
            ],
            vertex: vertex_state(kind.shaders, kind.traits, defs.clone(), key.lines),
            fragment: Some(FragmentState {
                shader: kind.shaders.draw.clone(),
                shader_defs: defs,
                entry_point: Some("fragment".into()),
                targets: match key.direct {
                    Some(picture) => vec![target(picture.format)],
                    None => vec![
                        key.normals.then(|| target(NORMAL_PREPASS_FORMAT)).flatten(),
                        key.motion
                            .then(|| target(MOTION_VECTOR_PREPASS_FORMAT))
                            .flatten(),
                        target(DEFERRED_PREPASS_FORMAT),
                        target(DEFERRED_LIGHTING_PASS_ID_FORMAT),
                    ],
                },
            }),
            primitive: PrimitiveState {
                topology: topology(kind.traits),
                front_face: FrontFace::Ccw,
                cull_mode: (!kind.traits.double_sided).then_some(Face::Back),
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
        self.queued().count() + 1 + self.draw.len()
    }

    /// Dispatches of a tessellation.
    pub fn dispatches(&self) -> u32 {
        self.compute_ids().count() as u32
    }

    fn compute_ids(&self) -> impl Iterator<Item = &CachedComputePipelineId> {
        self.compute.iter().chain(&self.strips)
    }

    /// All that have to be there before anything is drawn.
    fn queued(&self) -> impl Iterator<Item = &CachedComputePipelineId> {
        self.compute_ids()
            .chain(self.ranges.iter().map(|(_, id)| id))
    }

    /// Why a pipeline could not be made, if one could not.
    pub fn fault(&self, cache: &PipelineCache) -> Option<String> {
        let compute = self
            .queued()
            .map(|id| cache.get_compute_pipeline_state(*id));
        let render = self.draw.iter().map(|(_, id)| id).chain([&self.shadow]);
        compute
            .chain(render.map(|id| cache.get_render_pipeline_state(*id)))
            .find_map(|state| match state {
                // Its files are on their way.
                CachedPipelineState::Err(
                    ShaderCacheError::ShaderNotLoaded(_)
                    | ShaderCacheError::ShaderImportNotYetAvailable,
                ) => None,
                CachedPipelineState::Err(fault) => Some(fault.to_string()),
                _ => None,
            })
    }
}

/// What of a kind its draw pipelines depend on, apart from the pipelines.
pub struct KindView<'a> {
    pub name: &'static str,
    pub shaders: &'a KindShaders,
    pub traits: &'a KindTraits,
}

const fn topology(traits: &KindTraits) -> PrimitiveTopology {
    match traits.layout.domain {
        Domain::Isolines if traits.amplified == 0 => PrimitiveTopology::LineList,
        _ => PrimitiveTopology::TriangleList,
    }
}

/// Whether a draw of the kind fetches its vertices by itself. Segments are lines already.
pub const fn fetches(traits: &KindTraits, lines: bool) -> bool {
    let segments = matches!(traits.layout.domain, Domain::Isolines);
    traits.amplified > 0 || (lines && !segments)
}

/// What the shader does not fetch comes by the vertex buffers.
fn vertex_state(
    shaders: &KindShaders,
    traits: &KindTraits,
    defs: Vec<ShaderDefVal>,
    lines: bool,
) -> VertexState {
    let attribute = |format, offset, shader_location| VertexAttribute {
        format,
        offset,
        shader_location,
    };
    let layout = |stride, attributes| VertexBufferLayout {
        array_stride: stride,
        step_mode: VertexStepMode::Vertex,
        attributes,
    };
    let mut buffers = Vec::new();
    if fetches(traits, lines) {
        // None.
    } else if traits.evaluated {
        buffers.push(layout(
            EVALUATED_BYTES,
            vec![
                attribute(VertexFormat::Uint32, 0, 0),
                attribute(VertexFormat::Uint32x2, 4, 1),
            ],
        ));
    } else {
        buffers.push(layout(
            VERTEX_BYTES,
            vec![
                attribute(VertexFormat::Float32x3, 0, 0),
                attribute(VertexFormat::Uint32, 12, 1),
                attribute(VertexFormat::Snorm16x2, 16, 2),
            ],
        ));
        if traits.moves {
            buffers.push(layout(12, vec![attribute(VertexFormat::Float32x3, 0, 3)]));
        }
    }
    VertexState {
        shader: shaders.draw.clone(),
        shader_defs: defs,
        entry_point: Some("vertex".into()),
        buffers,
    }
}

fn depth(compare: CompareFunction) -> DepthStencilState {
    DepthStencilState {
        format: CORE_3D_DEPTH_FORMAT,
        depth_write_enabled: Some(true),
        depth_compare: Some(compare),
        stencil: default(),
        bias: default(),
    }
}
