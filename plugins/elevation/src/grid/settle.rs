//! What holds for the samples of all kinds once they are there.

use super::{Grid, Settled};
use crate::about::Text64;
use crate::error::ElevationError;
use crate::extremes::Extremes;
use crate::nodata::{Marks, named};
use crate::parts::in_parts;
use crate::refuse::refuse;

impl Grid<'_> {
    /// Marks what is no data as NaN, applies the file's own scale, and refuses what cannot be a height.
    ///
    /// `file_nodata`: numbers that the file itself names.
    pub fn settle(self, file_nodata: &[f64], scale: (f64, f64)) -> Result<Settled, ElevationError> {
        self.settle_with_gaps(file_nodata, scale, false)
    }

    /// As [`Self::settle`]; `gaps`: the reader itself left NaN where there is no data.
    pub fn settle_with_gaps(
        mut self,
        file_nodata: &[f64],
        (scale, offset): (f64, f64),
        gaps: bool,
    ) -> Result<Settled, ElevationError> {
        let nodata = named(self.options, file_nodata);
        while self
            .band
            .as_ref()
            .is_some_and(|band| band.top < self.kept[1])
        {
            self.hand_on();
        }
        let mut notes = Vec::new();
        let mut gaps = gaps;
        if let Some(mask) = self.gaps.take() {
            notes.push(mask.done()?);
            gaps = true;
        }
        if let Some(band) = self.band.take() {
            if let Some(error) = band.failed {
                return Err(error);
            }
            let looks = self.wide.as_ref().map_or(&band.looks, |wide| &wide.looks);
            looks.check(gaps || !nodata.is_empty(), self.file, self.options)?;
            let is_scaled = self.wide.is_some();
            let scaled = |number: f32| match is_scaled {
                true => number,
                false => (f64::from(number) * scale + offset) as f32,
            };
            return Ok(Settled {
                size: self.kept.map(|n| n as u32),
                samples: Vec::new(),
                holes: band.looks.nan,
                range: band.looks.range().map(|range| {
                    let [a, b] = range.map(scaled);
                    [a.min(b), a.max(b)]
                }),
                nodata: nodata.into_iter().map(Text64).collect(),
                notes,
            });
        }
        let is_scaled = self.wide.is_some();
        let marks = Marks::new(if is_scaled { &[] } else { &nodata });
        let parts = in_parts(&mut self.samples, |part| {
            marks.mark(part);
            Extremes::of(part)
        });
        let mut found = Extremes::NONE;
        for part in parts {
            found.join(part);
        }
        let holes = found.nan;
        match &self.wide {
            Some(wide) => {
                let marked = gaps || !nodata.is_empty();
                wide.looks.check(marked, self.file, self.options)?;
            }
            None => {
                let told = (gaps || marks.any(), &found);
                refuse(self.file, self.options, self.kept[0], &self.samples, told)?;
            }
        }
        let mut range = (found.low <= found.high).then_some([found.low, found.high]);
        if (scale, offset) != (1.0, 0.0) && !is_scaled {
            let scaled = |number: f32| (f64::from(number) * scale + offset) as f32;
            in_parts(&mut self.samples, |part| {
                for sample in part {
                    *sample = scaled(*sample);
                }
            });
            range = range.map(|range| {
                let [a, b] = range.map(scaled);
                [a.min(b), a.max(b)]
            });
        }
        Ok(Settled {
            size: self.kept.map(|n| n as u32),
            samples: self.samples,
            holes,
            range,
            nodata: nodata.into_iter().map(Text64).collect(),
            notes,
        })
    }
}
