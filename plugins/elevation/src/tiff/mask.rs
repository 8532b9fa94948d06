//! The mask of a TIFF: a second picture of the same size, 0 where there is no data (TIFF 6.0, section 8, transparency mask;
//! GDAL's internal masks). Chunks that are absent are 0.

use ::tiff::tags::IfdPointer;

use super::Tiff;
use super::failure::Failure;
use super::layout::{Layout, layout};
use crate::error::ElevationError;

/// A mask, of which the chunks of one row of chunks are held.
pub(super) struct Mask {
    layout: Layout,
    /// Which row of chunks is held.
    held: usize,
    chunks: Vec<Option<Vec<u8>>>,
}

impl Mask {
    /// The mask of a map, by its size among those whose directories, which have been looked over, stand at `places`.
    pub fn find(
        tiff: &mut Tiff<'_>,
        places: &[u64],
        (map, bytes): (&Layout, u64),
        failure: &Failure<'_>,
    ) -> Result<Option<Self>, ElevationError> {
        for &at in places {
            let directory = tiff
                .read_directory(IfdPointer(at))
                .map_err(|error| failure.of("the directory of its mask", error))?;
            let layout = layout(&mut tiff.read_directory_tags(&directory), map.big, failure)?;
            if layout.size != map.size || layout.bands != 1 {
                continue;
            }
            layout.check(bytes, 0, failure)?;
            return Ok(Some(Self::new(layout)));
        }
        Ok(None)
    }

    /// That of a picture which was checked, and has one band.
    pub fn new(layout: Layout) -> Self {
        let across = layout.grid()[0] as usize;
        Self {
            layout,
            held: usize::MAX,
            chunks: vec![None; across],
        }
    }

    /// Takes away where the mask is 0, from a place on.
    pub fn row(
        &mut self,
        tiff: &mut Tiff<'_>,
        [column, row]: [usize; 2],
        there: &mut [bool],
        failure: &Failure<'_>,
    ) -> Result<(), ElevationError> {
        let [wide, high] = self.layout.chunk.map(|n| n as usize);
        if self.held != row / high {
            self.held = row / high;
            self.chunks.fill(None);
        }
        for (k, there) in there.iter_mut().enumerate() {
            let [chunk, within] = [(column + k) / wide, (column + k) % wide];
            let bytes = match &mut self.chunks[chunk] {
                Some(bytes) => bytes,
                none => {
                    let number = self.held * self.layout.grid()[0] as usize + chunk;
                    none.insert(self.layout.unpacked(tiff, number, failure)?)
                }
            };
            let line = self.layout.row(bytes, row % high);
            *there &= self.layout.is_not_zero(line, within);
        }
        Ok(())
    }
}
