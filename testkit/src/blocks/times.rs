//! What each dispatch of a choice takes, by the device's timestamps.

use super::BlockError;
use crate::gpu::Gpu;
use bytemuck::pod_collect_to_vec;
use std::time::Duration;
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePass, ComputePassDescriptor,
    ComputePassTimestampWrites, QuerySet, QuerySetDescriptor, QueryType,
};

/// One dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassTime {
    /// Its entry.
    pub entry: &'static str,
    /// From its begin to its end.
    pub time: Duration,
}

/// Timestamps before and after each dispatch.
pub(super) struct Timer {
    set: QuerySet,
    resolved: Buffer,
    passes: Vec<&'static str>,
}

impl Timer {
    pub fn new(gpu: &Gpu, dispatches: usize) -> Self {
        let count = 2 * dispatches as u32;
        Self {
            set: gpu.device().create_query_set(&QuerySetDescriptor {
                label: Some("block_times"),
                ty: QueryType::Timestamp,
                count,
            }),
            resolved: gpu.device().create_buffer(&BufferDescriptor {
                label: Some("block_times"),
                size: 8 * u64::from(count),
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            passes: Vec::new(),
        }
    }

    pub fn begin<'a>(
        &mut self,
        encoder: &'a mut CommandEncoder,
        entry: &'static str,
    ) -> ComputePass<'a> {
        let first = 2 * self.passes.len() as u32;
        self.passes.push(entry);
        encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some(entry),
            timestamp_writes: Some(ComputePassTimestampWrites {
                query_set: &self.set,
                beginning_of_pass_write_index: Some(first),
                end_of_pass_write_index: Some(first + 1),
            }),
        })
    }

    pub fn end(&self, encoder: &mut CommandEncoder) {
        let count = 2 * self.passes.len() as u32;
        encoder.resolve_query_set(&self.set, 0..count, &self.resolved, 0);
    }

    /// What each of them took, after all was submitted.
    pub fn times(&self, gpu: &Gpu) -> Result<Vec<PassTime>, BlockError> {
        let ticks: Vec<u64> = pod_collect_to_vec(&gpu.read(&self.resolved)?);
        let nanoseconds = f64::from(gpu.queue().get_timestamp_period());
        let times = self.passes.iter().zip(ticks.chunks_exact(2));
        Ok(times
            .map(|(&entry, ticks)| {
                let taken = ticks[1].saturating_sub(ticks[0]) as f64 * nanoseconds;
                let time = Duration::from_nanos(taken as u64);
                PassTime { entry, time }
            })
            .collect())
    }
}
