//! Level 0: from the map's own file where numbers stand there as they are, else from the file of tiles.

use super::derive::TILE;
use super::place::{Placed, Stamp};
use crate::error::{ElevationError, read_error};
use crate::nodata::Marks;
use crate::raw::Plan;
use std::io;

/// A raw file.
#[derive(Debug)]
pub(super) struct Direct {
    pub file: Placed,
    pub name: String,
    pub plan: Plan,
    pub stamp: Stamp,
    /// Numbers that stand for no data.
    pub nodata: Marks,
    /// What stands in their place.
    pub hole: f32,
}

impl Direct {
    /// Refuses to go on with a file that is no longer what it was.
    pub fn check(&self) -> Result<(), ElevationError> {
        let now = self.file.stamp();
        let now = now.map_err(|error| read_error(&self.name, &error))?;
        if now == self.stamp {
            return Ok(());
        }
        Err(ElevationError::Changed {
            file: self.name.clone(),
        })
    }

    /// Samples from (x, z) on, `width` by `to.len() / width`; beyond the map its border goes on.
    pub fn read(
        &self,
        [x, z]: [i64; 2],
        width: usize,
        to: &mut [f32],
    ) -> Result<(), ElevationError> {
        let failed = |error: io::Error| match error.kind() {
            io::ErrorKind::UnexpectedEof => ElevationError::Changed {
                file: self.name.clone(),
            },
            _ => read_error(&self.name, &error),
        };
        let [columns, rows] = self.plan.size.map(i64::from);
        let bytes = self.plan.sample_bytes() as usize;
        // Columns that are in the file, at least one.
        let first = x.clamp(0, columns - 1);
        let end = (x + width as i64).clamp(first + 1, columns);
        let (before, count) = ((first - x) as usize, (end - first) as usize);
        let before = before.min(width);
        let mut buffer = vec![0; count * bytes];
        let mut line = vec![0.0; count];
        let mut known: Option<i64> = None;
        for (k, to) in to.chunks_mut(width).enumerate() {
            let row = (z + k as i64).clamp(0, rows - 1);
            if known != Some(row) {
                let at = self.plan.at(first as u64, row as u64);
                self.file.read(at, &mut buffer).map_err(failed)?;
                self.plan.numbers(&buffer, &mut line);
                self.nodata.mark(&mut line);
                for sample in line.iter_mut().filter(|sample| sample.is_nan()) {
                    *sample = self.hole;
                }
                known = Some(row);
            }
            spread(&line, before, to);
        }
        self.check()
    }
}

/// Puts a line of samples into a row, from `before` on; its ends go on to both sides.
pub(super) fn spread(line: &[f32], before: usize, to: &mut [f32]) {
    let before = before.min(to.len());
    let count = line.len().min(to.len() - before);
    to[..before].fill(line[0]);
    to[before..before + count].copy_from_slice(&line[..count]);
    to[before + count..].fill(line[count.max(1) - 1]);
}

/// Copies what a tile of level 0 has of a region from (x, z) on. Tiles hold whatever lies beyond the map too, so that a region whose
/// columns and rows are clamped to the map is in them.
pub(super) fn copy(
    tile: &[f32],
    at: [u32; 2],
    ([x, z], width): ([i64; 2], usize),
    [columns, rows]: [u32; 2],
    to: &mut [f32],
) {
    let begin = at.map(|n| i64::from(n) * TILE as i64);
    let height = to.len() / width;
    let range = |first: i64, count: usize, begin: i64, samples: u32| {
        (0..count).filter_map(move |k| {
            let place = (first + k as i64).clamp(0, i64::from(samples) - 1) - begin;
            (0..TILE as i64)
                .contains(&place)
                .then_some((k, place as usize))
        })
    };
    for (row, from) in range(z, height, begin[1], rows) {
        let line = &tile[from * TILE..][..TILE];
        let to = &mut to[row * width..][..width];
        // Within the map columns follow each other.
        for (column, from) in range(x, width, begin[0], columns) {
            to[column] = line[from];
        }
    }
}
