//! Layouts and pipelines of a producer's draws; made when a camera first sees something of it.

use std::num::NonZero;

use bevy::camera::CompositingSpace;
use bevy::core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT;
use bevy::core_pipeline::deferred::{DEFERRED_LIGHTING_PASS_ID_FORMAT, DEFERRED_PREPASS_FORMAT};
use bevy::core_pipeline::prepass::{
    MOTION_VECTOR_PREPASS_FORMAT, NORMAL_PREPASS_FORMAT, ViewPrepassTextures,
};
use bevy::mesh::VertexBufferLayout;
use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, texture_2d, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedPipelineState, CachedRenderPipelineId,
    ColorTargetState, ColorWrites, CompareFunction, DepthStencilState, Face, FragmentState,
    FrontFace, PipelineCache, PrimitiveState, RenderPipelineDescriptor, ShaderStages,
    TextureFormat, TextureSampleType, VertexAttribute, VertexFormat, VertexState, VertexStepMode,
};
use bevy::render::view::ViewTarget;
use bevy::shader::{ShaderCacheError, ShaderDefVal};

use super::traits::{DrawShader, DrawTraits};
use super::variants::{Look, Target, shadow_defs};
use crate::layout::{
    EVALUATED_BYTES, GeometryDraw, MATERIAL_ROWS, MaterialRow, PREVIOUS_BYTES, VERTEX_BYTES,
};

/// Of the four words that are kept of a surface, see `shaders/src/geometry/once.wgsl`.
pub const SURFACE_FORMAT: TextureFormat = TextureFormat::Rgba32Uint;

/// Layout of the group by which surfaces are read.
pub fn surfaces_layout() -> BindGroupLayoutDescriptor {
    BindGroupLayoutDescriptor::new(
        "geometry_surfaces",
        &BindGroupLayoutEntries::single(
            ShaderStages::FRAGMENT,
            texture_2d(TextureSampleType::Uint),
        ),
    )
}

/// What the pipeline of a view's draw is specialised by.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DrawKey {
    /// Whether edges are drawn.
    pub lines: bool,
    /// Whether there is a normal prepass.
    pub normals: bool,
    /// Whether there are motion vectors.
    pub motion: bool,
    /// Of a view without G-buffer.
    pub(super) direct: Option<Picture>,
    /// Which of the steps to the G-buffer it is.
    pub(super) step: DrawStep,
}

/// How a draw comes into the G-buffer.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum DrawStep {
    /// At once: its material runs in the draw.
    #[default]
    Whole,
    /// What is kept of its surfaces until they are shaded; see [`DrawTraits::shaded_once`].
    Surfaces,
    /// These are shaded.
    Once,
}

/// What a view without G-buffer draws into.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Picture {
    pub format: TextureFormat,
    /// Whether it holds sRGB numbers that the device takes as they are.
    pub encoded: bool,
}

impl DrawKey {
    /// Where the view's draw goes: into its G-buffer, or into its picture if it has none.
    pub(super) fn new(
        prepass: Option<&ViewPrepassTextures>,
        target: &ViewTarget,
        lines: bool,
    ) -> Self {
        let deferred = prepass.filter(|prepass| prepass.deferred.is_some());
        Self {
            lines,
            normals: deferred.is_some_and(|prepass| prepass.normal.is_some()),
            motion: deferred.is_some_and(|prepass| prepass.motion_vectors.is_some()),
            direct: deferred.is_none().then(|| Picture {
                format: target.main_texture_format(),
                encoded: target.compositing_space == Some(CompositingSpace::Srgb),
            }),
            step: DrawStep::Whole,
        }
    }

    /// The same in a step of its own.
    pub(super) const fn in_step(self, step: DrawStep) -> Self {
        Self { step, ..self }
    }

    /// The steps in which a producer's draw comes into this view.
    pub(super) fn steps(self, traits: &DrawTraits) -> &'static [DrawStep] {
        if traits.shaded_once && self.direct.is_none() && !self.lines {
            &[DrawStep::Surfaces, DrawStep::Once]
        } else {
            &[DrawStep::Whole]
        }
    }
}

/// What of a producer its pipelines depend on.
pub struct Drawn<'a> {
    pub name: &'static str,
    pub shader: &'a DrawShader,
    pub traits: &'a DrawTraits,
}

/// Layouts and pipelines of a producer's draws.
pub struct DrawPipelines {
    inputs_layout: BindGroupLayoutDescriptor,
    data_layout: BindGroupLayoutDescriptor,
    pub draw_layout: BindGroupLayoutDescriptor,
    /// Of draws that fetch vertices by themselves: amplified ones, and those of lines.
    pub fetch_layout: BindGroupLayoutDescriptor,
    /// Group 3 of what is shaded once a pixel: what was kept of surfaces.
    pub surfaces_layout: BindGroupLayoutDescriptor,
    /// Of producers that cast shadows.
    pub shadow: Option<CachedRenderPipelineId>,
    draw: Vec<(DrawKey, CachedRenderPipelineId)>,
}

impl DrawPipelines {
    /// Queues what every view needs.
    pub fn new(
        of: &Drawn,
        inputs_layout: &BindGroupLayoutDescriptor,
        data_layout: &BindGroupLayoutDescriptor,
        cache: &PipelineCache,
    ) -> Self {
        let traits = of.traits;
        let read = || storage_buffer_read_only_sized(false, None);
        let draw = uniform_buffer_sized(true, NonZero::new(size_of::<GeometryDraw>() as u64));
        let rows = (MATERIAL_ROWS * size_of::<MaterialRow>()) as u64;
        let materials = uniform_buffer_sized(false, NonZero::new(rows));
        let both = ShaderStages::VERTEX_FRAGMENT;
        let draw_layout = BindGroupLayoutDescriptor::new(
            "geometry_draw",
            &BindGroupLayoutEntries::sequential(both, (draw, materials)),
        );
        let fetch_layout = if traits.moves {
            BindGroupLayoutDescriptor::new(
                "geometry_fetch",
                &BindGroupLayoutEntries::sequential(
                    both,
                    (draw, materials, read(), read(), read()),
                ),
            )
        } else {
            BindGroupLayoutDescriptor::new(
                "geometry_fetch",
                &BindGroupLayoutEntries::sequential(both, (draw, materials, read(), read())),
            )
        };
        let mut pipelines = Self {
            inputs_layout: inputs_layout.clone(),
            data_layout: data_layout.clone(),
            draw_layout,
            fetch_layout,
            surfaces_layout: surfaces_layout(),
            shadow: None,
            draw: Vec::new(),
        };
        pipelines.shadow = traits
            .shadows
            .then(|| cache.queue_render_pipeline(pipelines.shadow_descriptor(of)));
        pipelines
    }

    fn layouts(&self, fetched: bool) -> Vec<BindGroupLayoutDescriptor> {
        let view = if fetched {
            &self.fetch_layout
        } else {
            &self.draw_layout
        };
        vec![
            self.inputs_layout.clone(),
            self.data_layout.clone(),
            view.clone(),
        ]
    }

    fn shadow_descriptor(&self, of: &Drawn) -> RenderPipelineDescriptor {
        let fetched = of.traits.fetches(false);
        let defs = shadow_defs(&of.shader.defs, of.traits);
        RenderPipelineDescriptor {
            label: Some(format!("geometry_shadow {}", of.name).into()),
            layout: self.layouts(fetched),
            vertex: vertex_state(of, defs, fetched),
            primitive: primitive(of.traits),
            depth_stencil: Some(depth()),
            ..default()
        }
    }

    /// The pipeline of the draw for `key`, queued on first use.
    pub fn draw(
        &mut self,
        of: &Drawn,
        cache: &PipelineCache,
        key: DrawKey,
    ) -> CachedRenderPipelineId {
        if let Some(id) = self.known(key) {
            return id;
        }
        let fetched = of.traits.fetches(key.lines);
        let (normals, motion) = (key.normals, key.motion);
        let look = Look {
            lines: key.lines,
            target: match (key.direct, key.step) {
                (Some(picture), _) => Target::Picture {
                    encoded: picture.encoded,
                },
                (None, DrawStep::Whole) => Target::GBuffer { normals, motion },
                (None, DrawStep::Surfaces) => Target::Surfaces,
                (None, DrawStep::Once) => Target::Once { normals, motion },
            },
        };
        let defs = look.defs(&of.shader.defs, of.traits);
        let label = match look.target {
            Target::Picture { .. } => "geometry_direct",
            Target::GBuffer { .. } => "geometry_gbuffer",
            Target::Surfaces => "geometry_surfaces",
            Target::Once { .. } => "geometry_once",
        };
        let mut layout = self.layouts(fetched);
        let (vertex, primitive, depth) = if key.step == DrawStep::Once {
            layout.push(self.surfaces_layout.clone());
            covering(of, defs.clone())
        } else {
            let vertex = vertex_state(of, defs.clone(), fetched);
            (vertex, primitive(of.traits), depth())
        };
        let id = cache.queue_render_pipeline(RenderPipelineDescriptor {
            label: Some(format!("{label} {}", of.name).into()),
            layout,
            vertex,
            fragment: Some(FragmentState {
                shader: of.shader.handle.clone(),
                shader_defs: defs,
                entry_point: Some("fragment".into()),
                targets: targets(key),
            }),
            primitive,
            depth_stencil: Some(depth),
            ..default()
        });
        self.draw.push((key, id));
        id
    }

    /// The pipeline for `key`, if it was queued.
    pub fn known(&self, key: DrawKey) -> Option<CachedRenderPipelineId> {
        let known = self.draw.iter().find(|(known, _)| *known == key);
        known.map(|(_, id)| *id)
    }

    /// Number of pipelines queued so far.
    pub fn count(&self) -> usize {
        usize::from(self.shadow.is_some()) + self.draw.len()
    }

    /// Why a pipeline could not be made, if one could not.
    pub fn fault(&self, cache: &PipelineCache) -> Option<String> {
        let all = self.draw.iter().map(|(_, id)| id).chain(&self.shadow);
        all.map(|id| cache.get_render_pipeline_state(*id))
            .find_map(pipeline_fault)
    }
}

/// What a draw writes.
fn targets(key: DrawKey) -> Vec<Option<ColorTargetState>> {
    let target = |format: TextureFormat| {
        Some(ColorTargetState {
            format,
            blend: None,
            write_mask: ColorWrites::ALL,
        })
    };
    if let Some(picture) = key.direct {
        return vec![target(picture.format)];
    }
    if key.step == DrawStep::Surfaces {
        return vec![target(SURFACE_FORMAT)];
    }
    vec![
        key.normals.then(|| target(NORMAL_PREPASS_FORMAT)).flatten(),
        key.motion
            .then(|| target(MOTION_VECTOR_PREPASS_FORMAT))
            .flatten(),
        target(DEFERRED_PREPASS_FORMAT),
        target(DEFERRED_LIGHTING_PASS_ID_FORMAT),
    ]
}

/// A triangle over the picture, where something nearer than the far end was drawn.
fn covering(
    of: &Drawn,
    defs: Vec<ShaderDefVal>,
) -> (VertexState, PrimitiveState, DepthStencilState) {
    let vertex = VertexState {
        shader: of.shader.handle.clone(),
        shader_defs: defs,
        entry_point: Some("vertex".into()),
        buffers: Vec::new(),
    };
    let depth = DepthStencilState {
        depth_write_enabled: Some(false),
        depth_compare: Some(CompareFunction::Less),
        ..depth()
    };
    (vertex, PrimitiveState::default(), depth)
}

/// Why a pipeline could not be made; `None` while its files are on their way.
#[must_use]
pub fn pipeline_fault(state: &CachedPipelineState) -> Option<String> {
    match state {
        CachedPipelineState::Err(
            ShaderCacheError::ShaderNotLoaded(_) | ShaderCacheError::ShaderImportNotYetAvailable,
        ) => None,
        CachedPipelineState::Err(fault) => Some(fault.to_string()),
        _ => None,
    }
}

fn primitive(traits: &DrawTraits) -> PrimitiveState {
    use bevy::mesh::PrimitiveTopology::TriangleList;
    PrimitiveState {
        // What is amplified is triangles, whatever of.
        topology: if traits.amplified > 0 {
            TriangleList
        } else {
            traits.topology
        },
        front_face: FrontFace::Ccw,
        // In shadow maps too: light falls on front faces alone, and behind each back face of a closed
        // surface there is one.
        cull_mode: (!traits.double_sided).then_some(Face::Back),
        ..default()
    }
}

/// What the shader does not fetch comes by the vertex buffers.
fn vertex_state(of: &Drawn, defs: Vec<ShaderDefVal>, fetched: bool) -> VertexState {
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
    if fetched {
        // None.
    } else if of.traits.evaluated {
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
        if of.traits.moves {
            let place = vec![attribute(VertexFormat::Float32x3, 0, 3)];
            buffers.push(layout(PREVIOUS_BYTES, place));
        }
    }
    VertexState {
        shader: of.shader.handle.clone(),
        shader_defs: defs,
        entry_point: Some("vertex".into()),
        buffers,
    }
}

fn depth() -> DepthStencilState {
    DepthStencilState {
        format: CORE_3D_DEPTH_FORMAT,
        depth_write_enabled: Some(true),
        depth_compare: Some(CompareFunction::GreaterEqual),
        stencil: default(),
        bias: default(),
    }
}
