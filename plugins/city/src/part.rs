//! A part of a city, made: records in arrays, row after row of cells.

use crate::block::Block;
use crate::hash::{FNV, fnv};
use crate::lamp::{Lamp, lamps};
use crate::rules::CityRules;
use crate::rules_error::RulesError;
use crate::streets::{Cell, extent};

/// Most blocks that are made in one go: 256 MB of records.
pub const MOST_AT_ONCE: u64 = 1 << 22;

/// Blocks and lamps of some cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CityPart {
    /// Row after row, from north to south, each from west to east.
    pub blocks: Vec<Block>,
    /// In the order of their blocks.
    pub lamps: Vec<Lamp>,
}

/// A rectangle of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cells {
    /// The north-western one.
    pub least: Cell,
    /// Columns and rows.
    pub count: [u32; 2],
}

impl Cells {
    /// All cells of a city that ends.
    #[must_use]
    pub fn all(rules: &CityRules) -> Option<Self> {
        extent(rules).map(|(least, count)| Self { least, count })
    }

    fn row(self, row: u32) -> impl Iterator<Item = Cell> {
        let z = self.least[1].wrapping_add(row.cast_signed());
        (0..self.count[0]).map(move |k| [self.least[0].wrapping_add(k.cast_signed()), z])
    }
}

impl CityPart {
    /// Makes blocks and lamps of the cells, by so many threads: the same bits for any number.
    ///
    /// # Errors
    /// [`RulesError::TooMany`] beyond [`MOST_AT_ONCE`]; rules that [`CityRules::checked`] refuses.
    pub fn new(rules: &CityRules, cells: Cells, threads: usize) -> Result<Self, RulesError> {
        let rules = rules.clone().checked()?;
        let blocks = u64::from(cells.count[0]) * u64::from(cells.count[1]);
        if blocks > MOST_AT_ONCE {
            return Err(RulesError::TooMany {
                blocks,
                most: MOST_AT_ONCE,
            });
        }
        let rows = cells.count[1];
        let threads = (threads.max(1) as u32).min(rows.max(1));
        if threads == 1 {
            return Ok(Self::rows(&rules, cells, 0..rows));
        }
        let share = rows.div_ceil(threads);
        let rules = &rules;
        let parts: Vec<Self> = std::thread::scope(|scope| {
            let running: Vec<_> = (0..threads)
                .map(|k| {
                    let range = (k * share).min(rows)..((k + 1) * share).min(rows);
                    scope.spawn(move || Self::rows(rules, cells, range))
                })
                .collect();
            running
                .into_iter()
                .map(|thread| {
                    thread
                        .join()
                        .unwrap_or_else(|fault| std::panic::resume_unwind(fault))
                })
                .collect()
        });
        let mut city = Self::default();
        for part in parts {
            city.blocks.extend(part.blocks);
            city.lamps.extend(part.lamps);
        }
        Ok(city)
    }

    fn rows(rules: &CityRules, cells: Cells, range: core::ops::Range<u32>) -> Self {
        let mut city = Self {
            blocks: Vec::with_capacity(range.len() * cells.count[0] as usize),
            lamps: Vec::new(),
        };
        for row in range {
            for cell in cells.row(row) {
                city.blocks.push(Block::new(rules, cell));
                city.lamps.extend(lamps(rules, cell));
            }
        }
        city
    }

    /// FNV-1a (64 bits) of all records.
    #[must_use]
    pub fn hash(&self) -> u64 {
        let state = fnv(FNV, bytemuck::cast_slice(&self.blocks));
        fnv(state, bytemuck::cast_slice(&self.lamps))
    }

    /// Bytes of all records.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice()) + size_of_val(self.lamps.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules() -> CityRules {
        CityRules {
            blocks: Some((125, 125)),
            ..CityRules::default()
        }
    }

    #[test]
    fn four_kilometres_have_so_many_blocks_and_lamps_and_the_same_bits_for_any_threads() {
        let rules = rules();
        let cells = Cells::all(&rules).expect("it ends");
        let mut times: Vec<_> = (0..9)
            .map(|_| {
                let start = std::time::Instant::now();
                assert!(CityPart::new(&rules, cells, 1).is_ok());
                start.elapsed()
            })
            .collect();
        times.sort_unstable();
        println!("15 625 blocks on one core: {:?} (median of 9)", times[4]);
        let one = CityPart::new(&rules, cells, 1).expect("a city");
        assert_eq!(one.blocks.len(), 15_625);
        // 15 625 blocks with 4 sides of 32 m each, a lamp per 30 m: 66 667.
        assert!(
            (66_000..67_500).contains(&one.lamps.len()),
            "{}",
            one.lamps.len()
        );
        for threads in [2, 3, 8, 1000] {
            let other = CityPart::new(&rules, cells, threads).expect("a city");
            assert_eq!(other.hash(), one.hash(), "{threads} threads");
        }
        let counted: usize = one
            .blocks
            .iter()
            .flat_map(|b| b.lamps)
            .map(usize::from)
            .sum();
        assert_eq!(counted, one.lamps.len());
    }

    #[test]
    fn a_block_is_the_same_from_any_part_and_another_by_another_seed() {
        let rules = rules();
        let whole = CityPart::new(
            &rules,
            Cells {
                least: [-5, -5],
                count: [10, 10],
            },
            1,
        )
        .expect("ok");
        let part = CityPart::new(
            &rules,
            Cells {
                least: [-1, 2],
                count: [3, 1],
            },
            1,
        )
        .expect("ok");
        assert_eq!(part.blocks[..], whole.blocks[74..77]);
        let other = CityRules { seed: 2, ..rules };
        let other = CityPart::new(
            &other,
            Cells {
                least: [-1, 2],
                count: [3, 1],
            },
            1,
        )
        .expect("ok");
        assert_ne!(other.hash(), part.hash());
    }

    #[test]
    fn too_many_are_refused() {
        let cells = Cells {
            least: [0, 0],
            count: [40_000, 40_000],
        };
        let error = CityPart::new(&CityRules::default(), cells, 1).expect_err("1.6 billion");
        assert!(error.to_string().contains("1600000000"), "{error}");
        let rules = CityRules {
            pitch: f32::NAN,
            ..CityRules::default()
        };
        assert!(
            CityPart::new(
                &rules,
                Cells {
                    least: [0, 0],
                    count: [1, 1]
                },
                1
            )
            .is_err()
        );
    }
}
