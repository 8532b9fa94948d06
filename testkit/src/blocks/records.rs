//! Records, read back.

use super::{BlockError, BlockStage, words};
use bytemuck::pod_collect_to_vec;
use dolomite_ground::blocks::layout::{GpuHead, RECORD_WORDS};
use dolomite_ground::blocks::record::Block;

/// A block that was made, and its slot.
#[derive(Clone, Debug, PartialEq)]
pub struct MadeBlock {
    /// Its slot.
    pub slot: u32,
    /// What was made.
    pub block: Block,
}

fn floats<const N: usize>(words: &mut &[u32]) -> [f32; N] {
    let (first, rest) = words.split_at(N);
    *words = rest;
    std::array::from_fn(|k| f32::from_bits(first[k]))
}

impl BlockStage<'_> {
    /// All blocks that there are.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn blocks(&self) -> Result<Vec<MadeBlock>, BlockError> {
        let heads: Vec<GpuHead> = pod_collect_to_vec(&self.gpu.read(&self.buffers.heads)?);
        let records = words(self.gpu, &self.buffers.records)?;
        let found = (0..).zip(&heads).filter(|(_, head)| head.half != 0);
        Ok(found
            .map(|(slot, head)| {
                let mut words = &records[slot as usize * RECORD_WORDS..];
                let heights = floats(&mut words);
                let gradients: [f32; _] = floats(&mut words);
                let block = Block {
                    head: head.head(),
                    heights,
                    gradients: gradients.map(f32::to_bits),
                    errors: floats(&mut words),
                    lows: floats(&mut words),
                    highs: floats(&mut words),
                    ring_errors: floats(&mut words),
                    cell_lows: floats(&mut words),
                    cell_highs: floats(&mut words),
                };
                MadeBlock { slot, block }
            })
            .collect())
    }
}
