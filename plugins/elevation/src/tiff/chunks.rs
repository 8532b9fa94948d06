//! The chunks of a TIFF, strips or tiles, one after the other into the map.

use std::io::{Read, Seek, SeekFrom};

use ::tiff::TiffError;

use super::Tiff;
use super::failure::Failure;
use super::layout::Layout;
use super::mask::Mask;
use super::rows::{Rows, packed};
use super::unpack::unpack;
use crate::about::NumberType;
use crate::error::ElevationError;
use crate::grid::Grid;

/// What tells where there is no data, besides numbers.
pub(super) struct Gaps {
    /// Whether the band of that name counts.
    pub alpha: bool,
    pub mask: Option<Mask>,
}

impl Layout {
    /// Puts all chunks of the band; returns how many are absent.
    pub(super) fn samples(
        &self,
        tiff: &mut Tiff<'_>,
        band: u32,
        mut gaps: Gaps,
        grid: &mut Grid<'_>,
        failure: &Failure<'_>,
    ) -> Result<usize, ElevationError> {
        let (first, count) = self.chunks(band);
        let absent = (0..count).filter(|k| self.counts[first + k] == 0).count();
        if absent > 0 {
            grid.no_data();
        }
        let alpha = self.alpha.filter(|_| gaps.alpha);
        for chunk in (0..count).filter(|k| self.counts[first + k] != 0) {
            let bytes = self.unpacked(tiff, first + chunk, failure)?;
            let other = match alpha {
                Some(alpha) if self.planar => {
                    Some(self.unpacked(tiff, self.chunks(alpha).0 + chunk, failure)?)
                }
                _ => None,
            };
            let [column, top] = self.place(chunk);
            let [wide, high] = self.within(chunk).map(|n| n as usize);
            let mut there = vec![true; wide];
            for k in 0..high {
                let line = self.row(&bytes, k);
                there.fill(true);
                match (alpha, &other) {
                    (Some(_), Some(other)) => self.opaque(self.row(other, k), 0, &mut there),
                    (Some(alpha), None) => self.opaque(line, alpha as usize, &mut there),
                    (None, _) => {}
                }
                if let Some(mask) = &mut gaps.mask {
                    mask.row(tiff, [column, top + k], &mut there, failure)?;
                }
                let has_gaps = alpha.is_some() || gaps.mask.is_some();
                self.put(
                    line,
                    band,
                    [column, top + k],
                    has_gaps.then_some(&there),
                    grid,
                );
            }
        }
        Ok(absent)
    }

    /// Column and row of a chunk's first sample.
    fn place(&self, chunk: usize) -> [usize; 2] {
        let across = self.grid()[0] as usize;
        let [wide, high] = self.chunk.map(|n| n as usize);
        [chunk % across * wide, chunk / across * high]
    }

    /// Unpacks the rows of a chunk that lie in the map, in native numbers; zeros where it is absent.
    pub(super) fn unpacked(
        &self,
        tiff: &mut Tiff<'_>,
        number: usize,
        failure: &Failure<'_>,
    ) -> Result<Vec<u8>, ElevationError> {
        let within = number % self.chunks(0).1;
        let height = self.within(within)[1] as usize;
        let rows = Rows::of(self);
        // Both are no more than the file's length bears out, which was checked.
        let mut bytes = vec![0; rows.row * height];
        if self.counts[number] == 0 {
            return Ok(bytes);
        }
        let from = tiff.inner();
        let mut stored = vec![0; self.counts[number] as usize];
        from.seek(SeekFrom::Start(self.offsets[number]))
            .and_then(|_| from.read_exact(&mut stored))
            .map_err(|error| failure.of(&self.name(within), TiffError::IoError(error)))?;
        unpack(self.compression, self.reversed, &stored, &mut bytes)
            .map_err(|reason| failure.damaged(self.name(within), reason))?;
        rows.undo(&mut bytes);
        Ok(bytes)
    }

    /// Row `k` of an unpacked chunk.
    pub(super) fn row<'a>(&self, bytes: &'a [u8], k: usize) -> &'a [u8] {
        let row = self.row_bytes() as usize;
        &bytes[k * row..][..row]
    }

    /// Takes away where the band `skip` of a row is 0.
    fn opaque(&self, line: &[u8], skip: usize, there: &mut [bool]) {
        let step = self.together();
        for (k, there) in there.iter_mut().enumerate() {
            *there &= self.is_not_zero(line, k * step + skip);
        }
    }

    /// Whether a sample of a row is anything but 0.
    pub(super) fn is_not_zero(&self, line: &[u8], sample: usize) -> bool {
        let bytes = self.number.bytes() as usize;
        if self.bits as usize != 8 * bytes {
            return packed(line, sample, self.bits) != 0;
        }
        let sample = line.get(sample * bytes..(sample + 1) * bytes);
        sample.is_some_and(|bytes| bytes.iter().any(|&byte| byte != 0))
    }

    /// A row of numbers into the map, from a column on, as far as it reaches.
    fn put(
        &self,
        line: &[u8],
        band: u32,
        [column, row]: [usize; 2],
        there: Option<&Vec<bool>>,
        grid: &mut Grid<'_>,
    ) {
        use NumberType::{F16, F32, F64, I8, I16, I32, I64, Text, U8, U16, U32, U64};
        let step = self.together();
        let skip = if self.planar { 0 } else { band as usize };
        let wide = (self.size[0] as usize - column).min(self.chunk[0] as usize);
        macro_rules! put {
            ($put:ident, $values:expr, $nan:expr) => {{
                let values = $values.skip(skip).step_by(step).take(wide);
                match there {
                    None => grid.$put(row, column, values),
                    Some(there) => {
                        let values = values.zip(there);
                        let values = values.map(|(n, there)| if *there { n } else { $nan });
                        grid.$put(row, column, values);
                    }
                }
            }};
        }
        macro_rules! numbers {
            ($put:ident, $number:ty, $to:expr, $nan:expr) => {{
                let (numbers, _) = line.as_chunks::<{ size_of::<$number>() }>();
                put!(
                    $put,
                    numbers.iter().map(|b| $to(<$number>::from_ne_bytes(*b))),
                    $nan
                )
            }};
        }
        if u64::from(self.bits) != 8 * self.number.bytes() {
            let count = 8 * line.len() / self.bits as usize;
            let numbers = (0..count).map(|k| f64::from(packed(line, k, self.bits)));
            return match self.number.is_wide() {
                true => put!(put_wide, numbers, f64::NAN),
                false => put!(put_row, numbers.map(|n| n as f32), f32::NAN),
            };
        }
        match self.number {
            U8 | Text => numbers!(put_row, u8, f32::from, f32::NAN),
            I8 => numbers!(put_row, i8, f32::from, f32::NAN),
            U16 => numbers!(put_row, u16, f32::from, f32::NAN),
            I16 => numbers!(put_row, i16, f32::from, f32::NAN),
            F16 => numbers!(put_row, u16, half, f32::NAN),
            F32 => numbers!(put_row, f32, |n| n, f32::NAN),
            U32 => numbers!(put_wide, u32, f64::from, f64::NAN),
            I32 => numbers!(put_wide, i32, f64::from, f64::NAN),
            U64 => numbers!(put_wide, u64, |n| n as f64, f64::NAN),
            I64 => numbers!(put_wide, i64, |n| n as f64, f64::NAN),
            F64 => numbers!(put_wide, f64, |n| n, f64::NAN),
        }
    }
}

/// A float of 16 bits (IEEE 754, binary16), which f32 holds exactly.
fn half(bits: u16) -> f32 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (u32::from(bits >> 10) & 31, u32::from(bits) & 1023);
    let size = match exponent {
        // In steps of 2⁻²⁴.
        0 => fraction as f32 / 16_777_216.0,
        31 if fraction == 0 => f32::INFINITY,
        31 => return f32::NAN,
        _ => f32::from_bits((exponent + 112) << 23 | fraction << 13),
    };
    sign * size
}

#[cfg(test)]
mod tests {
    use super::half;

    #[test]
    fn floats_of_16_bits() {
        for (bits, wanted) in [
            (0x0000, 0.0),
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65_504.0),
            (0x0400, 6.103_515_6e-5),
            (0x0001, 5.960_464_5e-8),
            (0x83ff, -6.097_555e-5),
            (0x3555, 0.333_251_95),
            (0xfc00, f32::NEG_INFINITY),
        ] {
            assert_eq!(half(bits).to_bits(), f32::to_bits(wanted), "{bits:x}");
        }
        assert!(half(0x7e00).is_nan());
    }
}
