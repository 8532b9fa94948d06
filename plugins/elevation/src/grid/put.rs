//! Numbers into the grid, as readers have them: rows or parts of rows, every so many columns, also in any order.

use super::{Grid, Wide};
use crate::looks::Looks;
use crate::nodata::{Marks, is_nodata, named};

impl Grid<'_> {
    /// A row of the file, counted from the north.
    fn north_row(&self, row: usize) -> usize {
        if self.flip {
            self.size[1] - 1 - row
        } else {
            row
        }
    }

    /// The row of the map that a row of the file becomes, if it is kept.
    fn row(&self, row: usize) -> Option<usize> {
        let row = self.north_row(row);
        row.is_multiple_of(self.every()).then(|| row / self.every())
    }

    /// Numbers of the file's row `row` from column `column` on, every `step` columns.
    #[inline]
    pub fn put(
        &mut self,
        row: usize,
        column: usize,
        step: usize,
        values: impl Iterator<Item = f32>,
    ) {
        let Some(mut gaps) = self.gaps.take() else {
            return self.set(row, column, step, values);
        };
        let is_kept = self.row(row).is_some();
        let there = if is_kept {
            gaps.row(self.north_row(row))
        } else {
            None
        };
        match there {
            None => self.set(row, column, step, values),
            Some(there) => {
                let values = values.enumerate().map(|(k, value)| {
                    let has_data = there.is(column + k * step);
                    if has_data { value } else { f32::NAN }
                });
                self.set(row, column, step, values);
            }
        }
        self.gaps = Some(gaps);
    }

    /// As [`Self::put`], whatever a mask says.
    #[inline]
    fn set(&mut self, row: usize, column: usize, step: usize, values: impl Iterator<Item = f32>) {
        if row > self.told {
            self.progress.add((row - self.told) as u64);
            self.told = row;
        }
        let Some(mut row) = self.row(row) else {
            return;
        };
        let held = self.samples.len() / self.kept[0];
        while let Some(band) = &self.band {
            if row < band.top {
                // It was handed on.
                return;
            }
            if row < band.top + held {
                row -= band.top;
                break;
            }
            self.hand_on();
        }
        let (every, width) = (self.every(), self.kept[0]);
        let line = &mut self.samples[row * width..][..width];
        if (every, step) == (1, 1) {
            for (to, value) in line[column.min(width)..].iter_mut().zip(values) {
                *to = value;
            }
            return;
        }
        for (k, value) in values.enumerate() {
            let column = column + k * step;
            if column.is_multiple_of(every)
                && let Some(to) = line.get_mut(column / every)
            {
                *to = value;
            }
        }
    }

    /// From now on numbers come by [`Self::put_wide`]. `nodata` and `scale` are the file's own.
    pub fn wide(&mut self, nodata: &[f64], scale: (f64, f64)) {
        self.wide = Some(Wide {
            nodata: named(self.options, nodata),
            scale,
            looks: Looks::default(),
        });
        if let Some(band) = &mut self.band {
            (band.marks, band.scale) = (Marks::new(&[]), (1.0, 0.0));
        }
    }

    /// Numbers of the file's row `row` from column `column` on.
    pub fn put_row(&mut self, row: usize, column: usize, values: impl Iterator<Item = f32>) {
        self.put(row, column, 1, values);
    }

    /// The same of numbers that f32 does not hold, after [`Self::wide`].
    pub fn put_wide(&mut self, row: usize, column: usize, values: impl Iterator<Item = f64>) {
        let is_kept = self.row(row).is_some();
        let (every, columns) = (self.every(), self.size[0]);
        // The first column from here on that is kept.
        let first = column.next_multiple_of(every);
        let values = values.take(columns.saturating_sub(column));
        let values = values.skip(first - column).step_by(every);
        let row_from_north = self.north_row(row);
        let Some(wide) = self.wide.as_mut().filter(|_| is_kept) else {
            return self.set(row, first, every, std::iter::empty());
        };
        let (scale, offset) = wide.scale;
        let mut numbers = Vec::new();
        let mut samples = Vec::new();
        let there = self.gaps.as_mut().and_then(|gaps| gaps.row(row_from_north));
        for (k, value) in values.enumerate() {
            let is_gap = there.is_some_and(|there| !there.is(first + k * every));
            let is_nodata = is_gap || wide.nodata.iter().any(|&nodata| is_nodata(value, nodata));
            let number = if is_nodata { f32::NAN } else { value as f32 };
            numbers.push(number);
            samples.push(match number.is_nan() || wide.scale == (1.0, 0.0) {
                true => number,
                false => (value * scale + offset) as f32,
            });
        }
        wide.looks.part([first, row], every, &numbers);
        self.set(row, first, every, samples.into_iter());
    }
}
