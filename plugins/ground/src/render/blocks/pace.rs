//! How many blocks a frame makes, by what making takes on this device.
//!
//! The passes that make are timed by the GPU, where it tells; the time comes back frames later with the number of blocks
//! that were made in it. On a device that does not tell, the number is one that holds for slow ones.

use bevy::render::render_resource::{Buffer, BufferDescriptor, BufferUsages, CommandEncoder};
use bevy::render::renderer::RenderDevice;
use dolomite_geometry::render::Mapped;
use dolomite_geometry::ring::Ring;
use wgpu::{ComputePassTimestampWrites, DeviceType, Features, QuerySet, QueryType};

use crate::blocks::layout::MOST_MADE;

/// Milliseconds of a frame for making, on a graphics processor: an eighth of a frame at 120 Hz.
const GPU_MS: f32 = 1.0;
/// The same where the processor draws: a frame takes hundreds of them there.
const CPU_MS: f32 = 250.0;
/// Blocks a frame before anything was measured, and where nothing can be.
const UNMEASURED: u32 = 16;
/// Fewer tell nothing of what one takes.
const LEAST_MEASURED: u32 = 4;
/// Bytes that come back: two times, one count.
const BYTES: u64 = 24;
/// Word of the counts that holds how many blocks were made, as in `blocks/bindings.wgsl`.
const MADE: u64 = 11;

/// Where the GPU writes times.
struct Queries {
    set: QuerySet,
    times: Buffer,
}

/// The pace of making of a kind of ground.
pub(in crate::render) struct Pace {
    queries: Option<Queries>,
    ring: Ring<Mapped, ()>,
    target: f32,
    /// Milliseconds a block.
    each: Option<f32>,
}

impl Pace {
    pub fn new(device: &RenderDevice, kind: DeviceType) -> Self {
        let told = device.features().contains(Features::TIMESTAMP_QUERY);
        let queries = told.then(|| Queries {
            set: device
                .wgpu_device()
                .create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("blocks_times"),
                    ty: QueryType::Timestamp,
                    count: 2,
                }),
            times: device.create_buffer(&BufferDescriptor {
                label: Some("blocks_times"),
                size: 16,
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
        });
        Self {
            queries,
            ring: Ring::default(),
            target: if kind == DeviceType::Cpu {
                CPU_MS
            } else {
                GPU_MS
            },
            each: None,
        }
    }

    /// Blocks that each of so many views makes in a frame.
    pub fn budget(&self, views: u32) -> u32 {
        let all = self.each.map_or(UNMEASURED, |each| {
            ((self.target / each) as u32).min(MOST_MADE)
        });
        all.div_ceil(views.max(1)).max(1)
    }

    /// Begins a measurement, where one can be: what the pass that makes is to write.
    pub fn begin(&mut self, device: &RenderDevice) -> Option<ComputePassTimestampWrites<'_>> {
        let queries = self.queries.as_ref()?;
        let make = || Mapped::new(device, "blocks_times", BYTES);
        self.ring
            .begin(BYTES, (), make)
            .then_some(ComputePassTimestampWrites {
                query_set: &queries.set,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: Some(1),
            })
    }

    /// After the pass of a measurement that was begun.
    pub fn copy(&mut self, encoder: &mut CommandEncoder, counts: &Buffer) {
        if let (Some(queries), Some((staging, ..))) = (&self.queries, self.ring.begun()) {
            encoder.resolve_query_set(&queries.set, 0..2, &queries.times, 0);
            let to = staging.buffer();
            encoder.copy_buffer_to_buffer(&queries.times, 0, to, 0, Some(16));
            encoder.copy_buffer_to_buffer(counts, 4 * MADE, to, 16, Some(8));
        }
        self.ring.copied();
    }

    /// After the submit: takes what has arrived. `period` is that of the GPU's clock, nanoseconds.
    pub fn advance(&mut self, period: f32) {
        let mut arrived = None;
        self.ring.take_arrived(|(), bytes| {
            let words: Vec<u32> = bytemuck::pod_collect_to_vec(bytes);
            let time = |at: usize| u64::from(words[at]) | u64::from(words[at + 1]) << 32;
            // Clocks may be set back.
            let ticks = time(2).checked_sub(time(0));
            arrived = ticks.map(|ticks| (ticks as f32 * period * 1e-6, words[4]));
        });
        self.ring.map();
        if let Some((milliseconds, made)) = arrived {
            self.learn(milliseconds, made);
        }
    }

    fn learn(&mut self, milliseconds: f32, made: u32) {
        let each = milliseconds / made as f32;
        if made < LEAST_MEASURED || !(each.is_finite() && each > 0.0) {
            return;
        }
        self.each = Some(self.each.map_or(each, |known| 0.75 * known + 0.25 * each));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pace() -> Pace {
        Pace {
            queries: None,
            ring: Ring::default(),
            target: 1.0,
            each: None,
        }
    }

    #[test]
    fn a_device_makes_what_fits_into_its_time() {
        let mut pace = pace();
        assert_eq!(pace.budget(1), UNMEASURED);
        for _ in 0..40 {
            pace.learn(0.8, 16);
        }
        assert_eq!(pace.budget(1), 20);
        assert_eq!(pace.budget(3), 7, "all views together");
        // A block that takes longer than the time is made all the same.
        for _ in 0..40 {
            pace.learn(80.0, 16);
        }
        assert_eq!((pace.budget(1), pace.budget(5)), (1, 1));
        for _ in 0..80 {
            pace.learn(0.001, 64);
        }
        assert_eq!(pace.budget(1), MOST_MADE);
    }

    #[test]
    fn times_of_nothing_teach_nothing() {
        let mut pace = pace();
        for (milliseconds, made) in [(5.0, 0), (5.0, 1), (f32::NAN, 16), (0.0, 16), (-1.0, 16)] {
            pace.learn(milliseconds, made);
        }
        assert_eq!(pace.each, None);
    }
}
