//! What is recorded, in wgpu's own types: Bevy's systems and the tests call this.

use super::layout::{
    DIVIDE_ARGUMENTS, DRAW_ARGUMENTS, GROW_AGAIN_ARGUMENTS, GROW_ARGUMENTS, LISTS,
    SHADOW_ARGUMENTS, SHADOW_LISTS,
};

/// Files, entries and second groups of the passes, in their order.
pub const PASSES: [(&str, &str, Second); 6] = [
    ("vegetation/steps.wgsl", "plan", Second::Arguments),
    ("vegetation/divide.wgsl", "divide", Second::Nothing),
    ("vegetation/steps.wgsl", "ready", Second::Arguments),
    ("vegetation/grow.wgsl", "grow", Second::Records),
    ("vegetation/steps.wgsl", "thin", Second::Arguments),
    ("vegetation/steps.wgsl", "finish", Second::Arguments),
];

/// What a pass binds as group 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Second {
    /// Nothing.
    Nothing,
    /// The arguments of dispatches and draws.
    Arguments,
    /// The records.
    Records,
}

/// Dispatches of [`record_passes`].
pub const DISPATCHES: u32 = 7;

/// What the passes bind.
#[derive(Clone, Copy)]
pub struct GrowBound<'a> {
    /// Group 0.
    pub shared: &'a wgpu::BindGroup,
    /// See [`Second::Arguments`].
    pub arguments: &'a wgpu::BindGroup,
    /// See [`Second::Records`].
    pub records: &'a wgpu::BindGroup,
    /// Arguments of dispatches.
    pub indirect: &'a wgpu::Buffer,
}

/// Records all passes, whose pipelines are in the order of [`PASSES`].
pub fn record_passes(
    pass: &mut wgpu::ComputePass<'_>,
    pipelines: [&wgpu::ComputePipeline; PASSES.len()],
    bound: &GrowBound<'_>,
) {
    let [plan, divide, ready, grow, thin, finish] = pipelines;
    pass.set_bind_group(0, bound.shared, &[]);
    let one = |pass: &mut wgpu::ComputePass<'_>, pipeline| {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, bound.arguments, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    };
    let grows = |pass: &mut wgpu::ComputePass<'_>, at| {
        pass.set_pipeline(grow);
        pass.set_bind_group(1, bound.records, &[]);
        pass.dispatch_workgroups_indirect(bound.indirect, at);
    };
    one(pass, plan);
    pass.set_pipeline(divide);
    // What writes the arguments may not be bound where they are read.
    pass.set_bind_group(1, None, &[]);
    pass.dispatch_workgroups_indirect(bound.indirect, DIVIDE_ARGUMENTS);
    one(pass, ready);
    grows(pass, GROW_ARGUMENTS);
    one(pass, thin);
    grows(pass, GROW_AGAIN_ARGUMENTS);
    one(pass, finish);
}

/// Records the draws, one a list that has a pipeline.
pub fn record_draws(
    pass: &mut wgpu::RenderPass<'_>,
    pipelines: [Option<&wgpu::RenderPipeline>; LISTS],
    groups: [&wgpu::BindGroup; LISTS],
    arguments: &wgpu::Buffer,
) {
    for (list, (pipeline, group)) in (0_u64..).zip(pipelines.iter().zip(groups)) {
        let Some(pipeline) = pipeline else { continue };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.draw_indirect(arguments, DRAW_ARGUMENTS + 16 * list);
    }
}

/// Records the draws of the nearest blades into a shadow map whose matrix lies at byte `slot`.
pub fn record_shadows(
    pass: &mut wgpu::RenderPass<'_>,
    pipeline: &wgpu::RenderPipeline,
    groups: [&wgpu::BindGroup; LISTS],
    (shadow, slot): (&wgpu::BindGroup, u32),
    arguments: &wgpu::Buffer,
) {
    pass.set_pipeline(pipeline);
    pass.set_bind_group(1, shadow, &[slot]);
    for (list, group) in (0_u64..).zip(groups).take(SHADOW_LISTS) {
        pass.set_bind_group(0, group, &[]);
        pass.draw_indirect(arguments, SHADOW_ARGUMENTS + 16 * list);
    }
}
