//! The passes of the stage in the order in which they are recorded.

use super::StageRun;
use dolomite_tessellation::layout::{BLOCK, GRID_DISPATCH_ARGUMENTS, VERTEX_DISPATCH_ARGUMENTS};

/// Columns of a dispatch's grid, as in `work.wgsl`.
const COLUMNS: u32 = 32_768;

impl StageRun<'_> {
    /// Records the passes `repeats` times; gives the number of dispatches.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, repeats: u32) -> usize {
        for _ in 0..repeats.max(1) {
            encoder.clear_buffer(&self.work, 0, Some(self.params.cleared_bytes()));
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_bind_group(0, &self.groups[0], &[]);
            if let Some(data) = &self.data {
                pass.set_bind_group(1, data, &[]);
            }
            let items = self.params.items().div_ceil(BLOCK);
            let patches = self.params.patches.div_ceil(64);
            let [control, measure, plan, place, vertices, grid] = &self.passes.passes;
            for (pipeline, groups) in [
                (control, patches),
                (measure, items),
                (plan, 1),
                (place, items),
            ] {
                pass.set_pipeline(pipeline);
                pass.dispatch_workgroups(groups.min(COLUMNS), groups.div_ceil(COLUMNS), 1);
            }
            pass.set_bind_group(0, &self.groups[1], &[]);
            pass.set_pipeline(vertices);
            pass.dispatch_workgroups_indirect(&self.work, VERTEX_DISPATCH_ARGUMENTS);
            pass.set_pipeline(grid);
            pass.dispatch_workgroups_indirect(&self.work, GRID_DISPATCH_ARGUMENTS);
            if let Some(strips) = &self.passes.strips {
                let threads = self.params.strip_threads(self.passes.tessellator.domain);
                let groups = threads.div_ceil(256);
                pass.set_pipeline(strips);
                pass.dispatch_workgroups(groups.min(COLUMNS), groups.div_ceil(COLUMNS), 1);
            }
        }
        (self.passes.passes.len() + usize::from(self.passes.strips.is_some()))
            * repeats.max(1) as usize
    }
}
