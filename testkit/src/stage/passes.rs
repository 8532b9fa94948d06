//! The compiled passes of a tessellator.

use super::StageError;
use crate::gpu::{Gpu, GpuError};
use dolomite_tessellation::{Domain, Drawing, Mode, Spacing, Tessellator, Winding};
use std::borrow::Cow;
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType,
    BufferBindingType, ComputePipeline, ShaderStages,
};

/// The compiled passes of one tessellator.
pub struct StagePasses {
    pub(super) work_layout: BindGroupLayout,
    pub(super) emit_layout: BindGroupLayout,
    pub(super) data_layout: Option<BindGroupLayout>,
    pub(super) passes: [ComputePipeline; 6],
    /// Not of isolines.
    pub(super) strips: Option<ComputePipeline>,
    pub(crate) tessellator: Tessellator,
    pub(crate) drawing: Drawing,
    split: bool,
}

/// What the passes of a tessellator are compiled for, beside its rules.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageOptions<'a> {
    /// Where vertices are evaluated.
    pub drawing: Drawing,
    /// Whether the patches' sides may be split.
    pub split: bool,
    /// Files in place of those whose paths they have, above all of `stage/user.wgsl`.
    pub functions: &'a [dolomite_shaders::ShaderFile],
    /// Buffers that the functions read, bound in this order at group 1.
    pub data: &'a [BufferBindingType],
}

impl StagePasses {
    /// Compiles the passes of `tessellator`; vertices are stored.
    ///
    /// # Errors
    /// As [`Self::with_drawing`].
    pub fn new(gpu: &Gpu, tessellator: Tessellator) -> Result<Self, StageError> {
        Self::with_drawing(gpu, tessellator, Drawing::Stored)
    }

    /// Compiles the passes of `tessellator`.
    ///
    /// # Errors
    /// If a shader is wrong, or the adapter refuses it.
    pub fn with_drawing(
        gpu: &Gpu,
        tessellator: Tessellator,
        drawing: Drawing,
    ) -> Result<Self, StageError> {
        Self::with_functions(gpu, tessellator, drawing, &[])
    }

    /// As [`Self::with_drawing`], with `functions` in place of the shader files whose paths they
    /// have, above all of `stage/user.wgsl`.
    ///
    /// # Errors
    /// As [`Self::with_drawing`].
    pub fn with_functions(
        gpu: &Gpu,
        tessellator: Tessellator,
        drawing: Drawing,
        functions: &[dolomite_shaders::ShaderFile],
    ) -> Result<Self, StageError> {
        let options = StageOptions {
            drawing,
            functions,
            ..Default::default()
        };
        Self::with_options(gpu, tessellator, &options)
    }

    /// Compiles the passes of `tessellator` for `options`.
    ///
    /// # Errors
    /// If a shader is wrong, or the adapter refuses it.
    pub fn with_options(
        gpu: &Gpu,
        tessellator: Tessellator,
        options: &StageOptions,
    ) -> Result<Self, StageError> {
        let StageOptions {
            drawing,
            split,
            functions,
            data,
        } = *options;
        let scope = gpu.device().push_error_scope(wgpu::ErrorFilter::Validation);
        let layout = |kinds: &[BufferBindingType]| layout(gpu, ShaderStages::COMPUTE, kinds);
        let uniform = BufferBindingType::Uniform;
        let read = BufferBindingType::Storage { read_only: true };
        let write = BufferBindingType::Storage { read_only: false };
        let work_layout = layout(&[uniform, read, read, write]);
        let emit_layout = layout(&[uniform, read, read, read, write, write]);
        let data_layout = (!data.is_empty()).then(|| layout(data));
        let mut defs = defs(&tessellator, drawing);
        if split {
            defs.push("STAGE_SPLIT");
        }
        let pass = |file: &str, entry: &str, layout: &BindGroupLayout, more: &[&'static str]| {
            let defs = [defs.as_slice(), more].concat();
            let module = dolomite_shaders::compose_with(file, &defs, functions)?;
            let module = gpu
                .device()
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(entry),
                    source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
                });
            let layout = gpu
                .device()
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(entry),
                    bind_group_layouts: &[Some(layout), data_layout.as_ref()]
                        [..1 + usize::from(data_layout.is_some())],
                    immediate_size: 0,
                });
            let pipeline = gpu
                .device()
                .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(entry),
                    layout: Some(&layout),
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    cache: None,
                });
            Ok::<_, StageError>(pipeline)
        };
        let emission = |file, entry| pass(file, entry, &emit_layout, &["STAGE_READ"]);
        let passes = [
            pass("stage/control.wgsl", "control_patches", &work_layout, &[])?,
            pass("stage/measure.wgsl", "measure", &work_layout, &[])?,
            pass("stage/plan.wgsl", "plan", &work_layout, &[])?,
            pass("stage/place_items.wgsl", "place_items", &work_layout, &[])?,
            emission("stage/emit_vertices.wgsl", "emit_vertices")?,
            emission("stage/emit_grid.wgsl", "emit_grid")?,
        ];
        let strips = (tessellator.domain != Domain::Isolines)
            .then(|| emission("stage/emit_strips.wgsl", "emit_strips"))
            .transpose()?;
        if let Some(error) = bevy::tasks::block_on(scope.pop()) {
            return Err(GpuError::Validation(error.to_string()).into());
        }
        Ok(Self {
            work_layout,
            emit_layout,
            data_layout,
            passes,
            strips,
            tessellator,
            drawing,
            split,
        })
    }

    /// Shader definitions of its passes and draws.
    pub(crate) fn defs(&self) -> Vec<&'static str> {
        let mut defs = defs(&self.tessellator, self.drawing);
        if self.split {
            defs.push("STAGE_SPLIT");
        }
        defs
    }
}

/// A layout of whole buffers, one after the other.
pub(crate) fn layout(
    gpu: &Gpu,
    visibility: ShaderStages,
    kinds: &[BufferBindingType],
) -> BindGroupLayout {
    let entries: Vec<_> = (0_u32..)
        .zip(kinds)
        .map(|(binding, ty)| BindGroupLayoutEntry {
            binding,
            visibility,
            ty: BindingType::Buffer {
                ty: *ty,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    gpu.device()
        .create_bind_group_layout(&BindGroupLayoutDescriptor {
            label: None,
            entries: &entries,
        })
}

fn defs(tessellator: &Tessellator, drawing: Drawing) -> Vec<&'static str> {
    let mut defs = match tessellator.domain {
        Domain::Triangles => vec![],
        Domain::Quads => vec!["STAGE_QUADS", "STAGE_FOUR_POINTS"],
        Domain::Isolines => vec!["STAGE_ISOLINES", "STAGE_FOUR_POINTS"],
    };
    match tessellator.spacing {
        Spacing::Equal => {}
        Spacing::FractionalEven => defs.push("STAGE_FRACTIONAL_EVEN"),
        Spacing::FractionalOdd => defs.push("STAGE_FRACTIONAL_ODD"),
    }
    if tessellator.mode == Mode::D3d {
        defs.push("STAGE_D3D");
    }
    if tessellator.winding == Winding::Cw {
        defs.push("STAGE_CLOCKWISE");
    }
    if drawing == Drawing::Evaluated {
        defs.push("STAGE_EVALUATED");
    }
    defs
}
