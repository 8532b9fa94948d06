//! The passes of the level of detail in blocks without Bevy's renderer, recorded by
//! [`dolomite_ground::render::blocks::record`] as in an app.

mod answers;
mod buffers;
mod edit;
mod records;
mod run;

pub use edit::RemadeBlocks;
pub use records::MadeBlock;

use crate::detail::{DetailError, PassTime};
use crate::gpu::Gpu;
use buffers::{Buffers, Layouts};
use bytemuck::pod_collect_to_vec;
use dolomite_ground::blocks::layout::{Beginning, PASSES, Second};
use dolomite_ground::detail::layout::{DetailParams, EditedRect, without};
use dolomite_ground::detail::{DetailCells, DetailLattice};
use dolomite_terrain::{HeightMap, Stream, Terrain};
use std::borrow::Cow;
use std::time::Duration;
use wgpu::{Buffer, ComputePipeline};

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
    /// Whether passes are timed.
    pub timed: bool,
    /// Most blocks that an edit makes anew, in place of all: what more is reached is dropped.
    pub most_remade: Option<u32>,
}

impl<'a> BlockStage<'a> {
    /// Compiles the passes and makes buffers with room for so many slots.
    ///
    /// # Errors
    /// [`DetailError`].
    pub fn new(gpu: &'a Gpu, cells: &DetailCells, slots: u32) -> Result<Self, DetailError> {
        let layouts = Layouts::new(gpu);
        let without = without(cells.terrain());
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
            Ok::<_, DetailError>(
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
        let beginning = Beginning::new(&cells.lattice);
        let buffers = Buffers::new(gpu, cells.terrain(), &beginning, slots);
        let stream = cells.terrain().streamed().and_then(HeightMap::stream);
        Ok(Self {
            buffers,
            told: stream.map_or(0, Stream::laid_out),
            gpu,
            passes,
            layouts,
            beginning,
            terrain: cells.terrain().clone(),
            lattice: cells.lattice,
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
    /// [`DetailError`].
    ///
    /// # Panics
    /// After `most` choices.
    pub fn settle(
        &mut self,
        params: DetailParams,
        budget: u32,
        most: usize,
    ) -> Result<(BlockRun, usize), DetailError> {
        for frame in 1..=most {
            let run = self.choose(params, budget, false)?;
            if run.made == 0 && run.wishes == 0 {
                return Ok((self.run(params, budget)?, frame));
            }
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
    /// [`DetailError`].
    pub fn run(&mut self, params: DetailParams, budget: u32) -> Result<BlockRun, DetailError> {
        self.choose(params, budget, true)
    }

    /// The same without reading the mesh back, which takes longer than the passes: for whoever asks what these take.
    ///
    /// # Errors
    /// [`DetailError`].
    pub fn run_unread(
        &mut self,
        params: DetailParams,
        budget: u32,
    ) -> Result<BlockRun, DetailError> {
        self.choose(params, budget, false)
    }
}

fn words(gpu: &Gpu, buffer: &Buffer) -> Result<Vec<u32>, DetailError> {
    Ok(pod_collect_to_vec(&gpu.read(buffer)?))
}
