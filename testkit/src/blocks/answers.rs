//! Height queries after a choice.

use super::BlockStage;
use super::buffers::{group, layout};
use crate::detail::{DetailAnswers, DetailError};
use bytemuck::{bytes_of, cast_slice, pod_collect_to_vec, pod_read_unaligned};
use dolomite_ground::blocks::layout::ANSWER_PASS;
use dolomite_ground::detail::probe::{AnswerHead, Asked};
use dolomite_ground::render::detail::record::record_answers;
use dolomite_terrain::{GroundPoint, ProbeAnswer};
use std::borrow::Cow;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BufferBindingType, BufferUsages};

impl BlockStage<'_> {
    /// Asks the last choice for the drawn triangles under places.
    ///
    /// # Errors
    /// [`DetailError`].
    pub fn answers(&self, places: &[GroundPoint]) -> Result<DetailAnswers, DetailError> {
        let (gpu, device) = (self.gpu, self.gpu.device());
        let (file, entry) = ANSWER_PASS;
        let own = layout(
            gpu,
            &[
                (2, BufferBindingType::Uniform),
                (3, BufferBindingType::Storage { read_only: true }),
                (4, BufferBindingType::Storage { read_only: false }),
            ],
        );
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(file),
            source: wgpu::ShaderSource::Naga(Cow::Owned(dolomite_shaders::compose(file, &[])?)),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(entry),
            bind_group_layouts: &[Some(&self.layouts.shared), Some(&own)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        });
        let asked = Asked {
            frame: self.stamp,
            count: places.len() as u32,
            ..Asked::default()
        };
        let filled = |contents: &[u8], usage| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: None,
                contents,
                usage,
            })
        };
        let asked = filled(bytes_of(&asked), BufferUsages::UNIFORM);
        let asked_places = filled(cast_slice(places), BufferUsages::STORAGE);
        let answers = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: (size_of::<AnswerHead>() + places.len() * size_of::<ProbeAnswer>()) as u64,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let shared = group(gpu, &self.layouts.shared, &self.buffers.shared());
        let own = group(gpu, &own, &[(2, &asked), (3, &asked_places), (4, &answers)]);
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        record_answers(&mut pass, &pipeline, [&shared, &own], places.len() as u32);
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        gpu.finish()?;
        let bytes = gpu.read(&answers)?;
        let (head, list) = bytes.split_at(size_of::<AnswerHead>());
        Ok(DetailAnswers {
            head: pod_read_unaligned(head),
            answers: pod_collect_to_vec(list),
        })
    }
}
