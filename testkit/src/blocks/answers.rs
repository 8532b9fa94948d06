//! Height queries after a choice: at once for tests, or frame by frame without waiting.

use super::buffers::{group, layout};
use super::{BlockError, BlockStage};
use crate::gpu::Gpu;
use bytemuck::{bytes_of, cast_slice, pod_collect_to_vec, pod_read_unaligned};
use dolomite_geometry::ring::{Ring, Staging};
use dolomite_ground::blocks::layout::ANSWER_PASS;
use dolomite_ground::detail::layout::DetailParams;
use dolomite_ground::detail::probe::{AnswerHead, Asked};
use dolomite_ground::render::blocks::record::record_answers;
use dolomite_terrain::{GroundPoint, ProbeAnswer};
use std::borrow::Cow;
use std::time::{Duration, Instant};
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    BindGroupLayout, Buffer, BufferBindingType, BufferUsages, CommandEncoder, ComputePipeline,
    PollType,
};

/// What was found under places.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockAnswers {
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

/// The pass, and what it binds beside what all passes share.
#[derive(Clone)]
pub(super) struct AnswerPass {
    pipeline: ComputePipeline,
    own: BindGroupLayout,
}

impl AnswerPass {
    fn new(gpu: &Gpu, shared: &BindGroupLayout) -> Result<Self, BlockError> {
        let (file, entry) = ANSWER_PASS;
        let device = gpu.device();
        let own = layout(
            gpu,
            &[
                (2, BufferBindingType::Uniform),
                (3, BufferBindingType::Storage { read_only: true }),
                (4, BufferBindingType::Storage { read_only: false }),
            ],
        );
        let module = dolomite_shaders::compose(file, &[])?;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(file),
            source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(entry),
            bind_group_layouts: &[Some(shared), Some(&own)],
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
        Ok(Self { pipeline, own })
    }
}

/// Bytes of the answers to so many places.
const fn answer_bytes(count: usize) -> u64 {
    (size_of::<AnswerHead>() + count * size_of::<ProbeAnswer>()) as u64
}

fn read(bytes: &[u8]) -> BlockAnswers {
    let (head, list) = bytes.split_at(size_of::<AnswerHead>());
    BlockAnswers {
        head: pod_read_unaligned(head),
        answers: pod_collect_to_vec(list),
    }
}

impl BlockStage<'_> {
    fn answer_pass(&mut self) -> Result<AnswerPass, BlockError> {
        let pass = match &self.answers {
            Some(pass) => pass.clone(),
            None => AnswerPass::new(self.gpu, &self.layouts.shared)?,
        };
        self.answers = Some(pass.clone());
        Ok(pass)
    }

    /// Records the pass over `places`, behind a choice.
    fn ask(
        &self,
        encoder: &mut CommandEncoder,
        pass: &AnswerPass,
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
        let asked_places = filled(cast_slice(places), BufferUsages::STORAGE);
        let answers = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: answer_bytes(places.len()),
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let shared = group(self.gpu, &self.layouts.shared, &self.buffers.shared());
        let own = [(2, &asked), (3, &asked_places), (4, &answers)];
        let own = group(self.gpu, &pass.own, &own);
        let mut recorded = encoder.begin_compute_pass(&Default::default());
        let count = places.len() as u32;
        record_answers(&mut recorded, &pass.pipeline, [&shared, &own], count);
        drop(recorded);
        answers
    }

    /// Asks the last choice for the drawn triangles under places, which are not none.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn answers(&mut self, places: &[GroundPoint]) -> Result<BlockAnswers, BlockError> {
        Ok(self.timed_answers(places, 1)?.0)
    }

    /// The same, with the times from submit to done of `repeats` runs, the shortest first; asked as of frame
    /// [`Self::stamp`].
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn timed_answers(
        &mut self,
        places: &[GroundPoint],
        repeats: usize,
    ) -> Result<(BlockAnswers, Vec<Duration>), BlockError> {
        let gpu = self.gpu;
        let pass = self.answer_pass()?;
        let mut times = Vec::new();
        let mut bytes = Vec::new();
        for _ in 0..repeats.max(1) {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            let answers = self.ask(&mut encoder, &pass, (self.stamp, places));
            let start = Instant::now();
            gpu.queue().submit([encoder.finish()]);
            gpu.finish()?;
            times.push(start.elapsed());
            bytes = gpu.read(&answers)?;
        }
        times.sort_unstable();
        Ok((read(&bytes), times))
    }

    /// A frame as the renderer makes it: takes what has arrived, chooses and makes at most `budget` blocks, asks, submits, and
    /// waits for nothing. Gives the answers that have arrived, with the frames that they were asked in.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn frame(
        &mut self,
        params: DetailParams,
        budget: u32,
        (frame, places): (u32, &[GroundPoint]),
        ring: &mut Ring<Staged, u32>,
    ) -> Result<Vec<(u32, BlockAnswers)>, BlockError> {
        let gpu = self.gpu;
        // Without waiting; a device that is lost fails where it is submitted to.
        let _ = gpu.device().poll(PollType::Poll);
        let arrived = ring.arrived().into_iter();
        let arrived = arrived.map(|(asked, bytes)| (asked, read(&bytes)));
        let arrived = arrived.collect();
        let pass = self.answer_pass()?;
        let mut encoder = self.record(params, budget).encoder;
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
            let answers = self.ask(&mut encoder, &pass, (frame, places));
            if let Some((staging, ..)) = ring.begun() {
                encoder.copy_buffer_to_buffer(&answers, 0, &staging.0, 0, Some(bytes));
            }
            ring.copied();
        }
        gpu.queue().submit([encoder.finish()]);
        ring.map();
        Ok(arrived)
    }
}
