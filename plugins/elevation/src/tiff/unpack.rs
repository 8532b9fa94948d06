//! How the bytes of a chunk are packed: not at all, LZW, deflate, PackBits, ZSTD.
//!
//! A chunk is unpacked whole, or as many of its rows as lie in the map: the `tiff` crate (0.11.3) reads rows of tiles that reach
//! over the map's edge in small pieces, and its LZW reader then loses the end of some ("no lzw end code found").

use flate2::read::ZlibDecoder;
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;
use weezl::{BitOrder, LzwStatus, decode};

/// Fills `to` from packed bytes. `reversed`: the first of packed bits is the lowest of a byte.
pub(super) fn unpack(
    compression: u16,
    reversed: bool,
    packed: &[u8],
    to: &mut [u8],
) -> Result<(), String> {
    let packed = if reversed {
        Cow::Owned(packed.iter().map(|byte| byte.reverse_bits()).collect())
    } else {
        Cow::Borrowed(packed)
    };
    match compression {
        1 => match packed.get(..to.len()) {
            Some(bytes) => to.copy_from_slice(bytes),
            None => return Err("it is too short".to_owned()),
        },
        5 => lzw(&packed, to)?,
        32_773 => pack_bits(&packed, to)?,
        50_000 => {
            let mut decoder = StreamingDecoder::new(&packed[..]).map_err(|e| e.to_string())?;
            decoder.read_exact(to).map_err(|error| error.to_string())?;
        }
        _ => {
            let mut decoder = ZlibDecoder::new(&packed[..]);
            decoder.read_exact(to).map_err(|error| error.to_string())?;
        }
    }
    Ok(())
}

fn lzw(packed: &[u8], to: &mut [u8]) -> Result<(), &'static str> {
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
    Ok(())
}

/// A length n from 0 to 127: n + 1 bytes; from −127 to −1: the next byte 1 − n times; −128 is nothing (TIFF 6.0, section 9).
fn pack_bits(mut packed: &[u8], to: &mut [u8]) -> Result<(), &'static str> {
    const SHORT: &str = "its PackBits runs end before its samples do";
    let mut written = 0;
    while written < to.len() {
        let (&length, rest) = packed.split_first().ok_or(SHORT)?;
        let room = to.len() - written;
        packed = match length as i8 {
            -128 => rest,
            run @ -127..=-1 => {
                let (&byte, rest) = rest.split_first().ok_or(SHORT)?;
                let count = usize::from(1 + run.unsigned_abs()).min(room);
                to[written..written + count].fill(byte);
                written += count;
                rest
            }
            literal => {
                let count = 1 + literal as usize;
                let bytes = rest.get(..count).ok_or(SHORT)?;
                let taken = count.min(room);
                to[written..written + taken].copy_from_slice(&bytes[..taken]);
                written += taken;
                &rest[count..]
            }
        };
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unpacked(compression: u16, packed: &[u8], count: usize) -> Result<Vec<u8>, String> {
        let mut to = vec![0; count];
        unpack(compression, false, packed, &mut to).map(|()| to)
    }

    #[test]
    fn pack_bits_of_the_specification() {
        // The example of TIFF 6.0, section 9.
        let packed = [
            0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa, 0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7,
            0xaa,
        ];
        let wanted = [
            0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0x22,
            0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa,
        ];
        assert_eq!(unpacked(32_773, &packed, 24).as_deref(), Ok(&wanted[..]));
        // A run that goes on beyond what is asked for, and one that is nothing.
        assert_eq!(unpacked(32_773, &[0x80, 0xfe, 7], 2), Ok(vec![7, 7]));
        for cut in 0..packed.len() {
            assert!(unpacked(32_773, &packed[..cut], 24).is_err(), "{cut}");
        }
    }

    #[test]
    fn what_is_too_short_is_an_error() {
        for compression in [1, 5, 8, 32_773, 32_946, 50_000] {
            assert!(unpacked(compression, &[], 1).is_err(), "{compression}");
            assert!(unpacked(compression, &[0x28], 4).is_err(), "{compression}");
        }
        assert_eq!(unpacked(1, &[1, 2, 3], 2), Ok(vec![1, 2]));
        let mut to = [0];
        unpack(1, true, &[0b0000_0110], &mut to).expect("a byte");
        assert_eq!(to, [0b0110_0000], "the first bit is the lowest");
    }
}
