//! What is recorded for a choice and for the height queries after it, in wgpu's own types: Bevy's systems, tests and studies all call this.

use crate::detail::layout::{
    DEPTH_PASSES, Groups, LAST_PASSES, Pass, SWEEP_PASS, Second, arguments_at, sweep_groups,
};

/// Bytes between the slots of a uniform buffer.
pub const SLOT: u64 = 256;

/// One dispatch of a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// The depth that it works on; the last of all for the passes that close a choice.
    pub depth: u32,
    /// Place of its pipeline: `DEPTH_PASSES`, then `LAST_PASSES`, then `SWEEP_PASS`.
    pub pipeline: usize,
    /// Its file, entry, groups and size.
    pub pass: Pass,
}

/// What a choice does beside what it always does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Cells that nobody has looked at for long are dropped first.
    pub sweeps: bool,
    /// What nearer ground hides is looked for.
    pub occluded: bool,
}

/// make, look, keep for each depth; then middles, fit, numbers, vertices, heights, the horizon where it is
/// looked at, triangles, head. Before them the sweep, where there is one.
pub fn steps(depth: u32, extras: Extras) -> impl Iterator<Item = Step> {
    let Extras { sweeps, occluded } = extras;
    let sweep = sweeps.then_some(Step {
        depth: 0,
        pipeline: DEPTH_PASSES.len() + LAST_PASSES.len(),
        pass: SWEEP_PASS,
    });
    let depths = (0..=depth).flat_map(|depth| {
        let passes = DEPTH_PASSES.into_iter().enumerate();
        passes.map(move |(pipeline, pass)| Step {
            depth,
            pipeline,
            pass,
        })
    });
    let last = LAST_PASSES.into_iter().enumerate();
    let last = last.map(move |(number, pass)| Step {
        depth,
        pipeline: DEPTH_PASSES.len() + number,
        pass,
    });
    sweep
        .into_iter()
        .chain(depths)
        .chain(last)
        .filter(move |step| occluded || step.pass.3 != Groups::Horizon)
}

/// What the passes bind.
#[derive(Clone, Copy)]
pub struct DetailBound<'a> {
    /// Group 0, with the slot of a depth as its dynamic offset.
    pub shared: &'a wgpu::BindGroup,
    /// Group 1, by [`Second`]: the ground's data.
    pub ground: &'a wgpu::BindGroup,
    /// Arguments that even depths write, and odd ones; those of the closing passes, and the stock.
    pub arguments: [&'a wgpu::BindGroup; 2],
    /// Corners, vertices, records.
    pub vertices: &'a wgpu::BindGroup,
    /// Vertices, indices.
    pub triangles: &'a wgpu::BindGroup,
    /// The head, arguments of the closing passes, and the stock.
    pub head: &'a wgpu::BindGroup,
    /// Cells that there is room for.
    pub capacity: u32,
    /// Arguments that even depths read, and odd ones.
    pub indirect: [&'a wgpu::Buffer; 2],
    /// Arguments of the closing passes.
    pub closing: &'a wgpu::Buffer,
}

/// Records a step. A dispatch has as many workgroups as those before it found work for.
pub fn record_step(
    pass: &mut wgpu::ComputePass<'_>,
    pipeline: &wgpu::ComputePipeline,
    bound: &DetailBound<'_>,
    step: &Step,
) {
    let (_, _, second, count) = step.pass;
    let turn = (step.depth & 1) as usize;
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, bound.shared, &[step.depth * SLOT as u32]);
    let second = match second {
        Second::Nothing => None,
        Second::Ground => Some(bound.ground),
        Second::Arguments => Some(bound.arguments[turn]),
        Second::Vertices => Some(bound.vertices),
        Second::Triangles => Some(bound.triangles),
        Second::Head => Some(bound.head),
    };
    if let Some(second) = second {
        pass.set_bind_group(1, second, &[]);
    }
    match count {
        Groups::One => pass.dispatch_workgroups(1, 1, 1),
        Groups::Blocks => pass.dispatch_workgroups(sweep_groups(bound.capacity), 1, 1),
        Groups::Kept | Groups::Horizon => pass.dispatch_workgroups_indirect(bound.closing, 0),
        Groups::Make | Groups::Look => {
            let at = arguments_at(step.depth, count);
            pass.dispatch_workgroups_indirect(bound.indirect[turn], at);
        }
    }
}
