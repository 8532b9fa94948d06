//! The histogram of error ratios on its way back to the budgets of cameras.

use bevy::render::render_resource::{Buffer, CommandEncoder};
use bevy::render::renderer::RenderDevice;
use dolomite_geometry::render::Mapped;
use dolomite_geometry::ring::Ring;

use crate::detail::Metric;
use crate::detail::layout::{BINS, HISTOGRAM, STEPS_AN_OCTAVE};
use crate::detail::work::ErrorCounts;

const BYTES: u64 = 4 * BINS as u64;

/// What a question was asked of: the tolerance, pixels, and the vertices that are always there.
type Asked = (f32, f32);

/// The histograms of a view.
#[derive(Default)]
pub(super) struct Counted {
    ring: Ring<Mapped, Asked>,
}

impl Counted {
    /// Records the copy of a choice's histogram, where a buffer is free.
    pub fn copy(
        &mut self,
        device: &RenderDevice,
        encoder: &mut CommandEncoder,
        counts: &Buffer,
        metric: Metric,
        always: f32,
    ) {
        let (Metric::ErrorBound { pixels } | Metric::EdgeLength { pixels }) = metric else {
            return;
        };
        let make = || Mapped::new(device, "detail_histogram", BYTES);
        if !self.ring.begin(BYTES, (pixels, always), make) {
            return;
        }
        if let Some((staging, bytes, _)) = self.ring.begun() {
            encoder.copy_buffer_to_buffer(
                counts,
                4 * HISTOGRAM as u64,
                staging.buffer(),
                0,
                Some(bytes),
            );
        }
        self.ring.copied();
    }

    /// After the submit: the newest that has arrived.
    pub fn advance(&mut self) -> Option<ErrorCounts> {
        let mut newest = None;
        self.ring.take_arrived(|(tolerance, always), bytes| {
            let halves = bytemuck::pod_collect_to_vec::<u8, u32>(bytes);
            newest = Some(ErrorCounts {
                tolerance,
                always,
                counts: halves.iter().map(|halves| *halves as f32 * 0.5).collect(),
                steps_an_octave: STEPS_AN_OCTAVE,
            });
        });
        self.ring.map();
        newest
    }
}
