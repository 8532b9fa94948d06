//! The compiled passes of a tessellator.

use super::StageError;
use crate::gpu::{Gpu, GpuError};
use dolomite_geometry::render::DrawShader;
use dolomite_shaders::ShaderFile;
use dolomite_tessellation::passes::{
    PASSES, PassRules, StagePass, defs, evaluated_source, pass_count,
};
use dolomite_tessellation::{Domain, Drawing, Tessellator};
use std::borrow::Cow;
use std::sync::LazyLock;
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType,
    BufferBindingType, ComputePipeline, ShaderStages,
};

/// The compiled passes of one tessellator.
pub struct StagePasses {
    pub(super) work_layout: BindGroupLayout,
    pub(super) emit_layout: BindGroupLayout,
    pub(super) data_layout: Option<BindGroupLayout>,
    /// In the order of [`PASSES`].
    pub(super) passes: Vec<ComputePipeline>,
    /// Its rules.
    pub tessellator: Tessellator,
    /// Where vertices are evaluated.
    pub drawing: Drawing,
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
    pub functions: &'a [ShaderFile],
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
        functions: &[ShaderFile],
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
        let rules = PassRules {
            evaluated: drawing == Drawing::Evaluated,
            split,
            ..Default::default()
        };
        let defs = defs(&tessellator, rules);
        let pass = |pass: &StagePass| {
            let layout = if pass.emits {
                &emit_layout
            } else {
                &work_layout
            };
            let defs: Vec<_> = defs.iter().copied().chain(pass.def()).collect();
            let module = dolomite_shaders::compose_with(pass.file, &defs, functions)?;
            let module = gpu
                .device()
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(pass.entry),
                    source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
                });
            let layout = gpu
                .device()
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(pass.entry),
                    bind_group_layouts: &[Some(layout), data_layout.as_ref()]
                        [..1 + usize::from(data_layout.is_some())],
                    immediate_size: 0,
                });
            let pipeline = gpu
                .device()
                .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(pass.entry),
                    layout: Some(&layout),
                    module: &module,
                    entry_point: Some(pass.entry),
                    compilation_options: Default::default(),
                    cache: None,
                });
            Ok::<_, StageError>(pipeline)
        };
        let passes = PASSES[..pass_count(tessellator.domain)]
            .iter()
            .map(pass)
            .collect::<Result<Vec<_>, _>>()?;
        if let Some(error) = bevy::tasks::block_on(scope.pop()) {
            return Err(GpuError::Validation(error.to_string()).into());
        }
        Ok(Self {
            work_layout,
            emit_layout,
            data_layout,
            passes,
            tessellator,
            drawing,
            split,
        })
    }

    /// `geometry/draw.wgsl` for what the passes emit, with more definitions and with `functions` in place of
    /// the files whose paths they have.
    ///
    /// # Errors
    /// If the shader is wrong.
    pub fn draw_module(
        &self,
        more: &[&'static str],
        functions: &[ShaderFile],
    ) -> Result<naga::Module, StageError> {
        static EVALUATED: LazyLock<String> =
            LazyLock::new(|| DrawShader::source(None, None, Some(&evaluated_source(None))));
        let mut defs = self.defs();
        let mut functions = functions.to_vec();
        if self.drawing == Drawing::Evaluated {
            defs.push("GEOMETRY_EVALUATED");
            functions.push(ShaderFile {
                path: "geometry/draw.wgsl",
                source: EVALUATED.as_str(),
            });
        }
        if self.tessellator.domain == Domain::Isolines {
            defs.push("GEOMETRY_SEGMENTS");
        }
        defs.extend(more);
        let module = dolomite_shaders::compose_with("geometry/draw.wgsl", &defs, &functions)?;
        Ok(module)
    }

    /// Shader definitions of its passes.
    fn defs(&self) -> Vec<&'static str> {
        let rules = PassRules {
            evaluated: self.drawing == Drawing::Evaluated,
            split: self.split,
            ..Default::default()
        };
        defs(&self.tessellator, rules)
    }
}

/// A layout of whole buffers, one after the other.
pub fn layout(gpu: &Gpu, visibility: ShaderStages, kinds: &[BufferBindingType]) -> BindGroupLayout {
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
