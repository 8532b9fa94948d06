//! Kinds of pictures: PNG and JPEG are kept as they are, TGA and BMP are turned into PNG, others are
//! named.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use image_of_old::codecs::bmp::BmpDecoder;
use image_of_old::codecs::tga::TgaDecoder;
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
        "BMP" => BmpDecoder::new(Cursor::new(bytes))
            .map_err(|error| Refusal::Broken(error.to_string()))
            .and_then(|decoder| turned(decoder, bytes.len(), memory, Alpha::MayBeUnused)),
        "TGA" => TgaDecoder::new(Cursor::new(bytes))
            .map_err(|error| Refusal::Broken(error.to_string()))
            .and_then(|decoder| {
                // The low four bits of the descriptor count the bits of alpha.
                let alpha = match bytes.get(17).is_some_and(|bits| bits & 15 == 0) {
                    true => Alpha::Unused,
                    false => Alpha::MayBeUnused,
                };
                turned(decoder, bytes.len(), memory, alpha)
            }),
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

/// As PNG. `source` is the size of the file, which is in memory too.
fn turned<'a>(
    decoder: impl ImageDecoder<'a>,
    source: usize,
    memory: u64,
    alpha: Alpha,
) -> Result<Vec<u8>, Refusal> {
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err(Refusal::Broken("it has no pixel".to_owned()));
    }
    let raw = decoder.total_bytes();
    // Rarely is a PNG larger than the same picture in one of these formats.
    let room = raw.min(2 * source as u64) + (1 << 16);
    let needed = raw.saturating_add(source as u64).saturating_add(room);
    let Some(size) = usize::try_from(raw).ok().filter(|_| needed <= memory) else {
        return Err(Refusal::TooLarge(needed));
    };
    let mut colour = match decoder.color_type() {
        ColorType::L8 => ExtendedColorType::L8,
        ColorType::La8 => ExtendedColorType::La8,
        ColorType::Rgb8 => ExtendedColorType::Rgb8,
        ColorType::Rgba8 => ExtendedColorType::Rgba8,
        other => return Err(Refusal::Broken(format!("its pixels are {other:?}"))),
    };
    let mut pixels = vec![0; size];
    decoder
        .read_image(&mut pixels)
        .map_err(|error| Refusal::Broken(error.to_string()))?;
    let (channels, without) = match colour {
        ExtendedColorType::Rgba8 => (4, ExtendedColorType::Rgb8),
        ExtendedColorType::La8 => (2, ExtendedColorType::L8),
        other => (1, other),
    };
    if channels > 1 && (alpha == Alpha::Unused || is_even(&pixels, channels)) {
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
mod tests {
    use super::*;

    /// Two by two pixels of a true-colour TGA: a row from the lower left, then one above.
    fn tga(bits: u8, alpha_bits: u8, pixels: &[u8]) -> Vec<u8> {
        let mut out = vec![
            0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, bits, alpha_bits,
        ];
        out.extend(pixels);
        out
    }

    fn decoded(picture: Result<Picture, String>) -> image::DynamicImage {
        match picture {
            Ok(Picture::Turned(png)) => {
                assert_eq!(mime(&png), Some("image/png"));
                image::load_from_memory(&png).expect("a PNG is read")
            }
            other => panic!("not turned: {other:?}"),
        }
    }

    #[test]
    fn a_tga_is_turned_with_its_rows_and_colours() {
        // Blue, green, red.
        let pixels = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];
        let made = decoded(picture("a.TGA", &tga(24, 0, &pixels), 1 << 20));
        assert_eq!(made.color(), image::ColorType::Rgb8);
        let made = made.to_rgb8();
        assert_eq!(made.get_pixel(0, 1).0, [3, 2, 1]);
        assert_eq!(made.get_pixel(1, 0).0, [12, 11, 10]);
        // By its footer, whatever it is called.
        let mut named = tga(24, 0, &pixels);
        named.extend([0; 8]);
        named.extend(b"TRUEVISION-XFILE.\0");
        decoded(picture("a", &named, 1 << 20));
    }

    #[test]
    fn alpha_is_kept_where_it_is_one() {
        let pixels: Vec<u8> = (0..4).flat_map(|i| [i, i, i, 60 * i]).collect();
        let with = decoded(picture("a.tga", &tga(32, 8, &pixels), 1 << 20));
        assert_eq!(with.to_rgba8().get_pixel(1, 1).0, [1, 1, 1, 60]);
        assert!(with.color().has_alpha());
        // The descriptor says that there is none, or nobody has set it.
        let unused = decoded(picture("a.tga", &tga(32, 0, &pixels), 1 << 20));
        assert!(!unused.color().has_alpha());
        let zero: Vec<u8> = (0..4).flat_map(|i| [i, i, i, 0]).collect();
        let even = decoded(picture("a.tga", &tga(32, 8, &zero), 1 << 20));
        assert!(!even.color().has_alpha());
        assert_eq!(even.to_rgb8().get_pixel(1, 1).0, [1, 1, 1]);
    }

    #[test]
    fn a_bmp_is_turned() {
        let mut bmp = Vec::new();
        let made = image::RgbImage::from_fn(3, 2, |x, y| image::Rgb([x as u8, y as u8, 7]));
        image_of_old::codecs::bmp::BmpEncoder::new(&mut bmp)
            .encode(&made, 3, 2, ColorType::Rgb8)
            .expect("it is written");
        assert_eq!(decoded(picture("a", &bmp, 1 << 20)).to_rgb8(), made);
    }

    #[test]
    fn bombs_and_broken_ones_are_refused() {
        // 65535 by 65535 pixels, run-length encoded, in 18 bytes.
        let mut bomb = tga(32, 8, &[]);
        bomb[2] = 10;
        bomb[12..16].fill(0xff);
        let said = picture("a.tga", &bomb, 1 << 26).unwrap_err();
        assert!(said.contains("raise the limit on memory"), "{said}");
        for name in ["a.tga", "a.bmp"] {
            for bytes in [&b"BM"[..], &[0; 30], &tga(24, 0, &[1]), &[]] {
                picture(name, bytes, 1 << 20).unwrap_err();
            }
        }
        // Noise, so that the PNG is no smaller than its pixels: what it may take holds for it too.
        let mut state = 1_u32;
        let noise: Vec<u8> = (0..3 << 16)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 24) as u8
            })
            .collect();
        let mut large = tga(24, 0, &noise);
        large[12..16].copy_from_slice(&[0, 1, 0, 1]);
        let bytes = large.len() as u64;
        assert!(picture("a.tga", &large, 2 * bytes).is_err());
        assert!(picture("a.tga", &large, 4 * bytes).is_ok());
    }

    #[test]
    fn other_kinds_are_named_with_a_way_out() {
        let cases: [(&[u8], &str); 5] = [
            (b"8BPS\0\x01", "PSD"),
            (b"II*\0\x08", "TIFF"),
            (b"DDS |", "DDS"),
            (b"\x76\x2f\x31\x01\x02", "EXR"),
            (b"what is this", "unknown"),
        ];
        for (bytes, kind) in cases {
            let said = picture("a.xyz", bytes, 1 << 20).unwrap_err();
            assert!(
                said.contains(kind) && said.contains("save it as PNG"),
                "{said}"
            );
        }
        assert_eq!(saved_again("tex/a.psd")[..2], ["tex/a.png", "tex/a.jpg"]);
        assert!(saved_again("a.PNG").is_empty() && saved_again("").is_empty());
        assert_eq!(saved_again("a")[0], "a.png");
    }

    #[test]
    fn broken_pictures_are_told_apart() {
        assert_eq!(mime(b"\x89PNG\r\n\x1a\n"), None);
        assert_eq!(mime(b"BM"), None);
        assert_eq!(mime(b""), None);
        assert_eq!(mime(&[0xff, 0xd8, 0xff, 0xe0, 0, 2]), None);
        let jpeg = [
            0xff, 0xd8, 0xff, 0xe0, 0, 2, 0xff, 0xc0, 0, 11, 8, 0, 1, 0, 1, 0,
        ];
        assert_eq!(mime(&jpeg), Some("image/jpeg"));
        let said = picture("a.png", b"\x89PNG\r\n\x1a\n", 1 << 20).unwrap_err();
        assert!(said.contains("broken PNG"), "{said}");
    }
}
