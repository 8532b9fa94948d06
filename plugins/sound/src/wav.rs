//! Files in the format WAV (IBM and Microsoft, *Multimedia Programming Interface*, 1991): PCM of 8, 16, 24 and 32 bits,
//! floats of 32; channels are mixed to one.

use std::path::Path;

use crate::error::SoundError;
use crate::samples::{MOST_SAMPLES, Samples};

/// Codes of the formats that are read; the last stands for one of the others, which its extension says.
const PCM: u16 = 1;
const FLOAT: u16 = 3;
const EXTENSIBLE: u16 = 0xfffe;

/// Why bytes were refused: where, and the reason.
type Refusal = (usize, String);

/// How samples lie in a file.
#[derive(Clone, Copy, Debug)]
struct Format {
    code: u16,
    channels: u16,
    rate: u32,
    bits: u16,
}

/// Reads a file.
///
/// # Errors
/// [`SoundError::Read`] and [`SoundError::File`].
pub fn read(path: &Path) -> Result<Samples, SoundError> {
    let bytes = std::fs::read(path).map_err(|source| SoundError::Read {
        path: path.to_owned(),
        source,
    })?;
    parse(&bytes, path)
}

/// Reads the bytes of a file; `path` is named in errors.
///
/// # Errors
/// [`SoundError::File`].
pub fn parse(bytes: &[u8], path: &Path) -> Result<Samples, SoundError> {
    let refused = |(at, reason)| SoundError::File {
        path: path.to_owned(),
        at,
        reason,
    };
    let (format, data, at) = find(bytes).map_err(refused)?;
    let values = values(format, data, at).map_err(refused)?;
    Samples::new(format.rate, &values).map_err(|error| refused((at, error.to_string())))
}

fn short(bytes: &[u8], at: usize) -> Result<u16, Refusal> {
    let two = bytes.get(at..).and_then(|rest| rest.first_chunk());
    two.map(|two| u16::from_le_bytes(*two))
        .ok_or((at, "the file ends here".to_owned()))
}

fn long(bytes: &[u8], at: usize) -> Result<u32, Refusal> {
    let four = bytes.get(at..).and_then(|rest| rest.first_chunk());
    four.map(|four| u32::from_le_bytes(*four))
        .ok_or((at, "the file ends here".to_owned()))
}

/// The format, the bytes of the samples, and where they begin.
fn find(bytes: &[u8]) -> Result<(Format, &[u8], usize), Refusal> {
    if bytes.get(0..4) != Some(b"RIFF".as_slice()) || bytes.get(8..12) != Some(b"WAVE".as_slice()) {
        return Err((0, "this is no WAV".to_owned()));
    }
    let mut format = None;
    let mut at = 12;
    while at + 8 <= bytes.len() {
        let size = long(bytes, at + 4)? as usize;
        let body = at + 8;
        match &bytes[at..at + 4] {
            b"fmt " => format = Some(read_format(bytes, body, size)?),
            b"data" => {
                let format = format.ok_or((at, "samples come before their format".to_owned()))?;
                let data = bytes.get(body..body.saturating_add(size)).ok_or_else(|| {
                    (
                        at + 4,
                        format!(
                            "{size} bytes of samples are promised, {} are there",
                            bytes.len() - body
                        ),
                    )
                })?;
                return Ok((format, data, body));
            }
            _ => {}
        }
        // Chunks begin at even places.
        at = body.saturating_add(size).saturating_add(size & 1);
    }
    Err((at.min(bytes.len()), "there are no samples".to_owned()))
}

fn read_format(bytes: &[u8], at: usize, size: usize) -> Result<Format, Refusal> {
    let mut code = short(bytes, at)?;
    if code == EXTENSIBLE && size >= 26 {
        code = short(bytes, at + 24)?;
    }
    let format = Format {
        code,
        channels: short(bytes, at + 2)?,
        rate: long(bytes, at + 4)?,
        bits: short(bytes, at + 14)?,
    };
    let known = matches!(
        (format.code, format.bits),
        (PCM, 8 | 16 | 24 | 32) | (FLOAT, 32)
    );
    if !known {
        return Err((
            at,
            format!("format {} of {} bits is not read", format.code, format.bits),
        ));
    }
    if !(1..=64).contains(&format.channels) {
        return Err((
            at + 2,
            format!("{} channels are not 1 to 64", format.channels),
        ));
    }
    Ok(format)
}

fn values(format: Format, data: &[u8], at: usize) -> Result<Vec<f32>, Refusal> {
    let width = usize::from(format.bits / 8);
    let frame = width * usize::from(format.channels);
    if !data.len().is_multiple_of(frame) {
        return Err((at + data.len(), "the last sample is cut".to_owned()));
    }
    if data.len() / frame > MOST_SAMPLES {
        return Err((
            at,
            format!(
                "{} samples are more than {MOST_SAMPLES}",
                data.len() / frame
            ),
        ));
    }
    let one = |bytes: &[u8]| match *bytes {
        [a] => (f32::from(a) - 128.0) / 128.0,
        [a, b] => f32::from(i16::from_le_bytes([a, b])) / 32_768.0,
        [a, b, c] => (f64::from(i32::from_le_bytes([0, a, b, c])) / 2_147_483_648.0) as f32,
        [a, b, c, d] if format.code == FLOAT => f32::from_le_bytes([a, b, c, d]),
        [a, b, c, d] => (f64::from(i32::from_le_bytes([a, b, c, d])) / 2_147_483_648.0) as f32,
        // The widths above are all that `read_format` lets through.
        _ => 0.0,
    };
    let part = 1.0 / f32::from(format.channels);
    let mixed = data
        .chunks_exact(frame)
        .map(|frame| part * frame.chunks_exact(width).map(one).sum::<f32>());
    Ok(mixed.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::built_in;

    /// A file of 16 bits.
    fn file(code: u16, channels: u16, bits: u16, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"RIFF\0\0\0\0WAVEJUNK\x03\0\0\0abc\0fmt \x10\0\0\0".to_vec();
        bytes.extend(code.to_le_bytes());
        bytes.extend(channels.to_le_bytes());
        bytes.extend(8000_u32.to_le_bytes());
        bytes.extend([0; 6]);
        bytes.extend(bits.to_le_bytes());
        bytes.extend(b"data");
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(data);
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Vec<f32>, String> {
        parse(bytes, Path::new("test.wav"))
            .map(|samples| samples.values().collect())
            .map_err(|error| error.to_string())
    }

    #[test]
    fn every_width_gives_the_same_numbers() {
        let wanted = vec![0.0, 0.5, -1.0];
        assert_eq!(read(&file(1, 1, 8, &[128, 192, 0])).unwrap(), wanted);
        assert_eq!(
            read(&file(1, 1, 16, &[0, 0, 0, 0x40, 0, 0x80])).unwrap(),
            wanted
        );
        assert_eq!(
            read(&file(1, 1, 24, &[0, 0, 0, 0, 0, 0x40, 0, 0, 0x80])).unwrap(),
            wanted
        );
        let whole = [0, 0x4000_0000, i32::MIN].map(i32::to_le_bytes).concat();
        assert_eq!(read(&file(1, 1, 32, &whole)).unwrap(), wanted);
        let float = [0.0, 0.5, -1.0_f32].map(f32::to_le_bytes).concat();
        assert_eq!(read(&file(3, 1, 32, &float)).unwrap(), wanted);
        // Two channels are mixed.
        assert_eq!(read(&file(1, 2, 16, &[0, 0, 0, 0x40])).unwrap(), [0.25]);
    }

    #[test]
    fn what_is_broken_is_refused_with_its_place() {
        for (bytes, word) in [
            (vec![], "byte 0: this is no WAV"),
            (b"RIFF\0\0\0\0WAVE".to_vec(), "no samples"),
            (file(2, 1, 4, &[0; 4]), "format 2 of 4 bits"),
            (file(1, 0, 16, &[0; 4]), "0 channels"),
            (file(1, 1, 16, &[0; 3]), "the last sample is cut"),
            (file(1, 1, 16, &[]), "0 are not 1 to"),
            (file(3, 1, 32, &f32::NAN.to_le_bytes()), "number 0 is NaN"),
        ] {
            let error = read(&bytes).unwrap_err();
            assert!(
                error.contains(word) && error.contains("test.wav"),
                "{error}"
            );
        }
        let error = super::read(Path::new("no/such.wav"))
            .unwrap_err()
            .to_string();
        assert!(error.contains("no/such.wav"), "{error}");
    }

    /// Cut anywhere, or with any byte changed, a file is read or refused.
    #[test]
    fn broken_files_never_panic() {
        let whole = built_in::FILES[19].1;
        let mut refused = 0;
        for end in 0..whole.len() {
            refused += usize::from(parse(&whole[..end], Path::new("cut.wav")).is_err());
        }
        assert_eq!(
            refused,
            whole.len(),
            "a cut file lacks samples that it promises"
        );
        for at in 0..64 {
            for value in [0, 1, 0x7f, 0x80, 0xff] {
                let mut bytes = whole.to_vec();
                bytes[at] = value;
                let _ = parse(&bytes, Path::new("changed.wav"));
            }
        }
    }
}
