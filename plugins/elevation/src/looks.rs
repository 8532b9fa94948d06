//! What is seen of samples that stream by: lowest and highest, and what cannot be a height. The same rules as those of a grid that
//! holds all of them, in one pass.

use crate::error::ElevationError;
use crate::extremes::{Extremes, is_customary};
use crate::options::{NoData, Options};

/// A number that is looked for: where it was seen first, and how often.
#[derive(Clone, Copy, Debug)]
struct Seen {
    value: f32,
    /// Column and row.
    first: [u32; 2],
    count: u64,
}

/// What was seen so far. Of numbers that people write where there is no data few can be in one file, and each is kept by itself.
#[derive(Clone, Debug)]
pub(crate) struct Looks {
    /// All but what is kept by itself.
    others: Extremes,
    apart: Vec<Seen>,
    pub nan: u64,
    first_nan: [u32; 2],
}

impl Default for Looks {
    fn default() -> Self {
        Self {
            others: Extremes::NONE,
            apart: Vec::new(),
            nan: 0,
            first_nan: [0; 2],
        }
    }
}

impl Looks {
    /// Most numbers that are kept by themselves: from 1e19 on every number is one that people write, and a map of such numbers has
    /// none that stands alone.
    const MOST: usize = 64;

    /// Looks at a whole row.
    pub fn row(&mut self, row: usize, samples: &[f32]) {
        self.part([0, row], 1, samples);
    }

    /// Looks at a part of a row, from a column on, of samples so many columns apart.
    pub fn part(&mut self, [column, row]: [usize; 2], step: usize, samples: &[f32]) {
        let found = Extremes::of(samples);
        let plain = found.nan == 0 && !is_apart(found.low) && !is_apart(found.high);
        // What is customary lies between others as well, where it does no harm: it is looked for at the ends alone.
        if plain {
            self.others.join(found);
            return;
        }
        for (k, &sample) in samples.iter().enumerate() {
            let at = [(column + k * step) as u32, row as u32];
            if sample.is_nan() {
                if self.nan == 0 || is_before(at, self.first_nan) {
                    self.first_nan = at;
                }
                self.nan += 1;
            } else if is_apart(sample) {
                self.note(sample, at);
            } else {
                self.others.low = self.others.low.min(sample);
                self.others.high = self.others.high.max(sample);
            }
        }
    }

    fn note(&mut self, value: f32, first: [u32; 2]) {
        if let Some(seen) = self.apart.iter_mut().find(|seen| seen.value == value) {
            seen.count += 1;
            if is_before(first, seen.first) {
                seen.first = first;
            }
        } else if self.apart.len() < Self::MOST {
            let count = 1;
            self.apart.push(Seen {
                value,
                first,
                count,
            });
        } else {
            self.others.low = self.others.low.min(value);
            self.others.high = self.others.high.max(value);
        }
    }

    /// Lowest and highest of all but `value`.
    fn beside(&self, value: Option<f32>) -> Option<[f32; 2]> {
        let mut all = self.others;
        for seen in self.apart.iter().filter(|seen| Some(seen.value) != value) {
            all.low = all.low.min(seen.value);
            all.high = all.high.max(seen.value);
        }
        (all.low <= all.high).then_some([all.low, all.high])
    }

    /// Lowest and highest, if there is any data.
    pub fn range(&self) -> Option<[f32; 2]> {
        self.beside(None)
    }

    /// Refuses NaN without a word that it is no data, infinity, and numbers that can only be no data.
    pub fn check(&self, marked: bool, file: &str, options: &Options) -> Result<(), ElevationError> {
        let not_finite = |value, [column, row]: [u32; 2], count| ElevationError::NotFinite {
            file: file.to_owned(),
            again: options.command(file),
            value,
            column,
            row,
            count,
        };
        if self.nan > 0 && !marked {
            return Err(not_finite(f32::NAN, self.first_nan, self.nan));
        }
        if let Some(seen) = self.apart.iter().find(|seen| seen.value.is_infinite()) {
            return Err(not_finite(seen.value, seen.first, seen.count));
        }
        if options.nodata == NoData::None {
            return Ok(());
        }
        for value in self.range().into_iter().flatten() {
            let (Some(seen), Some([low, high])) = (
                self.apart.iter().find(|seen| seen.value == value),
                self.beside(Some(value)),
            ) else {
                continue;
            };
            if (value - high).max(low - value) > (high - low).max(100.0) {
                let [column, row] = seen.first;
                return Err(ElevationError::LooksLikeNoData {
                    file: file.to_owned(),
                    again: options.command(file),
                    value,
                    column,
                    row,
                    count: seen.count,
                    low,
                    high,
                });
            }
        }
        Ok(())
    }
}

/// Whether a place comes before another one, row by row: tiles do not.
fn is_before([column, row]: [u32; 2], other: [u32; 2]) -> bool {
    [row, column] < [other[1], other[0]]
}

fn is_apart(sample: f32) -> bool {
    sample.is_infinite() || is_customary(sample)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(rows: &[&[f32]], options: &Options) -> Result<Option<[f32; 2]>, ElevationError> {
        let mut looks = Looks::default();
        for (row, samples) in rows.iter().enumerate() {
            looks.row(row, samples);
        }
        looks.check(false, "a.asc", options)?;
        Ok(looks.range())
    }

    #[test]
    fn numbers_that_can_only_be_no_data_are_found_with_their_place() {
        let plain = Options::default();
        let low = look(&[&[1.0, 2.0], &[3.0, -9999.0], &[-9999.0, 4.0]], &plain);
        let error = low.expect_err("far from the others");
        assert!(
            matches!(error, ElevationError::LooksLikeNoData { value, column: 1, row: 1, count: 2, .. } if value == -9999.0),
            "{error}"
        );
        // Among others of its size it is a height.
        assert!(look(&[&[-9999.0, -9000.0], &[-8000.0, 4000.0]], &plain).is_ok());
        let none = Options {
            nodata: NoData::None,
            ..plain
        };
        let range = look(&[&[1.0, -9999.0]], &none).expect("told to be a height");
        assert_eq!(range, Some([-9999.0, 1.0]));
        for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let error = look(&[&[1.0, 2.0], &[wrong, 2.0]], &none).expect_err("no height");
            assert!(
                matches!(
                    error,
                    ElevationError::NotFinite {
                        column: 0,
                        row: 1,
                        ..
                    }
                ),
                "{error}"
            );
        }
        assert_eq!(look(&[], &plain).expect("nothing wrong"), None);
    }
}
