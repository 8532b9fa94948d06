//! The passes of the stage, recorded as in an app.

use super::StageRun;
use dolomite_tessellation::render::record::{StageBound, clear_work, record_stage};

impl StageRun<'_> {
    /// Records the passes `repeats` times; gives the number of dispatches.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, repeats: u32) -> usize {
        let pipelines: Vec<_> = self.passes.passes.iter().collect();
        let bound = StageBound {
            work: &self.groups[0],
            emit: &self.groups[1],
            data: self.data.as_ref(),
            buffer: &self.work,
        };
        let domain = self.passes.tessellator.domain;
        let mut dispatches = 0;
        for _ in 0..repeats.max(1) {
            clear_work(encoder, &self.work, &self.params);
            let mut pass = encoder.begin_compute_pass(&Default::default());
            dispatches += record_stage(&mut pass, &pipelines, &bound, &self.params, domain);
        }
        dispatches as usize
    }
}
