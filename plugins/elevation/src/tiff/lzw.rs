//! LZW chunks, unpacked whole.
//!
//! The `tiff` crate (0.11.3) reads rows of tiles that reach over the map's edge in small pieces, and its LZW reader
//! then loses the end of some ("no lzw end code found"). A chunk that is unpacked at once is whole; bytes
//! and predictors are undone here (TIFF 6.0, sections 13 and 14; Adobe's technical note 3 on floats).

use weezl::{BitOrder, LzwStatus, decode};

/// How samples lie in a chunk.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows {
    /// Samples a row, all bands.
    pub samples: usize,
    /// Samples to the one before, of the same band.
    pub apart: usize,
    /// Bytes a sample.
    pub bytes: usize,
    /// 1: none, 2: differences, 3: of floats.
    pub predictor: u16,
    /// Whether the file's bytes are the greatest first.
    pub big: bool,
}

/// Unpacks `packed` into native numbers that fill `to`.
pub(super) fn unpack(packed: &[u8], to: &mut [u8], rows: Rows) -> Result<(), &'static str> {
    let mut decoder = decode::Configuration::with_tiff_size_switch(BitOrder::Msb, 8).build();
    let (mut read, mut written) = (0, 0);
    while written < to.len() {
        let result = decoder.decode_bytes(&packed[read..], &mut to[written..]);
        read += result.consumed_in;
        written += result.consumed_out;
        match result.status {
            Ok(LzwStatus::Ok) if result.consumed_in + result.consumed_out > 0 => {}
            Ok(_) => break,
            Err(_) => return Err("its LZW codes make no sense"),
        }
    }
    if written < to.len() {
        return Err("its LZW codes end before its samples do");
    }
    let row = rows.samples * rows.bytes;
    let mut spare = vec![0; if rows.predictor == 3 { row } else { 0 }];
    for line in to.chunks_exact_mut(row) {
        match rows.predictor {
            3 => floats(line, &mut spare, rows),
            _ => {
                native(line, rows);
                if rows.predictor == 2 {
                    sums(line, rows);
                }
            }
        }
    }
    Ok(())
}

/// The file's byte order to the machine's.
fn native(line: &mut [u8], rows: Rows) {
    if rows.big != cfg!(target_endian = "big") {
        line.chunks_exact_mut(rows.bytes).for_each(<[u8]>::reverse);
    }
}

/// Each sample is the difference to the one before.
fn sums(line: &mut [u8], rows: Rows) {
    macro_rules! sums {
        ($number:ty, $size:expr) => {{
            let (samples, _) = line.as_chunks_mut::<$size>();
            for k in rows.apart..samples.len() {
                let before = <$number>::from_ne_bytes(samples[k - rows.apart]);
                let sum = <$number>::from_ne_bytes(samples[k]).wrapping_add(before);
                samples[k] = sum.to_ne_bytes();
            }
        }};
    }
    match rows.bytes {
        1 => sums!(u8, 1),
        2 => sums!(u16, 2),
        4 => sums!(u32, 4),
        _ => sums!(u64, 8),
    }
}

/// Bytes are differences to those before, all greatest bytes of a row first.
fn floats(line: &mut [u8], spare: &mut [u8], rows: Rows) {
    for k in rows.apart..line.len() {
        line[k] = line[k].wrapping_add(line[k - rows.apart]);
    }
    for (k, sample) in spare.chunks_exact_mut(rows.bytes).enumerate() {
        for (byte, to) in sample.iter_mut().enumerate() {
            *to = line[byte * rows.samples + k];
        }
        if cfg!(target_endian = "little") {
            sample.reverse();
        }
    }
    line.copy_from_slice(spare);
}
