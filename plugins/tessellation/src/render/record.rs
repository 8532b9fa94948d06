//! What is recorded for a tessellation, in wgpu's own types: Bevy's systems, tests and studies all call
//! this.

use crate::Domain;
use crate::layout::{COLUMNS, GRID_DISPATCH_ARGUMENTS, StageParams, VERTEX_DISPATCH_ARGUMENTS};
use crate::passes::{PASSES, pass_count};

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

/// How a pass of the stage is dispatched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StageDispatch {
    /// So many workgroups.
    Groups([u32; 3]),
    /// As many as stand at this byte of the work buffer.
    Indirect(u64),
}

/// How each pass of [`PASSES`] is dispatched, as many as the domain has.
pub fn stage_dispatches(
    params: &StageParams,
    domain: Domain,
) -> impl Iterator<Item = StageDispatch> + use<> {
    let [patches, items, sides] = workgroups(params, domain);
    let all: [StageDispatch; PASSES.len()] = [
        StageDispatch::Groups(in_rows(patches)),
        StageDispatch::Groups(in_rows(items)),
        StageDispatch::Groups(in_rows(1)),
        StageDispatch::Groups(in_rows(items)),
        StageDispatch::Indirect(VERTEX_DISPATCH_ARGUMENTS),
        StageDispatch::Indirect(GRID_DISPATCH_ARGUMENTS),
        StageDispatch::Groups(in_rows(sides)),
    ];
    all.into_iter().take(pass_count(domain))
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
    if let Some(data) = bound.data {
        pass.set_bind_group(1, data, &[]);
    }
    let passes = PASSES.iter().zip(stage_dispatches(params, domain));
    for ((number, pipeline), (stage, dispatch)) in pipelines.iter().enumerate().zip(passes) {
        pass.set_pipeline(pipeline);
        // The passes that emit come last, and bind the same.
        if number == 0 {
            pass.set_bind_group(0, bound.work, &[]);
        } else if stage.emits && !PASSES[number - 1].emits {
            pass.set_bind_group(0, bound.emit, &[]);
        }
        match dispatch {
            StageDispatch::Groups([x, y, z]) => pass.dispatch_workgroups(x, y, z),
            StageDispatch::Indirect(offset) => {
                pass.dispatch_workgroups_indirect(bound.buffer, offset);
            }
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
    let [x, y, z] = in_rows(groups);
    pass.dispatch_workgroups(x, y, z);
}

/// The grid of so many groups, in rows of [`COLUMNS`].
const fn in_rows(groups: u32) -> [u32; 3] {
    let width = if groups < COLUMNS { groups } else { COLUMNS };
    [width, groups.div_ceil(COLUMNS), 1]
}
