//! Rows of a chunk: predictors are undone, and bytes become numbers (TIFF 6.0, section 14; Adobe's technical note 3 on floats).

use super::layout::Layout;

/// How samples lie in a chunk.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows {
    /// Bytes a row.
    pub row: usize,
    /// Samples to the one before, of the same band.
    pub apart: usize,
    /// Bytes a sample.
    pub bytes: usize,
    /// 1: none, 2: differences, 3: of floats.
    pub predictor: u16,
    /// Whether the file's bytes are the greatest first.
    pub big: bool,
}

impl Rows {
    pub fn of(layout: &Layout) -> Self {
        Self {
            row: layout.row_bytes() as usize,
            apart: layout.together(),
            bytes: layout.number.bytes() as usize,
            predictor: layout.predictor,
            big: layout.big,
        }
    }

    /// Makes unpacked bytes native numbers.
    pub fn undo(&self, chunk: &mut [u8]) {
        let mut spare = vec![0; if self.predictor == 3 { self.row } else { 0 }];
        for line in chunk.chunks_exact_mut(self.row) {
            match self.predictor {
                3 => self.floats(line, &mut spare),
                _ => {
                    self.native(line);
                    if self.predictor == 2 {
                        self.sums(line);
                    }
                }
            }
        }
    }

    /// The file's byte order to the machine's.
    fn native(&self, line: &mut [u8]) {
        if self.bytes > 1 && self.big != cfg!(target_endian = "big") {
            line.chunks_exact_mut(self.bytes).for_each(<[u8]>::reverse);
        }
    }

    /// Each sample is the difference to the one before.
    fn sums(&self, line: &mut [u8]) {
        macro_rules! sums {
            ($number:ty, $size:expr) => {{
                let (samples, _) = line.as_chunks_mut::<$size>();
                for k in self.apart..samples.len() {
                    let before = <$number>::from_ne_bytes(samples[k - self.apart]);
                    let sum = <$number>::from_ne_bytes(samples[k]).wrapping_add(before);
                    samples[k] = sum.to_ne_bytes();
                }
            }};
        }
        match self.bytes {
            1 => sums!(u8, 1),
            2 => sums!(u16, 2),
            4 => sums!(u32, 4),
            _ => sums!(u64, 8),
        }
    }

    /// Bytes are differences to those before, all greatest bytes of a row first.
    fn floats(&self, line: &mut [u8], spare: &mut [u8]) {
        for k in self.apart..line.len() {
            line[k] = line[k].wrapping_add(line[k - self.apart]);
        }
        let samples = line.len() / self.bytes;
        for (k, sample) in spare.chunks_exact_mut(self.bytes).enumerate() {
            for (byte, to) in sample.iter_mut().enumerate() {
                *to = line[byte * samples + k];
            }
            if cfg!(target_endian = "little") {
                sample.reverse();
            }
        }
        line.copy_from_slice(spare);
    }
}

/// The number `k` of so many bits each, the first of which is the highest of a byte.
pub(super) fn packed(row: &[u8], k: usize, bits: u32) -> u32 {
    let first = k * bits as usize;
    let mut number = 0_u64;
    // Five bytes at most hold 32 bits that begin anywhere.
    for byte in 0..5 {
        let byte = row.get(first / 8 + byte).copied().unwrap_or(0);
        number = number << 8 | u64::from(byte);
    }
    let number = number >> (40 - bits as usize - first % 8);
    (number & ((1 << bits) - 1)) as u32
}

#[cfg(test)]
mod tests {
    use super::packed;

    #[test]
    fn numbers_of_any_bits_are_the_highest_first() {
        let row = [0b1010_0110, 0b1111_0001, 0b0000_1111, 0xff, 0x12];
        let all = |bits, count| {
            (0..count)
                .map(|k| packed(&row, k, bits))
                .collect::<Vec<_>>()
        };
        assert_eq!(all(1, 8), [1, 0, 1, 0, 0, 1, 1, 0]);
        assert_eq!(all(2, 4), [2, 2, 1, 2]);
        assert_eq!(all(4, 4), [0xa, 6, 0xf, 1]);
        assert_eq!(all(12, 3), [0xa6f, 0x10f, 0xff1]);
        assert_eq!(all(20, 2), [0xa6f10, 0xfff12]);
        assert_eq!(packed(&row, 0, 32), 0xa6f1_0fff);
    }
}
