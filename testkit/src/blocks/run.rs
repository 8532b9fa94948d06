//! A choice, recorded as in an app.

use super::buffers::group;
use super::times::Timer;
use super::{BlockError, BlockRun, BlockStage, words};
use bytemuck::{bytes_of, cast_slice, pod_read_unaligned};
use dolomite_geometry::layout::{GeometryHead, HEAD_WORDS, VERTEX_BYTES};
use dolomite_ground::blocks::changed::edit_rounds;
use dolomite_ground::blocks::gate::Gate;
use dolomite_ground::blocks::layout::{
    BlockNumbers, HEAD_CANDIDATES, HEAD_COARSENING, HEAD_CURVE, HEAD_DRAWN, HEAD_LEFT, HEAD_MADE,
    HEAD_USED, HEAD_WISHES, PASSES,
};
use dolomite_ground::detail::layout::{DetailParams, OCCLUDED};
use dolomite_ground::render::blocks::record::{
    BlockBound, Extras, record_clear, record_look_again, record_step, steps,
};
use dolomite_terrain::HeightMap;
use std::time::Instant;
use wgpu::{Buffer, BufferUsages, CommandEncoder, Features};

/// A choice that is recorded, and what it is written to.
pub(super) struct Recorded {
    pub encoder: CommandEncoder,
    vertices: Buffer,
    indices: Buffer,
    head: Buffer,
    timer: Option<Timer>,
}

impl BlockStage<'_> {
    pub(super) fn choose(
        &mut self,
        params: DetailParams,
        budget: u32,
        read: bool,
    ) -> Result<BlockRun, BlockError> {
        let gpu = self.gpu;
        let Recorded {
            encoder,
            vertices,
            indices,
            head,
            timer,
        } = self.record(params, budget);
        let start = Instant::now();
        gpu.queue().submit([encoder.finish()]);
        gpu.finish()?;
        let time = start.elapsed();
        let mut run = self.read(&head, read.then_some([&vertices, &indices]))?;
        run.time = time;
        if let Some(timer) = timer {
            run.passes = timer.times(gpu)?;
        }
        Ok(run)
    }

    /// Writes what the passes are told, and records them.
    pub(super) fn record(&mut self, params: DetailParams, budget: u32) -> Recorded {
        let gpu = self.gpu;
        self.stamp += 1;
        let params = DetailParams {
            stamp: self.stamp,
            capacity: self.slots,
            ..params
        }
        .edited(&self.edited);
        let most_remade = self.most_remade.unwrap_or(u32::MAX);
        let mut numbers = BlockNumbers::new(budget).remaking(most_remade);
        let buffers = &self.buffers;
        let queue = gpu.queue();
        let stream = self.terrain.streamed().and_then(HeightMap::stream);
        if let (Some(stream), Some(first)) = (stream, self.terrain.streamed_at()) {
            let news = stream.news(self.told);
            self.told = news.now;
            for write in &news.list {
                let at = 4 * (first + write.at);
                queue.write_buffer(&buffers.terrain[1], at, cast_slice(&write.words));
            }
            if let Some(gate) = Gate::new(&self.terrain, &self.lattice, &news.readable) {
                numbers = numbers.gated(&gate);
            }
        }
        queue.write_buffer(&buffers.params, 0, bytes_of(&params));
        queue.write_buffer(&buffers.numbers, 0, bytes_of(&numbers));
        let out = |bytes: u64| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: bytes,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let vertices = out(VERTEX_BYTES * u64::from(params.max_vertices));
        let indices = out(12 * u64::from(params.max_triangles));
        let head = out(4 * HEAD_WORDS);
        let layouts = &self.layouts;
        let shared = group(gpu, &layouts.shared, &buffers.shared());
        let looked = group(gpu, &layouts.looked, &[(0, &buffers.looked)]);
        let all = [
            (0, &buffers.looked),
            (1, &buffers.arguments),
            (2, &buffers.stock),
        ];
        let arguments = group(gpu, &layouts.arguments, &all);
        let triangles = group(gpu, &layouts.triangles, &[(0, &vertices), (1, &indices)]);
        let [layers, data, uniform] = &buffers.terrain;
        let ground = [(0, layers), (1, data), (2, uniform), (3, &buffers.samples)];
        let ground = group(gpu, &layouts.ground, &ground);
        let to_head = group(gpu, &layouts.head, &[(0, &head), (2, &buffers.stock)]);
        let bound = BlockBound {
            shared: &shared,
            looked: &looked,
            arguments: &arguments,
            triangles: &triangles,
            ground: &ground,
            head: &to_head,
            looked_arguments: &buffers.looked,
            other_arguments: &buffers.arguments,
            slots: self.slots,
        };
        let extras = Extras {
            roots: (self.stamp == 1).then_some(self.beginning.made.len() as u32),
            sweeps: params.oldest > 0,
            edits: (!self.edited.is_empty())
                .then(|| edit_rounds(&self.lattice, self.slots.min(most_remade))),
            occluded: params.flags & OCCLUDED != 0,
        };
        let steps: Vec<_> = steps(extras).collect();
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        record_clear(&mut encoder, [&buffers.looked, &buffers.counts]);
        record_look_again(&mut encoder, &buffers.lists, self.slots);
        let told = gpu.device().features().contains(Features::TIMESTAMP_QUERY);
        let mut timer = (self.timed && told).then(|| Timer::new(gpu, steps.len()));
        if let Some(timer) = &mut timer {
            for &step in &steps {
                let mut pass = timer.begin(&mut encoder, PASSES[step.pass].1);
                record_step(&mut pass, &self.passes[step.pass], &bound, step);
            }
            timer.end(&mut encoder);
        } else {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            for &step in &steps {
                record_step(&mut pass, &self.passes[step.pass], &bound, step);
            }
        }
        self.edited.clear();
        Recorded {
            encoder,
            vertices,
            indices,
            head,
            timer,
        }
    }

    fn read(&self, head: &Buffer, mesh: Option<[&Buffer; 2]>) -> Result<BlockRun, BlockError> {
        let gpu = self.gpu;
        let head: GeometryHead = pod_read_unaligned(&gpu.read(head)?);
        let (vertices, triangles) = (head.vertices as usize, head.primitives as usize);
        let others = head.others.map(|word| word as usize);
        let counted = head;
        let head: [u32; HEAD_WORDS as usize] = bytemuck::cast(head);
        let [points, numbers] = match mesh {
            Some([vertices, indices]) => [words(gpu, vertices)?, words(gpu, indices)?],
            None => [Vec::new(), Vec::new()],
        };
        let listed = |first: usize, count: usize| {
            let triples = numbers.chunks_exact(3).skip(first).take(count);
            triples
                .map(|corners| [corners[0], corners[1], corners[2]])
                .collect()
        };
        assert!(
            counted.wanted_vertices == counted.vertices
                && counted.wanted_primitives == counted.primitives + head_others(&counted),
            "a pool overflowed: {counted:?}"
        );
        Ok(BlockRun {
            positions: points
                .chunks_exact(5)
                .take(vertices)
                .map(|vertex| [vertex[0], vertex[1], vertex[2]].map(f32::from_bits))
                .collect(),
            triangles: listed(0, triangles),
            others: listed(others[2] / 3, others[0] / 3),
            coarsening: f32::from_bits(head[HEAD_COARSENING]),
            left: f32::from_bits(head[HEAD_LEFT]),
            used: head[HEAD_USED],
            wishes: head[HEAD_WISHES],
            made: head[HEAD_MADE],
            candidates: head[HEAD_CANDIDATES],
            drawn: head[HEAD_DRAWN],
            curve: std::array::from_fn(|k| head[HEAD_CURVE + k]),
            time: std::time::Duration::ZERO,
            passes: Vec::new(),
        })
    }
}

const fn head_others(head: &GeometryHead) -> u32 {
    head.others[0] / 3
}
