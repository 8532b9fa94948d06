//! Height queries after a choice: at once for tests, or frame by frame without waiting.

use super::layouts::{READ, UNIFORM, WRITE};
use super::{DetailError, DetailStage};
use crate::gpu::Gpu;
use bytemuck::{bytes_of, cast_slice, pod_collect_to_vec, pod_read_unaligned};
use dolomite_geometry::ring::{Ring, Staging};
use dolomite_ground::detail::layout::DetailParams;
use dolomite_ground::detail::probe::{ANSWER_PASS, AnswerHead, Asked};
use dolomite_ground::render::detail::record::record_answers;
use dolomite_terrain::{GroundPoint, ProbeAnswer};
use std::borrow::Cow;
use std::time::{Duration, Instant};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroup, BindGroupLayout, BindGroupLayoutEntry, BindingType, Buffer, BufferBindingType,
    BufferUsages, CommandEncoder, ComputePipeline, PollType, ShaderStages,
};

/// What was found under places.
#[derive(Clone, Debug, PartialEq)]
pub struct DetailAnswers {
    /// What the pass says of itself.
    pub head: AnswerHead,
    /// One a place; heights are relative to [`AnswerHead::anchor_height`].
    pub answers: Vec<ProbeAnswer>,
}

/// A staging buffer of a [`Ring`].
pub struct Staged(Buffer);

impl Staging for Staged {
    fn bytes(&self) -> u64 {
        self.0.size()
    }

    fn map(&self, bytes: u64, done: Box<dyn FnOnce(bool) + Send>) {
        let slice = self.0.slice(..bytes);
        slice.map_async(wgpu::MapMode::Read, move |mapped| done(mapped.is_ok()));
    }

    fn take(&self, bytes: u64, read: &mut dyn FnMut(&[u8])) {
        read(&self.0.slice(..bytes).get_mapped_range());
        self.0.unmap();
    }
}

/// The pipeline, made when first asked.
pub(super) struct AnswerPass {
    pipeline: ComputePipeline,
    shared: BindGroupLayout,
    own: BindGroupLayout,
}

fn layout(gpu: &Gpu, types: &[(u32, BufferBindingType)]) -> BindGroupLayout {
    let entries: Vec<_> = types
        .iter()
        .map(|&(binding, ty)| BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::COMPUTE,
            ty: BindingType::Buffer {
                ty,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &entries,
    };
    gpu.device().create_bind_group_layout(&descriptor)
}

fn group(gpu: &Gpu, layout: &BindGroupLayout, buffers: &[(u32, &Buffer)]) -> BindGroup {
    let entries: Vec<_> = buffers
        .iter()
        .map(|&(binding, buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &entries,
    })
}

impl AnswerPass {
    fn new(gpu: &Gpu) -> Result<Self, DetailError> {
        let write = [2, 3, 4, 5].map(|binding| (binding, WRITE));
        let shared = layout(gpu, &[&[(0, UNIFORM)], write.as_slice()].concat());
        let own = layout(
            gpu,
            &[(0, READ), (1, READ), (2, UNIFORM), (3, READ), (4, WRITE)],
        );
        let (file, entry) = ANSWER_PASS;
        let device = gpu.device();
        let module = dolomite_shaders::compose(file, &[])?;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(file),
            source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(entry),
            bind_group_layouts: &[Some(&shared), Some(&own)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        });
        Ok(Self {
            pipeline,
            shared,
            own,
        })
    }
}

/// Bytes of the answers to so many places.
const fn answer_bytes(count: usize) -> u64 {
    (size_of::<AnswerHead>() + count * size_of::<ProbeAnswer>()) as u64
}

fn read(bytes: &[u8]) -> DetailAnswers {
    let (head, list) = bytes.split_at(size_of::<AnswerHead>());
    DetailAnswers {
        head: pod_read_unaligned(head),
        answers: pod_collect_to_vec(list),
    }
}

impl DetailStage<'_> {
    fn take_pass(&mut self) -> Result<AnswerPass, DetailError> {
        match self.answers.take() {
            Some(pass) => Ok(pass),
            None => AnswerPass::new(self.gpu),
        }
    }

    /// Records the pass over `places`, after `vertices` were written.
    fn record(
        &self,
        encoder: &mut CommandEncoder,
        pass: &AnswerPass,
        vertices: &Buffer,
        (frame, places): (u32, &[GroundPoint]),
    ) -> Buffer {
        let device = self.gpu.device();
        let filled = |contents: &[u8], usage| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: None,
                contents,
                usage,
            })
        };
        let asked = Asked {
            frame,
            count: places.len() as u32,
            ..Asked::default()
        };
        let asked = filled(bytes_of(&asked), BufferUsages::UNIFORM);
        let given = filled(cast_slice(places), BufferUsages::STORAGE);
        let answers = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: answer_bytes(places.len()),
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let [cells, links, seen, counts, _] = &self.kept;
        let shared = [
            (0, &self.uniform),
            (2, cells),
            (3, links),
            (4, seen),
            (5, counts),
        ];
        let own = [
            (0, &self.corners),
            (1, vertices),
            (2, &asked),
            (3, &given),
            (4, &answers),
        ];
        let mut recorded = encoder.begin_compute_pass(&Default::default());
        let shared = group(self.gpu, &pass.shared, &shared);
        let own = group(self.gpu, &pass.own, &own);
        let count = places.len() as u32;
        record_answers(&mut recorded, &pass.pipeline, [&shared, &own], count);
        drop(recorded);
        answers
    }

    /// What the newest choice draws under `places`, which are not none; and the times from submit to done
    /// of `repeats` runs, the shortest first.
    ///
    /// # Errors
    /// [`DetailError`].
    ///
    /// # Panics
    /// Before the first choice.
    pub fn answer(
        &mut self,
        places: &[GroundPoint],
        repeats: usize,
    ) -> Result<(DetailAnswers, Vec<Duration>), DetailError> {
        let gpu = self.gpu;
        let pass = self.take_pass()?;
        let vertices = self.vertices.clone().expect("something was chosen before");
        let mut times = Vec::new();
        let mut bytes = Vec::new();
        for frame in 0..repeats.max(1) {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            let asked = (frame as u32, places);
            let answers = self.record(&mut encoder, &pass, &vertices, asked);
            let start = Instant::now();
            gpu.queue().submit([encoder.finish()]);
            gpu.finish()?;
            times.push(start.elapsed());
            bytes = gpu.read(&answers)?;
        }
        self.answers = Some(pass);
        times.sort_unstable();
        Ok((read(&bytes), times))
    }

    /// A frame as the renderer makes it: takes what has arrived, chooses, asks, submits, and waits for
    /// nothing. Gives the answers that have arrived, with the frames that they were asked in.
    ///
    /// # Errors
    /// [`DetailError`].
    pub fn frame(
        &mut self,
        params: DetailParams,
        (frame, places): (u32, &[GroundPoint]),
        ring: &mut Ring<Staged, u32>,
    ) -> Result<Vec<(u32, DetailAnswers)>, DetailError> {
        let gpu = self.gpu;
        // Without waiting; a device that is lost fails where it is submitted to.
        let _ = gpu.device().poll(PollType::Poll);
        let arrived = ring.arrived().into_iter();
        let arrived = arrived.map(|(asked, bytes)| (asked, read(&bytes)));
        let arrived = arrived.collect();
        let pass = self.take_pass()?;
        let chosen = self.choose(params);
        let mut encoder = chosen.encoder;
        let bytes = answer_bytes(places.len());
        let make = || {
            Staged(gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: bytes,
                usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }))
        };
        if ring.begin(bytes, frame, make) {
            let answers = self.record(&mut encoder, &pass, &chosen.vertices, (frame, places));
            if let Some((staging, ..)) = ring.begun() {
                encoder.copy_buffer_to_buffer(&answers, 0, &staging.0, 0, Some(bytes));
            }
            ring.copied();
        }
        self.answers = Some(pass);
        gpu.queue().submit([encoder.finish()]);
        ring.map();
        Ok(arrived)
    }
}
