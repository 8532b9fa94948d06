//! Kinds of pictures: PNG and JPEG are kept as they are, TGA and BMP are turned into PNG, others are
//! named.

use super::tga::Tga;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use image_of_old::codecs::bmp::BmpDecoder;
use image_of_old::{ColorType, ImageDecoder};
use std::io::{Cursor, Write};

/// Endings of pictures that can be carried over.
const ENDINGS: [&str; 5] = ["png", "jpg", "jpeg", "tga", "bmp"];

/// A picture that glTF can hold.
#[derive(Debug, PartialEq)]
pub(crate) enum Picture {
    /// As it is, of this kind.
    Kept(&'static str),
    /// Turned into this PNG.
    Turned(Vec<u8>),
}

/// What becomes of the picture in a file called `name`. Turning it may take `memory` bytes.
///
/// # Errors
/// A sentence: what it is, and the way out.
pub(crate) fn picture(name: &str, bytes: &[u8], memory: u64) -> Result<Picture, String> {
    if let Some(mime) = mime(bytes) {
        return Ok(Picture::Kept(mime));
    }
    let kind = kind(name, bytes);
    let turned = match kind {
        "BMP" => of_bmp(bytes, memory),
        "TGA" => of_tga(bytes, memory),
        "PNG" | "JPEG" => Err(Refusal::Broken("it is not whole".to_owned())),
        "unknown" if !can_be_saved_again(name) => {
            return Err("is no picture by its first bytes; save it again".to_owned());
        }
        _ => {
            return Err(format!(
                "is a picture of kind {kind}, which glTF does not hold; save it as PNG under the same name, in the same place"
            ));
        }
    };
    match turned {
        Ok(png) => Ok(Picture::Turned(png)),
        Err(Refusal::Broken(why)) => Err(format!("is a broken {kind}: {why}; save it again")),
        Err(Refusal::TooLarge(bytes)) => Err(format!(
            "is a {kind} that takes {bytes} bytes to turn into PNG, of {memory} that it may; save it as PNG, or raise the limit on memory"
        )),
    }
}

/// Names under which a picture that is called `name` may have been saved again, if its ending is of a
/// kind that cannot be carried over.
pub(crate) fn saved_again(name: &str) -> Vec<String> {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    match can_be_saved_again(name) {
        true => ENDINGS.iter().map(|e| format!("{stem}.{e}")).collect(),
        false => Vec::new(),
    }
}

fn can_be_saved_again(name: &str) -> bool {
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
    let lower = ending.to_lowercase();
    !stem.is_empty() && !ending.contains(['/', '\\']) && !ENDINGS.contains(&&*lower)
}

/// Whether the picture can be transparent anywhere.
pub(crate) fn has_alpha(bytes: &[u8]) -> bool {
    if mime(bytes) != Some("image/png") {
        return false;
    }
    // Colour types 4 and 6 have alpha; the others may have a colour that stands for it.
    matches!(bytes.get(25), Some(4 | 6)) || bytes.windows(4).any(|w| w == b"tRNS")
}

/// The kind of a PNG or JPEG whose header is whole.
pub(crate) fn mime(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(PNG) {
        let header = bytes.get(8..33)?;
        let size = |at: usize| {
            u32::from_be_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]])
        };
        let whole = size(0) == 13 && &header[4..8] == b"IHDR" && size(8) > 0 && size(12) > 0;
        return (whole && bytes.windows(4).any(|w| w == b"IDAT")).then_some("image/png");
    }
    (bytes.starts_with(JPEG) && has_jpeg_frame(bytes)).then_some("image/jpeg")
}

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";
const JPEG: &[u8] = &[0xff, 0xd8, 0xff];

/// First bytes of kinds of pictures.
const MAGICS: [(&[u8], &str); 12] = [
    (PNG, "PNG"),
    (JPEG, "JPEG"),
    (b"BM", "BMP"),
    (b"II*\0", "TIFF"),
    (b"MM\0*", "TIFF"),
    (b"8BPS", "PSD"),
    (b"DDS ", "DDS"),
    (b"\x76\x2f\x31\x01", "EXR"),
    (b"#?RADIANCE", "HDR"),
    (b"GIF8", "GIF"),
    (b"\xabKTX ", "KTX"),
    (b"RIFF", "WebP"),
];

fn kind(name: &str, bytes: &[u8]) -> &'static str {
    let magic = MAGICS.iter().find(|(magic, _)| bytes.starts_with(magic));
    if let Some((_, kind)) = magic {
        return kind;
    }
    // TGA has no first bytes of its own, and newer ones have last bytes.
    let ending = name.rsplit('.').next().unwrap_or_default().to_lowercase();
    let is_tga = bytes.ends_with(b"TRUEVISION-XFILE.\0")
        || ["tga", "targa", "vda", "icb", "vst"].contains(&&*ending);
    if is_tga { "TGA" } else { "unknown" }
}

/// Walks the segments up to the frame header (SOF0 to SOF15), which holds the size.
fn has_jpeg_frame(bytes: &[u8]) -> bool {
    let mut at = 2;
    while let Some(&[mark, kind, high, low]) = bytes.get(at..at + 4) {
        if mark != 0xff {
            return false;
        }
        let length = usize::from(u16::from_be_bytes([high, low]));
        if matches!(kind, 0xc0..=0xcf) && !matches!(kind, 0xc4 | 0xc8 | 0xcc) {
            let size = bytes.get(at + 5..at + 9);
            return size.is_some_and(|s| (s[0] | s[1]) != 0 && (s[2] | s[3]) != 0);
        }
        at += 2 + length.max(2);
    }
    false
}

/// Why a picture was not turned into PNG.
enum Refusal {
    Broken(String),
    /// It takes so many bytes.
    TooLarge(u64),
}

/// What is known of a fourth channel before the pixels are.
#[derive(Clone, Copy, PartialEq)]
enum Alpha {
    /// The file says that it is none.
    Unused,
    /// Many programs leave it at 0 everywhere, or at full.
    MayBeUnused,
}

fn of_bmp(bytes: &[u8], memory: u64) -> Result<Vec<u8>, Refusal> {
    let broken = |error: image_of_old::ImageError| Refusal::Broken(error.to_string());
    let decoder = BmpDecoder::new(Cursor::new(bytes)).map_err(broken)?;
    let shape = Shape {
        size: decoder.dimensions(),
        colour: match decoder.color_type() {
            ColorType::L8 => ExtendedColorType::L8,
            ColorType::Rgb8 => ExtendedColorType::Rgb8,
            ColorType::Rgba8 => ExtendedColorType::Rgba8,
            other => return Err(Refusal::Broken(format!("its pixels are {other:?}"))),
        },
        alpha: Alpha::MayBeUnused,
    };
    let read = |pixels: &mut [u8]| decoder.read_image(pixels).map_err(broken);
    turned(shape, read, bytes.len(), memory)
}

fn of_tga(bytes: &[u8], memory: u64) -> Result<Vec<u8>, Refusal> {
    let broken = |why: &str| Refusal::Broken(why.to_owned());
    let tga = Tga::of(bytes).map_err(broken)?;
    let shape = Shape {
        size: (tga.size.0.into(), tga.size.1.into()),
        colour: match tga.channels {
            1 => ExtendedColorType::L8,
            2 => ExtendedColorType::La8,
            3 => ExtendedColorType::Rgb8,
            _ => ExtendedColorType::Rgba8,
        },
        alpha: match tga.alpha_is_unused {
            true => Alpha::Unused,
            false => Alpha::MayBeUnused,
        },
    };
    let read = |pixels: &mut [u8]| tga.read(pixels).map_err(broken);
    turned(shape, read, bytes.len(), memory)
}

/// What is known of a picture before its pixels are.
struct Shape {
    /// Width and height, pixels.
    size: (u32, u32),
    colour: ExtendedColorType,
    alpha: Alpha,
}

/// As PNG. `read` fills in the pixels; `source` is the size of the file, which is in memory too.
fn turned(
    shape: Shape,
    read: impl FnOnce(&mut [u8]) -> Result<(), Refusal>,
    source: usize,
    memory: u64,
) -> Result<Vec<u8>, Refusal> {
    let Shape {
        size: (width, height),
        mut colour,
        alpha,
    } = shape;
    if width == 0 || height == 0 {
        return Err(Refusal::Broken("it has no pixel".to_owned()));
    }
    let (channels, without) = match colour {
        ExtendedColorType::Rgba8 => (4, ExtendedColorType::Rgb8),
        ExtendedColorType::La8 => (2, ExtendedColorType::L8),
        ExtendedColorType::Rgb8 => (3, colour),
        _ => (1, colour),
    };
    let raw = (u64::from(width) * u64::from(height)).saturating_mul(channels as u64);
    // Rarely is a PNG larger than the same picture in one of these formats.
    let room = raw.min(2 * source as u64) + (1 << 16);
    let needed = raw.saturating_add(source as u64).saturating_add(room);
    let Some(size) = usize::try_from(raw).ok().filter(|_| needed <= memory) else {
        return Err(Refusal::TooLarge(needed));
    };
    let mut pixels = vec![0; size];
    read(&mut pixels)?;
    let has_alpha = channels == 2 || channels == 4;
    if has_alpha && (alpha == Alpha::Unused || is_even(&pixels, channels)) {
        take_last(&mut pixels, channels);
        colour = without;
    }
    let room = memory.saturating_sub(raw + source as u64);
    let made = png(&pixels, (width, height), colour, room);
    made.ok_or_else(|| Refusal::TooLarge(raw.saturating_mul(2).saturating_add(source as u64)))
}

/// Pixels as a PNG of at most so many bytes.
pub(crate) fn png(
    pixels: &[u8],
    (width, height): (u32, u32),
    colour: ExtendedColorType,
    most: u64,
) -> Option<Vec<u8>> {
    let mut out = Capped {
        bytes: Vec::new(),
        most: usize::try_from(most).unwrap_or(usize::MAX),
    };
    let encoder =
        PngEncoder::new_with_quality(&mut out, CompressionType::Fast, FilterType::Adaptive);
    let written = encoder.write_image(pixels, width, height, colour);
    written.is_ok().then_some(out.bytes)
}

/// The last channel is 0 in all pixels, or full in all.
fn is_even(pixels: &[u8], channels: usize) -> bool {
    let last = || pixels.iter().skip(channels - 1).step_by(channels);
    last().all(|&alpha| alpha == 0) || last().all(|&alpha| alpha == 255)
}

/// Takes the last channel out of all pixels, in place.
fn take_last(pixels: &mut Vec<u8>, channels: usize) {
    let mut channel = 0;
    pixels.retain(|_| {
        channel = (channel + 1) % channels;
        channel != 0
    });
}

/// Bytes up to a limit.
struct Capped {
    bytes: Vec<u8>,
    most: usize,
}

impl Write for Capped {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if bytes.len() > self.most.saturating_sub(self.bytes.len()) {
            return Err(std::io::ErrorKind::OutOfMemory.into());
        }
        self.bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests;
