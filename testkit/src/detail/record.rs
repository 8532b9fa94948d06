//! A choice, recorded as in an app.

use super::layouts::group;
use super::{Chosen, DetailStage, times};
use bytemuck::{bytes_of, cast_slice};
use dolomite_geometry::layout::{HEAD_WORDS, VERTEX_BYTES};
use dolomite_ground::detail::layout::{Beginning, DetailParams, DetailPass, Groups, RECORD_BYTES};
use dolomite_ground::render::detail::record::{DetailBound, Extras, record_step, steps};
use wgpu::{BindGroupLayout, Buffer, BufferUsages};

impl DetailStage<'_> {
    /// Records a choice.
    pub(super) fn choose(&mut self, params: DetailParams) -> Chosen {
        let gpu = self.gpu;
        self.stamp += 1;
        let params = DetailParams {
            stamp: self.stamp,
            capacity: self.capacity,
            ..params
        }
        .edited(&self.edited);
        let queue = gpu.queue();
        queue.write_buffer(&self.uniform, 0, bytes_of(&params));
        let fresh = self.stamp == 1 || std::mem::take(&mut self.remade);
        let counts = self.beginning.counts(fresh);
        queue.write_buffer(&self.kept[3], 0, cast_slice(&counts));
        queue.write_buffer(&self.kept[4], 0, cast_slice(&self.beginning.blocks));
        if fresh {
            let back: Vec<u32> = self.beginning.blocks.iter().rev().copied().collect();
            let at = 4 * (u64::from(self.capacity / 2) - back.len() as u64);
            queue.write_buffer(&self.kept[4], at, cast_slice(&back));
        }
        let arguments = self.beginning.arguments(fresh);
        for buffer in &self.arguments {
            queue.write_buffer(buffer, 0, cast_slice(&arguments));
        }
        queue.write_buffer(&self.closing, 0, cast_slice(&Beginning::CLOSING));
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
        let records = out(RECORD_BYTES * u64::from(params.max_vertices));
        let slot = wgpu::BufferBinding {
            buffer: &self.depths,
            offset: 0,
            size: std::num::NonZero::new(size_of::<DetailPass>() as u64),
        };
        let mut bound = vec![
            self.uniform.as_entire_binding(),
            wgpu::BindingResource::Buffer(slot),
        ];
        bound.extend(self.kept.iter().map(Buffer::as_entire_binding));
        let layouts = &self.layouts;
        let shared = group(gpu, &layouts.shared, &bound);
        let bind = |layout: &BindGroupLayout, buffers: &[&Buffer]| {
            let bound: Vec<_> = buffers
                .iter()
                .map(|buffer| buffer.as_entire_binding())
                .collect();
            group(gpu, layout, &bound)
        };
        let [even, odd] = &self.arguments;
        let (closing, stock) = (&self.closing, &self.stock);
        let to_arguments =
            [odd, even].map(|next| bind(&layouts.arguments, &[next, closing, stock]));
        let to_vertices = bind(&layouts.vertices, &[&self.corners, &vertices, &records]);
        let to_triangles = bind(&layouts.triangles, &[&vertices, &indices]);
        let to_head = bind(&layouts.head, &[&head, closing, stock]);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let [even, odd] = &to_arguments;
        let bound = DetailBound {
            shared: &shared,
            ground: &self.terrain,
            arguments: [even, odd],
            vertices: &to_vertices,
            triangles: &to_triangles,
            head: &to_head,
            capacity: self.capacity,
            indirect: [&self.arguments[0], &self.arguments[1]],
            closing: &self.closing,
        };
        let extras = Extras {
            sweeps: params.needs(Groups::Blocks),
            occluded: params.needs(Groups::Horizon),
        };
        let steps: Vec<_> = steps(params.depth, extras).collect();
        let mut timer = self
            .times
            .take()
            .map(|_| times::Timer::new(gpu, steps.len()));
        let mut one = None;
        if timer.is_none() {
            one = Some(
                encoder
                    .begin_compute_pass(&Default::default())
                    .forget_lifetime(),
            );
        }
        for step in &steps {
            let pipeline = &self.passes[step.pipeline];
            let (_, entry, ..) = step.pass;
            match (&mut timer, &mut one) {
                (Some(timer), _) => {
                    let mut pass = timer.begin(&mut encoder, entry, step.depth);
                    record_step(&mut pass, pipeline, &bound, step);
                }
                (None, Some(pass)) => record_step(pass, pipeline, &bound, step),
                (None, None) => {}
            }
        }
        drop(one);
        if let Some(timer) = timer {
            timer.end(&mut encoder);
            self.times = Some(timer);
        }
        self.vertices = Some(vertices.clone());
        Chosen {
            encoder,
            vertices,
            indices,
            head,
        }
    }
}
