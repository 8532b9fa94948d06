//! A capsule's passes by wgpu on this machine's Vulkan adapter, to be timed beside a browser's.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use bevy::tasks::block_on;
use dolomite_testkit::gpu::{Gpu, GpuError};
use wgpu::{
    BindGroup, BindGroupLayout, BindingType, Buffer, BufferBindingType, BufferDescriptor,
    BufferUsages, ComputePipeline, ErrorFilter, ShaderModule, ShaderStages,
};

use super::CapsuleError;
use super::format::{BindingKind, Capsule, Command};

/// Runs that are waited for together, so that waiting counts little; as `ROUND` in `web/src/capsule/play.ts`.
pub const ROUND: u32 = 10;

/// A capsule on an adapter.
pub struct Native<'a> {
    gpu: &'a Gpu,
    capsule: &'a Capsule,
    pipelines: Vec<ComputePipeline>,
    buffers: Vec<Buffer>,
    groups: Vec<BindGroup>,
}

impl<'a> Native<'a> {
    /// Makes everything that it needs.
    ///
    /// # Errors
    /// If it has textures, which only browsers play, or the adapter refuses something.
    pub fn new(gpu: &'a Gpu, capsule: &'a Capsule) -> Result<Self, CapsuleError> {
        let (device, header) = (gpu.device(), &capsule.header);
        if !header.textures.is_empty() {
            let reason = format!("{} has textures: play it in a browser", header.name);
            return Err(CapsuleError::Format(reason));
        }
        let scope = device.push_error_scope(ErrorFilter::Validation);
        let modules: Vec<ShaderModule> = header
            .modules
            .iter()
            .map(|module| {
                let wgsl = String::from_utf8_lossy(capsule.span(module.wgsl));
                device.create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(&module.name),
                    source: wgpu::ShaderSource::Wgsl(Cow::Owned(wgsl.into_owned())),
                })
            })
            .collect();
        let layouts: Vec<BindGroupLayout> = header
            .layouts
            .iter()
            .map(|kinds| layout(device, kinds))
            .collect();
        let pipelines = header
            .pipelines
            .iter()
            .map(|pipeline| {
                let own: Vec<_> = pipeline
                    .layouts
                    .iter()
                    .map(|&layout| Some(&layouts[layout as usize]))
                    .collect();
                let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: None,
                    bind_group_layouts: &own,
                    immediate_size: 0,
                });
                device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(&pipeline.entry),
                    layout: Some(&layout),
                    module: &modules[pipeline.module as usize],
                    entry_point: Some(&pipeline.entry),
                    compilation_options: Default::default(),
                    cache: None,
                })
            })
            .collect();
        let buffers: Vec<Buffer> = header
            .buffers
            .iter()
            .map(|of| {
                let mut bytes = vec![of.fill; of.size.next_multiple_of(4).max(16) as usize];
                if let Some(data) = of.data {
                    let data = capsule.span(data);
                    bytes[..data.len()].copy_from_slice(data);
                }
                let buffer = device.create_buffer(&BufferDescriptor {
                    label: Some(&of.name),
                    size: bytes.len() as u64,
                    usage: BufferUsages::STORAGE
                        | BufferUsages::UNIFORM
                        | BufferUsages::INDIRECT
                        | BufferUsages::COPY_DST
                        | BufferUsages::COPY_SRC,
                    mapped_at_creation: false,
                });
                gpu.queue().write_buffer(&buffer, 0, &bytes);
                buffer
            })
            .collect();
        let groups = header
            .groups
            .iter()
            .map(|group| {
                let entries: Vec<_> = (0..)
                    .zip(&group.buffers)
                    .map(|(binding, &buffer)| wgpu::BindGroupEntry {
                        binding,
                        resource: buffers[buffer as usize].as_entire_binding(),
                    })
                    .collect();
                device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: None,
                    layout: &layouts[group.layout as usize],
                    entries: &entries,
                })
            })
            .collect();
        let made = Self {
            gpu,
            capsule,
            pipelines,
            buffers,
            groups,
        };
        match block_on(scope.pop()) {
            Some(fault) => Err(GpuError::Validation(fault.to_string()).into()),
            None => Ok(made),
        }
    }

    /// Times of all that is recorded before the first comparison: of each of `repeats` rounds the time of one of
    /// [`ROUND`] runs, which are submitted one after the other and then waited for together.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn times(&self, repeats: usize) -> Result<Vec<Duration>, CapsuleError> {
        let once = || {
            let began = Instant::now();
            for _ in 0..ROUND {
                self.submit();
            }
            self.gpu.finish()?;
            Ok(began.elapsed() / ROUND)
        };
        (0..repeats).map(|_| once()).collect()
    }

    /// What a buffer holds now.
    ///
    /// # Errors
    /// If there is none of this name, or it does not come back.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, CapsuleError> {
        let buffers = &self.capsule.header.buffers;
        let at = buffers.iter().position(|of| of.name == name);
        let at = at.ok_or_else(|| CapsuleError::Format(format!("there is no buffer {name}")))?;
        Ok(self.gpu.read(&self.buffers[at])?)
    }

    fn submit(&self) {
        let mut encoder = self
            .gpu
            .device()
            .create_command_encoder(&Default::default());
        for command in &self.capsule.header.commands {
            match command {
                Command::Write {
                    buffer,
                    offset,
                    data,
                } => {
                    let bytes = self.capsule.span(*data);
                    let buffer = &self.buffers[*buffer as usize];
                    self.gpu.queue().write_buffer(buffer, *offset, bytes);
                }
                Command::Clear {
                    buffer,
                    offset,
                    size,
                } => encoder.clear_buffer(&self.buffers[*buffer as usize], *offset, Some(*size)),
                Command::Pass { steps } => {
                    let mut pass = encoder.begin_compute_pass(&Default::default());
                    for step in steps {
                        pass.set_pipeline(&self.pipelines[step.pipeline as usize]);
                        for (number, &group) in (0..).zip(&step.groups) {
                            pass.set_bind_group(number, &self.groups[group as usize], &[]);
                        }
                        match (step.dispatch, step.indirect) {
                            (_, Some(at)) => pass.dispatch_workgroups_indirect(
                                &self.buffers[at.buffer as usize],
                                at.offset,
                            ),
                            (Some([x, y, z]), None) => pass.dispatch_workgroups(x, y, z),
                            (None, None) => {}
                        }
                    }
                }
                _ => break,
            }
        }
        self.gpu.queue().submit([encoder.finish()]);
    }
}

fn layout(device: &wgpu::Device, kinds: &[BindingKind]) -> BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(kinds)
        .map(|(binding, kind)| {
            let ty = match kind {
                BindingKind::Uniform => BufferBindingType::Uniform,
                BindingKind::ReadOnlyStorage => BufferBindingType::Storage { read_only: true },
                // Textures were refused before.
                BindingKind::Storage | BindingKind::DepthTexture => {
                    BufferBindingType::Storage { read_only: false }
                }
            };
            wgpu::BindGroupLayoutEntry {
                binding,
                visibility: ShaderStages::COMPUTE,
                ty: BindingType::Buffer {
                    ty,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &entries,
    })
}
