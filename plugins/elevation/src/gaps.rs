//! Where a mask beside the map says that there is no data: bits of some rows at a time, as the map's own rows come.

use crate::error::ElevationError;
use std::path::{Path, PathBuf};

/// Rows of a mask, read one after the other from the north.
pub(crate) trait MaskRows {
    /// Whether the samples of a row have data.
    fn row(&mut self, row: usize, there: &mut [bool]) -> Result<(), ElevationError>;
}

/// Opens the mask of a map, which errors call by this name, of so many columns and rows. It may hold at most so many bytes.
pub(crate) type OpenMask =
    fn(&Path, &str, [u32; 2], u64) -> Result<Box<dyn MaskRows>, ElevationError>;

/// A mask that stands beside a map, and who opens it.
#[derive(Clone, Debug)]
pub(crate) struct MaskBeside {
    pub path: PathBuf,
    pub open: OpenMask,
}

/// A mask that is open.
pub(crate) struct Gaps {
    mask: Box<dyn MaskRows>,
    name: String,
    /// Columns and rows of the map.
    size: [usize; 2],
    /// Rows whose bits are held at a time.
    high: usize,
    /// The first of them; none yet.
    first: Option<usize>,
    bits: Vec<u64>,
    /// Why no more of it is read.
    failed: Option<ElevationError>,
}

/// A row of a mask.
#[derive(Clone, Copy)]
pub(crate) struct There<'a>(&'a [u64]);

impl There<'_> {
    /// Whether a sample has data.
    pub fn is(self, column: usize) -> bool {
        let word = self.0.get(column / 64);
        word.is_some_and(|word| word >> (column % 64) & 1 == 1)
    }
}

impl Gaps {
    /// Rows are asked for so many together, in any order, before the next ones are.
    pub fn open(
        beside: &MaskBeside,
        map: &str,
        size: [u32; 2],
        together: u32,
        most: u64,
    ) -> Result<Self, ElevationError> {
        let mask = (beside.open)(&beside.path, map, size, most)?;
        let size = size.map(|n| n as usize);
        let together = (together as usize).clamp(1, size[1].max(1));
        // As many as make it worth while, and no part of what comes together.
        let high = (64_usize.div_ceil(together) * together).min(size[1].max(1));
        let name = beside.path.file_name().unwrap_or_default();
        Ok(Self {
            mask,
            name: name.to_string_lossy().into_owned(),
            size,
            high,
            first: None,
            bits: vec![0; high * size[0].div_ceil(64)],
            failed: None,
        })
    }

    /// A row of the map, from the north; `None` after an error, which [`Self::done`] tells.
    pub fn row(&mut self, row: usize) -> Option<There<'_>> {
        let first = row / self.high * self.high;
        if self.failed.is_none()
            && self.first != Some(first)
            && let Err(error) = self.load(first)
        {
            self.failed = Some(error);
        }
        if self.failed.is_some() {
            return None;
        }
        let words = self.size[0].div_ceil(64);
        let bits = self.bits.get((row - first) * words..)?;
        Some(There(bits.get(..words)?))
    }

    fn load(&mut self, first: usize) -> Result<(), ElevationError> {
        let [columns, rows] = self.size;
        let mut there = vec![true; columns];
        let words = columns.div_ceil(64);
        let lines = self.bits.chunks_exact_mut(words.max(1));
        for (row, line) in (first..rows).zip(lines) {
            self.mask.row(row, &mut there)?;
            for (word, there) in line.iter_mut().zip(there.chunks(64)) {
                let bits = there.iter().enumerate();
                *word = bits.fold(0, |word, (k, &there)| word | u64::from(there) << k);
            }
        }
        self.first = Some(first);
        Ok(())
    }

    /// A note on what it did, once all rows are through.
    ///
    /// # Errors
    /// The first that its rows met with.
    pub fn done(self) -> Result<String, ElevationError> {
        match self.failed {
            Some(error) => Err(error),
            None => Ok(format!(
                "{} beside it tells where there is no data",
                self.name
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No data where column and row add up to a multiple of 7; rows after the 90th cannot be read.
    struct Sevens {
        next: usize,
    }

    impl MaskRows for Sevens {
        fn row(&mut self, row: usize, there: &mut [bool]) -> Result<(), ElevationError> {
            assert!(
                row >= self.next || row == 0,
                "{row} comes after {}",
                self.next
            );
            self.next = row + 1;
            if row >= 90 {
                return Err(ElevationError::Changed {
                    file: "sevens".to_owned(),
                });
            }
            for (column, there) in there.iter_mut().enumerate() {
                *there = !(column + row).is_multiple_of(7);
            }
            Ok(())
        }
    }

    fn open(together: u32) -> Gaps {
        let beside = MaskBeside {
            path: PathBuf::from("folder/a.msk"),
            open: |_, _, _, _| Ok(Box::new(Sevens { next: 0 })),
        };
        Gaps::open(&beside, "a", [131, 200], together, 0).expect("it opens")
    }

    #[test]
    fn every_bit_of_rows_that_come_together_in_any_order() {
        for together in [1, 8, 9, 64, 70] {
            let mut gaps = open(together);
            let high = gaps.high;
            assert!(
                high >= 64 && high.is_multiple_of(together as usize),
                "{high}"
            );
            // The last ones of those that are held first.
            for row in (0..high.min(90)).rev() {
                let Some(there) = gaps.row(row) else {
                    // What is held reaches beyond what can be read.
                    assert!(high > 90);
                    continue;
                };
                for column in 0..131 {
                    let wanted = !(column + row).is_multiple_of(7);
                    assert_eq!(there.is(column), wanted, "{column}, {row}");
                }
                assert!(!there.is(200), "beyond the map");
            }
            assert!(gaps.row(150).is_none(), "it cannot be read");
            assert!(gaps.done().is_err());
        }
        let mut gaps = open(1);
        assert!(gaps.row(63).is_some());
        assert!(
            gaps.done()
                .expect("no error")
                .starts_with("a.msk beside it")
        );
    }
}
