//! What is recorded for a tessellation, in wgpu's own types: Bevy's systems, tests and studies all call
//! this.

use crate::Domain;
use crate::layout::{COLUMNS, GRID_DISPATCH_ARGUMENTS, StageParams, VERTEX_DISPATCH_ARGUMENTS};
use crate::passes::STRIPS;

use super::view::workgroups;

/// What the passes of a tessellation bind.
#[derive(Clone, Copy)]
pub struct StageBound<'a> {
    /// Group 0 of the passes that work on levels and counts.
    pub work: &'a wgpu::BindGroup,
    /// Group 0 of the passes that emit.
    pub emit: &'a wgpu::BindGroup,
    /// Group 1: what the kind's functions read.
    pub data: Option<&'a wgpu::BindGroup>,
    /// The work buffer.
    pub buffer: &'a wgpu::Buffer,
}

/// Sets the part of the work buffer to 0 that passes count in; before [`record_stage`].
pub fn clear_work(encoder: &mut wgpu::CommandEncoder, work: &wgpu::Buffer, params: &StageParams) {
    encoder.clear_buffer(work, 0, Some(params.cleared_bytes()));
}

/// Records control, measure, plan, place and the passes of emission, whose pipelines are in the order of
/// [`PASSES`](crate::passes::PASSES), as many as the domain has. Gives the number of dispatches.
pub fn record_stage(
    pass: &mut wgpu::ComputePass<'_>,
    pipelines: &[&wgpu::ComputePipeline],
    bound: &StageBound<'_>,
    params: &StageParams,
    domain: Domain,
) -> u32 {
    let [patches, items, sides] = workgroups(params, domain);
    if let Some(data) = bound.data {
        pass.set_bind_group(1, data, &[]);
    }
    for (number, pipeline) in pipelines.iter().enumerate() {
        pass.set_pipeline(pipeline);
        match number {
            0 => {
                pass.set_bind_group(0, bound.work, &[]);
                dispatch(pass, patches);
            }
            1 | 3 => dispatch(pass, items),
            2 => dispatch(pass, 1),
            4 => {
                pass.set_bind_group(0, bound.emit, &[]);
                pass.dispatch_workgroups_indirect(bound.buffer, VERTEX_DISPATCH_ARGUMENTS);
            }
            STRIPS => dispatch(pass, sides),
            _ => pass.dispatch_workgroups_indirect(bound.buffer, GRID_DISPATCH_ARGUMENTS),
        }
    }
    pipelines.len() as u32
}

/// Records [`SHADOW_RANGES`](crate::passes::SHADOW_RANGES), which chooses what so many shadow views draw of a kind with
/// bounds: `groups` are its own and the data of the kind's functions, if they read any. One dispatch, a workgroup a
/// view.
pub fn record_shadow_ranges(
    pass: &mut wgpu::ComputePass<'_>,
    pipeline: &wgpu::ComputePipeline,
    groups: (&wgpu::BindGroup, Option<&wgpu::BindGroup>),
    views: u32,
) {
    let (own, data) = groups;
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, own, &[]);
    if let Some(data) = data {
        pass.set_bind_group(1, data, &[]);
    }
    dispatch(pass, views);
}

/// So many groups, in rows of [`COLUMNS`].
fn dispatch(pass: &mut wgpu::ComputePass<'_>, groups: u32) {
    pass.dispatch_workgroups(groups.min(COLUMNS), groups.div_ceil(COLUMNS), 1);
}
