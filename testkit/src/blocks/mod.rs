//! The passes of the level of detail in blocks without Bevy's renderer, recorded by
//! [`dolomite_ground::render::blocks::record`] as in an app.

mod answers;
mod buffers;
mod edit;
mod records;
mod run;
mod times;

pub use answers::{BlockAnswers, Staged};
pub use edit::RemadeBlocks;
pub use records::MadeBlock;
pub use times::PassTime;

use crate::gpu::{Gpu, GpuError};
use answers::AnswerPass;
use buffers::{Buffers, Layouts};
use bytemuck::pod_collect_to_vec;
use dolomite_ground::blocks::layout::{Beginning, PASSES, Second};
use dolomite_ground::detail::layout::{DetailParams, EditedRect, without};
use dolomite_ground::detail::{DetailGround, DetailLattice};
use dolomite_terrain::{HeightMap, Stream, Terrain};
use std::borrow::Cow;
use std::time::Duration;
use thiserror::Error;
use wgpu::{Buffer, ComputePipeline};

/// Why the passes could not be run.
#[derive(Debug, Error)]
pub enum BlockError {
    /// No adapter, or it refuses a pass.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A shader could not be put together.
    #[error("a shader of the level of detail could not be composed: {0}")]
    Shader(#[from] dolomite_shaders::ComposeError),
}

/// What one choice left.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockRun {
    /// Positions relative to the anchor.
    pub positions: Vec<[f32; 3]>,
    /// Counter-clockwise seen from above; where the choice leaves out what its picture does not show, those that it may
    /// show.
    pub triangles: Vec<[u32; 3]>,
    /// Those that were left out, where they are kept.
    pub others: Vec<[u32; 3]>,
    /// What error ratios were divided by.
    pub coarsening: f32,
    /// The greatest error ratio that the finest blocks leave.
    pub left: f32,
    /// Blocks that there are.
    pub used: u32,
    /// Blocks that would be made if there were time.
    pub wishes: u32,
    /// Blocks that were made.
    pub made: u32,
    /// Blocks that were looked at.
    pub candidates: u32,
    /// Blocks that are drawn.
    pub drawn: u32,
    /// How many vertices appear at the coarsenings 2^(k/2).
    pub curve: [u32; 8],
    /// From the first pass to the last.
    pub time: Duration,
    /// Of each dispatch, where that was asked for and the device tells.
    pub passes: Vec<PassTime>,
}

/// One ground's passes and buffers, for one view.
pub struct BlockStage<'a> {
    gpu: &'a Gpu,
    passes: Vec<ComputePipeline>,
    layouts: Layouts,
    beginning: Beginning,
    buffers: Buffers,
    terrain: Terrain,
    lattice: DetailLattice,
    slots: u32,
    stamp: u32,
    /// Where the ground was edited since the last choice.
    edited: Vec<EditedRect>,
    /// Until when the map has told what was read of it.
    told: u64,
    /// Made when something is asked for the first time.
    answers: Option<AnswerPass>,
    /// Whether passes are timed.
    pub timed: bool,
    /// Most blocks that an edit makes anew, in place of all: what more is reached is dropped.
    pub most_remade: Option<u32>,
}

impl<'a> BlockStage<'a> {
    /// Compiles the passes and makes buffers with room for so many slots.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn new(gpu: &'a Gpu, ground: &DetailGround, slots: u32) -> Result<Self, BlockError> {
        let layouts = Layouts::new(gpu);
        let without = without(ground.terrain());
        let pipelines = PASSES.iter().map(|&(file, entry, second, _)| {
            let defs: &[&str] = if second == Second::Ground {
                &without
            } else {
                &[]
            };
            let module = dolomite_shaders::compose(file, defs)?;
            let device = gpu.device();
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(file),
                source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
            });
            let second = layouts.of(second);
            let groups = [Some(&layouts.shared), second];
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(entry),
                bind_group_layouts: &groups[..1 + usize::from(second.is_some())],
                immediate_size: 0,
            });
            Ok::<_, BlockError>(
                device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(entry),
                    layout: Some(&layout),
                    module: &module,
                    entry_point: Some(entry),
                    // As Bevy's pipelines are by default: the passes write what they read.
                    compilation_options: wgpu::PipelineCompilationOptions {
                        zero_initialize_workgroup_memory: false,
                        ..Default::default()
                    },
                    cache: None,
                }),
            )
        });
        let passes = pipelines.collect::<Result<_, _>>()?;
        let beginning = Beginning::new(&ground.lattice);
        let buffers = Buffers::new(gpu, ground.terrain(), &beginning, slots);
        let stream = ground.terrain().streamed().and_then(HeightMap::stream);
        Ok(Self {
            buffers,
            told: stream.map_or(0, Stream::laid_out),
            gpu,
            passes,
            layouts,
            beginning,
            terrain: ground.terrain().clone(),
            lattice: ground.lattice,
            answers: None,
            slots,
            stamp: 0,
            edited: Vec::new(),
            timed: false,
            most_remade: None,
        })
    }

    /// Chooses until nothing is wished for; the last choice, and how many it took.
    ///
    /// # Errors
    /// [`BlockError`].
    ///
    /// # Panics
    /// After `most` choices.
    pub fn settle(
        &mut self,
        params: DetailParams,
        budget: u32,
        most: usize,
    ) -> Result<(BlockRun, usize), BlockError> {
        for frame in 1..=most {
            let run = self.choose(params, budget, false)?;
            if run.made == 0 && run.wishes == 0 {
                return Ok((self.run(params, budget)?, frame));
            }
        }
        panic!("not settled after {most} choices");
    }

    /// The same where there may be too little room for all that is wished for: blocks that the view does not look at are
    /// dropped then, and where that is not enough the last choice is a coarser one, as [`BlockRun::coarsening`] says.
    ///
    /// # Errors
    /// [`BlockError`].
    ///
    /// # Panics
    /// After `most` choices.
    pub fn settle_in_room(
        &mut self,
        params: DetailParams,
        budget: u32,
        most: usize,
    ) -> Result<(BlockRun, usize), BlockError> {
        let (mut oldest, mut used) = (0, 0);
        for frame in 1..=most {
            let told = DetailParams { oldest, ..params };
            let run = self.choose(told, budget, false)?;
            let is_swept = oldest > 0 && run.used == used;
            if run.made == 0 && (run.wishes == 0 || is_swept) {
                return Ok((self.run(params, budget)?, frame));
            }
            // What this choice looked at stays.
            oldest = if run.made == 0 { self.stamp } else { 0 };
            used = run.used;
        }
        panic!("not settled after {most} choices");
    }

    /// Number of the last choice.
    #[must_use]
    pub const fn stamp(&self) -> u32 {
        self.stamp
    }

    /// Chooses, and makes the mesh; then at most `budget` blocks.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn run(&mut self, params: DetailParams, budget: u32) -> Result<BlockRun, BlockError> {
        self.choose(params, budget, true)
    }

    /// The same without reading the mesh back, which takes longer than the passes: for whoever asks what these take.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn run_unread(
        &mut self,
        params: DetailParams,
        budget: u32,
    ) -> Result<BlockRun, BlockError> {
        self.choose(params, budget, false)
    }
}

fn words(gpu: &Gpu, buffer: &Buffer) -> Result<Vec<u32>, BlockError> {
    Ok(pod_collect_to_vec(&gpu.read(buffer)?))
}
