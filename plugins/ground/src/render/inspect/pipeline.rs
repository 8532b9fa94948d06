//! Layouts and pipelines; queued when a camera is first inspected.

use std::num::NonZero;

use bevy::core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntries, BlendComponent, BlendFactor, BlendOperation,
    BlendState, CachedRenderPipelineId, ColorTargetState, ColorWrites, CompareFunction,
    DepthStencilState, Face, FragmentState, FrontFace, PipelineCache, PrimitiveState,
    RenderPipelineDescriptor, ShaderStages, TextureFormat, VertexState,
};
use dolomite_terrain::GpuTerrainUniform;

use crate::detail::layout::all_without;
use crate::inspection::{GroundInspection, InspectionParams};

/// What a pipeline differs by.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct Key {
    pub what: GroundInspection,
    /// What the height function leaves out, where it is read.
    pub without: Vec<&'static str>,
    pub double_sided: bool,
}

#[derive(Resource, Default)]
pub(super) struct Pipelines(HashMap<Key, CachedRenderPipelineId>);

impl Pipelines {
    pub fn get(
        &mut self,
        key: Key,
        shader: &Handle<Shader>,
        cache: &PipelineCache,
    ) -> CachedRenderPipelineId {
        let make = |key: &Key| cache.queue_render_pipeline(descriptor(key, shader));
        match self.0.get(&key) {
            Some(id) => *id,
            None => {
                let id = make(&key);
                self.0.insert(key, id);
                id
            }
        }
    }
}

/// Two floats a pixel; what is added up has to blend, which floats of 32 bits need not.
pub(super) const fn format(what: GroundInspection) -> TextureFormat {
    match what {
        GroundInspection::Level | GroundInspection::Error => TextureFormat::Rg32Float,
        GroundInspection::Overdraw => TextureFormat::Rg16Float,
    }
}

/// The view and its pools.
pub(super) fn view_layout() -> BindGroupLayoutDescriptor {
    let params = NonZero::new(size_of::<InspectionParams>() as u64);
    let read = || storage_buffer_read_only_sized(false, None);
    BindGroupLayoutDescriptor::new(
        "ground_inspection",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::VERTEX_FRAGMENT,
            (uniform_buffer_sized(false, params), read(), read()),
        ),
    )
}

/// What the height function reads.
pub(super) fn heights_layout() -> BindGroupLayoutDescriptor {
    let terrain = NonZero::new(size_of::<GpuTerrainUniform>() as u64);
    let read = || storage_buffer_read_only_sized(false, None);
    BindGroupLayoutDescriptor::new(
        "ground_inspection_heights",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::FRAGMENT,
            (read(), read(), uniform_buffer_sized(false, terrain)),
        ),
    )
}

fn definitions(key: &Key) -> Vec<&'static str> {
    match key.what {
        GroundInspection::Level => vec!["INSPECT_LEVEL"],
        GroundInspection::Error => [vec!["INSPECT_ERROR"], key.without.clone()].concat(),
        GroundInspection::Overdraw => Vec::new(),
    }
}

/// Every set of definitions that a pipeline asks for: for checks that compile them all.
#[doc(hidden)]
#[must_use]
pub fn inspection_variants() -> Vec<Vec<&'static str>> {
    let of = |what, without| {
        definitions(&Key {
            what,
            without,
            double_sided: false,
        })
    };
    let plain = [GroundInspection::Level, GroundInspection::Overdraw];
    let plain = plain.map(|what| of(what, Vec::new()));
    let errors = all_without().into_iter();
    let errors = errors.map(|without| of(GroundInspection::Error, without));
    plain.into_iter().chain(errors).collect()
}

fn descriptor(key: &Key, shader: &Handle<Shader>) -> RenderPipelineDescriptor {
    let mut layout = vec![view_layout()];
    if key.what == GroundInspection::Error {
        layout.push(heights_layout());
    }
    let sum = BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::One,
        operation: BlendOperation::Add,
    };
    let adds = key.what == GroundInspection::Overdraw;
    let defines: Vec<_> = definitions(key).into_iter().map(Into::into).collect();
    RenderPipelineDescriptor {
        label: Some("ground_inspection".into()),
        layout,
        vertex: VertexState {
            shader: shader.clone(),
            shader_defs: defines.clone(),
            entry_point: Some("vertex".into()),
            ..default()
        },
        fragment: Some(FragmentState {
            shader: shader.clone(),
            shader_defs: defines,
            entry_point: Some("fragment".into()),
            targets: vec![Some(ColorTargetState {
                format: format(key.what),
                blend: adds.then_some(BlendState {
                    color: sum,
                    alpha: sum,
                }),
                write_mask: ColorWrites::ALL,
            })],
        }),
        // As the ground is drawn.
        primitive: PrimitiveState {
            front_face: FrontFace::Ccw,
            cull_mode: (!key.double_sided).then_some(Face::Back),
            ..default()
        },
        depth_stencil: Some(DepthStencilState {
            format: CORE_3D_DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(CompareFunction::GreaterEqual),
            stencil: default(),
            bias: default(),
        }),
        ..default()
    }
}
