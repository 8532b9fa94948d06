//! What of a city is there around an eye: blocks come and go, and none is made twice.

use std::collections::BTreeMap;

use crate::block::Block;
use crate::rules::CityRules;
use crate::streets::{Cell, cell_at, has_cell};

/// The blocks around an eye.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Around {
    blocks: BTreeMap<Cell, Block>,
    made: u64,
}

/// What has changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Change {
    /// Blocks that came.
    pub come: u32,
    /// Blocks that went.
    pub gone: u32,
}

impl Change {
    /// Whether nothing has changed.
    #[must_use]
    pub const fn is_none(self) -> bool {
        self.come == 0 && self.gone == 0
    }
}

impl Around {
    /// Keeps the blocks whose cells are at most `cells` from that of the eye, along both axes; where they are depends
    /// on the eye alone. Makes those that were not there. An eye that is nowhere keeps all as it is.
    pub fn look(&mut self, rules: &CityRules, eye: [f64; 2], cells: u32) -> Change {
        let Some(middle) = cell_at(rules, eye) else {
            return Change::default();
        };
        // Beyond this the numbers of cells would come to their end.
        let reach = cells.min(1 << 12).cast_signed();
        let before = self.blocks.len();
        self.blocks
            .retain(|cell, _| (0..2).all(|k| (cell[k] - middle[k]).abs() <= reach));
        let gone = (before - self.blocks.len()) as u32;
        let mut come = 0;
        for x in middle[0] - reach..=middle[0] + reach {
            for z in middle[1] - reach..=middle[1] + reach {
                if has_cell(rules, [x, z]) {
                    self.blocks.entry([x, z]).or_insert_with(|| {
                        come += 1;
                        Block::new(rules, [x, z])
                    });
                }
            }
        }
        self.made += u64::from(come);
        Change { come, gone }
    }

    /// Forgets all blocks, as new rules make it.
    pub fn clear(&mut self) {
        self.blocks.clear();
    }

    /// The blocks, by cell: the same order however they came.
    pub fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.blocks.values()
    }

    /// Blocks that are there.
    #[must_use]
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Whether none is there.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Blocks made since the beginning.
    #[must_use]
    pub const fn made(&self) -> u64 {
        self.made
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_walk_makes_a_column_at_each_crossing_and_nothing_in_between() {
        let rules = CityRules::default();
        let mut around = Around::default();
        assert_eq!(
            around.look(&rules, [1.0, 1.0], 3),
            Change { come: 49, gone: 0 }
        );
        for step in 1..320 {
            let eye = [1.0 + f64::from(step), 1.0];
            let change = around.look(&rules, eye, 3);
            let crossed = (1 + step) % 32 == 0;
            let moved = if crossed { 7 } else { 0 };
            assert_eq!(
                change,
                Change {
                    come: moved,
                    gone: moved
                },
                "{step}"
            );
        }
        assert_eq!((around.len(), around.made()), (49, 49 + 10 * 7));
        let mut fresh = Around::default();
        fresh.look(&rules, [320.0, 1.0], 3);
        assert!(
            fresh.blocks().eq(around.blocks()),
            "the way there does not count"
        );
    }

    #[test]
    fn where_a_city_ends_there_is_nothing_and_a_lost_eye_changes_nothing() {
        let rules = CityRules {
            blocks: Some((3, 3)),
            ..CityRules::default()
        };
        let mut around = Around::default();
        assert_eq!(around.look(&rules, [0.0, 0.0], 10).come, 9);
        let change = around.look(&rules, [f64::NAN, 0.0], 10);
        assert!(change.is_none() && around.len() == 9);
        assert_eq!(around.look(&rules, [1e5, 0.0], 10).gone, 9);
        assert!(around.is_empty());
    }
}
