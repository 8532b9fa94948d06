//! Ground that is edited between choices.

use super::buffers::data_of;
use super::{BlockError, BlockStage, words};
use dolomite_ground::blocks::changed::{EditReach, edited_lines, join_edited};
use dolomite_ground::blocks::layout::remade_at;
use dolomite_terrain::{GroundRect, Terrain};

/// What an edit came to, blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RemadeBlocks {
    /// Made anew from their samples.
    pub made: u32,
    /// Given anew what they copy from their parents.
    pub refreshed: u32,
    /// Dropped, as there was no room for more, or as their samples have gone.
    pub dropped: u32,
}

impl BlockStage<'_> {
    /// Takes other edits of the ground over, as a store of an app does: the next choice makes anew what they reach. The
    /// definitions of the passes stay: the ground has to have had a layer of edits before.
    ///
    /// # Panics
    /// If it is other ground.
    pub fn edit(&mut self, terrain: &Terrain) {
        let changed = terrain.changed_since(&self.terrain);
        self.edit_within(terrain, &changed.expect("the same ground with other edits"));
    }

    /// The same with rectangles of the caller's.
    pub fn edit_within(&mut self, terrain: &Terrain, changed: &[GroundRect]) {
        let reach = EditReach::between(&self.terrain, terrain, &self.lattice);
        self.edited
            .extend(edited_lines(&self.lattice, reach, changed));
        join_edited(&mut self.edited);
        self.terrain = terrain.clone();
        self.buffers.terrain = data_of(self.gpu, terrain);
    }

    /// What the newest edit came to.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn remade(&self) -> Result<RemadeBlocks, BlockError> {
        let lists = words(self.gpu, &self.buffers.lists)?;
        let at = remade_at(self.slots) as usize;
        Ok(RemadeBlocks {
            made: lists[at],
            dropped: lists[at + 1],
            refreshed: lists[at + 2],
        })
    }
}
