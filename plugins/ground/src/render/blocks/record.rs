//! What is recorded for a choice, in wgpu's own types: Bevy's systems, tests and studies all call this.

use crate::blocks::layout::{
    DROP, Groups, PASSES, REFRESH, SPREAD, Second, done_at, making, slot_groups,
};
use crate::detail::probe::ANSWER_GROUP;

/// What the passes bind and read.
#[derive(Clone, Copy)]
pub struct BlockBound<'a> {
    /// Group 0.
    pub shared: &'a wgpu::BindGroup,
    /// Group 1, by [`Second`].
    pub looked: &'a wgpu::BindGroup,
    /// See [`Second::Arguments`].
    pub arguments: &'a wgpu::BindGroup,
    /// See [`Second::Triangles`].
    pub triangles: &'a wgpu::BindGroup,
    /// See [`Second::Ground`].
    pub ground: &'a wgpu::BindGroup,
    /// See [`Second::Head`].
    pub head: &'a wgpu::BindGroup,
    /// Arguments of the pass that looks.
    pub looked_arguments: &'a wgpu::Buffer,
    /// Arguments of the others.
    pub other_arguments: &'a wgpu::Buffer,
    /// Slots that there are.
    pub slots: u32,
}

impl BlockBound<'_> {
    const fn second(&self, second: Second) -> Option<&wgpu::BindGroup> {
        match second {
            Second::Nothing => None,
            Second::Looked => Some(self.looked),
            Second::Arguments => Some(self.arguments),
            Second::Triangles => Some(self.triangles),
            Second::Ground => Some(self.ground),
            Second::Head => Some(self.head),
        }
    }
}

/// One dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Its place among [`PASSES`].
    pub pass: usize,
    /// Workgroups; of those that are counted on the GPU `None`.
    pub groups: Option<[u32; 3]>,
}

/// What a choice does beside what it always does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// How many roots are made before the first choice of a ground.
    pub roots: Option<u32>,
    /// Blocks that nobody has looked at for long are dropped first.
    pub sweeps: bool,
    /// In how many rounds blocks are made anew before, where the ground was edited.
    pub edits: Option<u32>,
    /// What nearer ground hides is looked for.
    pub occluded: bool,
}

/// The dispatches of a choice.
pub fn steps(extras: Extras) -> impl Iterator<Item = Step> {
    let is_wanted = move |pass: &usize| match PASSES[*pass].3 {
        Groups::Sweep | Groups::Edit | Groups::EditAt(_) => false,
        Groups::Horizon(_) => extras.occluded,
        _ => true,
    };
    let all = (0..PASSES.len()).filter(is_wanted);
    beginning(extras).chain(all.map(counted))
}

const fn counted(pass: usize) -> Step {
    Step { pass, groups: None }
}

/// The dispatches that come before a choice: roots of a new ground are made, blocks are dropped, and others made anew.
pub(super) fn beginning(extras: Extras) -> impl Iterator<Item = Step> {
    let roots = extras.roots.into_iter().flat_map(making);
    let roots = roots.map(|(pass, groups)| Step {
        pass,
        groups: Some(groups),
    });
    let swept = (0..PASSES.len()).filter(|&pass| PASSES[pass].3 == Groups::Sweep);
    let swept = swept.filter(move |_| extras.sweeps).map(counted);
    roots
        .chain(swept)
        .chain(extras.edits.into_iter().flat_map(remaking))
}

/// The dispatches that make anew or refresh what an edit makes another, in so many rounds, and drop what is left then.
fn remaking(rounds: u32) -> impl Iterator<Item = Step> {
    let round = || {
        let [(sample, _), (slope, _), (make, _)] = making(0);
        [SPREAD, REFRESH, sample, slope, make]
    };
    let rounds = (0..rounds).flat_map(move |_| round());
    // The last look finds what the last round leaves to be dropped.
    rounds.chain([SPREAD, DROP]).map(counted)
}

/// Buffers that hold 0 before a choice: arguments of the pass that looks, and counts.
pub fn record_clear(encoder: &mut wgpu::CommandEncoder, buffers: [&wgpu::Buffer; 2]) {
    for buffer in buffers {
        encoder.clear_buffer(buffer, 0, None);
    }
}

/// Lets the next round look at the blocks of so many slots, whatever the last one came to: before the first round of a
/// frame, and before what is drawn is chosen.
pub fn record_look_again(encoder: &mut wgpu::CommandEncoder, lists: &wgpu::Buffer, slots: u32) {
    encoder.clear_buffer(lists, 4 * done_at(slots), Some(4));
}

/// Records a dispatch.
pub fn record_step(
    pass: &mut wgpu::ComputePass<'_>,
    pipeline: &wgpu::ComputePipeline,
    bound: &BlockBound<'_>,
    step: Step,
) {
    let (_, _, second, groups) = PASSES[step.pass];
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, bound.shared, &[]);
    if let Some(second) = bound.second(second) {
        pass.set_bind_group(1, second, &[]);
    }
    match (step.groups, groups) {
        (Some([x, y, z]), _) => pass.dispatch_workgroups(x, y, z),
        (None, Groups::One | Groups::Edit) => pass.dispatch_workgroups(1, 1, 1),
        (None, Groups::Slots | Groups::Sweep) => {
            pass.dispatch_workgroups(slot_groups(bound.slots), 1, 1)
        }
        (None, Groups::Looked) => pass.dispatch_workgroups_indirect(bound.looked_arguments, 0),
        (None, Groups::At(at) | Groups::Horizon(at) | Groups::EditAt(at)) => {
            pass.dispatch_workgroups_indirect(bound.other_arguments, at)
        }
    }
}

/// Records the answers to height queries at `places` places, of the triangles that were chosen before.
/// `shared` is group 0: what a choice is made from; `own` is group 1: what was asked and what is answered.
pub fn record_answers(
    pass: &mut wgpu::ComputePass<'_>,
    pipeline: &wgpu::ComputePipeline,
    [shared, own]: [&wgpu::BindGroup; 2],
    places: u32,
) {
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, shared, &[]);
    pass.set_bind_group(1, own, &[]);
    pass.dispatch_workgroups(places.div_ceil(ANSWER_GROUP), 1, 1);
}
