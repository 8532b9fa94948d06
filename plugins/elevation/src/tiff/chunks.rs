//! The chunks of a TIFF, strips or tiles, one after the other into the map.

use std::io::{Read, Seek, SeekFrom};

use ::tiff::TiffError;
use ::tiff::decoder::DecodingResult;

use super::failure::Failure;
use super::layout::Layout;
use super::{Tiff, lzw};
use crate::about::NumberType;
use crate::error::ElevationError;
use crate::grid::Grid;

impl Layout {
    /// Decodes all chunks of the band; returns how many are absent.
    pub(super) fn samples(
        &self,
        tiff: &mut Tiff<'_>,
        band: u32,
        grid: &mut Grid<'_>,
        failure: &Failure<'_>,
    ) -> Result<usize, ElevationError> {
        let (first, count) = self.chunks(band);
        let across = self.grid()[0] as usize;
        let (step, skip) = if self.planar {
            (1, 0)
        } else {
            (self.bands as usize, band as usize)
        };
        let absent = (0..count).filter(|k| self.counts[first + k] == 0).count();
        if absent > 0 {
            grid.no_data();
        }
        for chunk in (0..count).filter(|k| self.counts[first + k] != 0) {
            let number = u32::try_from(first + chunk)
                .map_err(|_| failure.damaged(self.name(chunk), "there are too many"))?;
            let [mut width, height] = self.within(chunk).map(|n| n as usize);
            let decoded = if self.compression == 5 {
                // Whole tiles, also where they reach over the edge.
                width = self.chunk[0] as usize;
                self.lzw(tiff, first + chunk, height, failure)?
            } else {
                tiff.read_chunk(number)
                    .map_err(|error| failure.of(&self.name(chunk), error))?
            };
            let column = chunk % across * self.chunk[0] as usize;
            let row = chunk / across * self.chunk[1] as usize;
            let (line, within) = (width * step, self.within(chunk)[0] as usize);
            // Only the decoder turns numbers over.
            let inverted = self.inverted && self.compression != 5;
            macro_rules! put {
                ($values:expr, $to:expr) => {{
                    if $values.len() < line * height {
                        return Err(failure.damaged(self.name(chunk), "it is too short"));
                    }
                    for (k, values) in $values.chunks_exact(line).take(height).enumerate() {
                        let values = values.iter().skip(skip).step_by(step).take(within).map($to);
                        grid.put(row + k, column, 1, values);
                    }
                }};
            }
            match decoded {
                DecodingResult::U8(v) => put!(v, |&n| f32::from(if inverted { !n } else { n })),
                DecodingResult::U16(v) => put!(v, |&n| f32::from(if inverted { !n } else { n })),
                DecodingResult::U32(v) => put!(v, |&n| (if inverted { !n } else { n }) as f32),
                DecodingResult::U64(v) => put!(v, |&n| (if inverted { !n } else { n }) as f32),
                DecodingResult::I8(v) => put!(v, |&n| f32::from(n)),
                DecodingResult::I16(v) => put!(v, |&n| f32::from(n)),
                DecodingResult::I32(v) => put!(v, |&n| n as f32),
                DecodingResult::I64(v) => put!(v, |&n| n as f32),
                DecodingResult::F16(v) => put!(v, |n| n.to_f32()),
                DecodingResult::F32(v) => put!(v, |&n| n),
                DecodingResult::F64(v) => put!(v, |&n| n as f32),
            }
        }
        Ok(absent)
    }

    /// Unpacks the first `height` rows of a chunk.
    fn lzw(
        &self,
        tiff: &mut Tiff<'_>,
        chunk: usize,
        height: usize,
        failure: &Failure<'_>,
    ) -> Result<DecodingResult, ElevationError> {
        use NumberType::{F16, F32, F64, I8, I16, I32, I64, Text, U8, U16, U32, U64};
        let name = || self.name(chunk % self.chunks(0).1);
        let from = tiff.inner();
        // At most as long as the file, which was checked.
        let mut packed = vec![0; self.counts[chunk] as usize];
        from.seek(SeekFrom::Start(self.offsets[chunk]))
            .and_then(|_| from.read_exact(&mut packed))
            .map_err(|error| failure.of(&name(), TiffError::IoError(error)))?;
        let bands = if self.planar { 1 } else { self.bands as usize };
        let rows = lzw::Rows {
            samples: self.chunk[0] as usize * bands,
            apart: bands,
            bytes: self.number.bytes() as usize,
            predictor: self.predictor,
            big: self.big,
        };
        let mut bytes = vec![0; rows.samples * rows.bytes * height];
        lzw::unpack(&packed, &mut bytes, rows).map_err(|reason| failure.damaged(name(), reason))?;
        macro_rules! numbers {
            ($kind:ident, $number:ty) => {{
                let (numbers, _) = bytes.as_chunks::<{ size_of::<$number>() }>();
                let numbers = numbers.iter().map(|b| <$number>::from_ne_bytes(*b));
                DecodingResult::$kind(numbers.collect())
            }};
        }
        Ok(match self.number {
            U8 | Text => DecodingResult::U8(bytes),
            I8 => numbers!(I8, i8),
            U16 => numbers!(U16, u16),
            I16 => numbers!(I16, i16),
            U32 => numbers!(U32, u32),
            I32 => numbers!(I32, i32),
            U64 => numbers!(U64, u64),
            I64 => numbers!(I64, i64),
            F32 => numbers!(F32, f32),
            F64 => numbers!(F64, f64),
            F16 => {
                return Err(failure.unsupported("LZW of 16-bit floats", "-ot Float32"));
            }
        })
    }
}
