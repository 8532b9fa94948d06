//! Pictures of one channel each, put together as glTF wants them: roughness and metalness in one,
//! opacity in the alpha of the colour.

use super::pictures::{mime, png};
use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::PngDecoder;
use image::imageops::{FilterType, resize};
use image::{DynamicImage, ExtendedColorType, GrayImage, ImageDecoder, Limits, RgbImage};
use std::io::Cursor;

/// Why pictures were not put together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Refusal {
    /// They take more memory than they may.
    TooLarge,
    /// One of them cannot be decoded.
    Broken,
}

/// Metalness in blue and roughness in green, as a PNG; a channel without a picture is full. Of
/// roughness may be said that it is glossiness, the inverse. Takes `memory` bytes at most.
pub(crate) fn metal_rough(
    metal: Option<&[u8]>,
    rough: Option<(&[u8], bool)>,
    memory: u64,
) -> Result<Vec<u8>, Refusal> {
    // Five bytes a pixel of the result, and a channel that is enlarged.
    let all = metal.into_iter().chain(rough.map(|(bytes, _)| bytes));
    let (width, height) = common_size(all, 6, memory)?;
    let grey = |bytes: &[u8]| Ok(sized(decoded(bytes, memory)?.into_luma8(), width, height));
    let metal = metal.map(grey).transpose()?;
    let (rough, is_gloss) = match rough {
        Some((bytes, is_gloss)) => (Some(grey(bytes)?), is_gloss),
        None => (None, false),
    };
    let made = RgbImage::from_fn(width, height, |x, y| {
        let of =
            |picture: &Option<GrayImage>| picture.as_ref().map_or(255, |p| p.get_pixel(x, y).0[0]);
        let green = if is_gloss {
            255 - of(&rough)
        } else {
            of(&rough)
        };
        image::Rgb([255, green, of(&metal)])
    });
    png(
        made.as_raw(),
        (width, height),
        ExtendedColorType::Rgb8,
        memory,
    )
    .ok_or(Refusal::TooLarge)
}

/// The colour of one picture, or white, with the opacity of another: its alpha channel if it has one,
/// else its brightness. Takes `memory` bytes at most.
pub(crate) fn with_opacity(
    colour: Option<&[u8]>,
    opacity: &[u8],
    memory: u64,
) -> Result<Vec<u8>, Refusal> {
    let all = colour.into_iter().chain([opacity]);
    let (width, height) = common_size(all, 10, memory)?;
    let alpha = decoded(opacity, memory)?;
    let alpha = match alpha.color().has_alpha() {
        true => {
            let pixels = alpha.into_rgba8();
            GrayImage::from_fn(pixels.width(), pixels.height(), |x, y| {
                image::Luma([pixels.get_pixel(x, y).0[3]])
            })
        }
        false => alpha.into_luma8(),
    };
    let alpha = sized(alpha, width, height);
    let mut made = match colour {
        Some(bytes) => {
            let pixels = decoded(bytes, memory)?.into_rgba8();
            match pixels.dimensions() == (width, height) {
                true => pixels,
                false => resize(&pixels, width, height, FilterType::Triangle),
            }
        }
        None => image::RgbaImage::from_pixel(width, height, image::Rgba([255; 4])),
    };
    for (pixel, alpha) in made.pixels_mut().zip(alpha.pixels()) {
        pixel.0[3] = alpha.0[0];
    }
    png(
        made.as_raw(),
        (width, height),
        ExtendedColorType::Rgba8,
        memory,
    )
    .ok_or(Refusal::TooLarge)
}

/// The largest width and height. Decoding takes what the decoders say, and each pixel of the result so
/// many bytes.
fn common_size<'b>(
    all: impl Iterator<Item = &'b [u8]>,
    bytes_a_pixel: u64,
    memory: u64,
) -> Result<(u32, u32), Refusal> {
    let (mut width, mut height, mut decoded) = (1, 1, 0_u64);
    for bytes in all {
        let (size, total) = measured(bytes, memory)?;
        (width, height) = (width.max(size.0), height.max(size.1));
        // Four bytes a pixel in between, of pictures of fewer.
        let pixels = u64::from(size.0) * u64::from(size.1);
        decoded = decoded.saturating_add(total.max(4 * pixels));
    }
    let made = u64::from(width) * u64::from(height) * bytes_a_pixel;
    match decoded.saturating_add(made) <= memory {
        true => Ok((width, height)),
        false => Err(Refusal::TooLarge),
    }
}

fn measured(bytes: &[u8], memory: u64) -> Result<((u32, u32), u64), Refusal> {
    fn of(decoder: &impl ImageDecoder) -> ((u32, u32), u64) {
        (decoder.dimensions(), decoder.total_bytes())
    }
    match mime(bytes) {
        Some("image/png") => Ok(of(&png_decoder(bytes, memory)?)),
        Some(_) => Ok(of(
            &JpegDecoder::new(Cursor::new(bytes)).map_err(|_| Refusal::Broken)?
        )),
        None => Err(Refusal::Broken),
    }
}

fn png_decoder(bytes: &[u8], memory: u64) -> Result<PngDecoder<Cursor<&[u8]>>, Refusal> {
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(memory);
    PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(|_| Refusal::Broken)
}

/// A picture that was measured.
fn decoded(bytes: &[u8], memory: u64) -> Result<DynamicImage, Refusal> {
    let made = match mime(bytes) {
        Some("image/png") => DynamicImage::from_decoder(png_decoder(bytes, memory)?),
        _ => JpegDecoder::new(Cursor::new(bytes)).and_then(DynamicImage::from_decoder),
    };
    made.map_err(|_| Refusal::Broken)
}

fn sized(picture: GrayImage, width: u32, height: u32) -> GrayImage {
    match picture.dimensions() == (width, height) {
        true => picture,
        false => resize(&picture, width, height, FilterType::Triangle),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::ImageFormat;

    fn grey(size: u32, value: impl Fn(u32, u32) -> u8, format: ImageFormat) -> Vec<u8> {
        let picture = GrayImage::from_fn(size, size, |x, y| image::Luma([value(x, y)]));
        let mut out = Cursor::new(Vec::new());
        match format {
            ImageFormat::Bmp => {
                let grey = image_of_old::ColorType::L8;
                image_of_old::codecs::bmp::BmpEncoder::new(&mut out)
                    .encode(&picture, size, size, grey)
                    .expect("it is written");
                return out.into_inner();
            }
            ImageFormat::Tga => return packed_tga(size, &picture),
            _ => {}
        }
        picture.write_to(&mut out, format).expect("it is written");
        out.into_inner()
    }

    /// Grey, a packet for each row of at most 128 pixels.
    fn packed_tga(size: u32, pixels: &[u8]) -> Vec<u8> {
        let side = size as u8;
        let mut out = vec![
            0, 0, 11, 0, 0, 0, 0, 0, 0, 0, 0, 0, side, 0, side, 0, 8, 0x20,
        ];
        for row in pixels.chunks_exact(usize::from(side)) {
            out.push(side - 1);
            out.extend(row);
        }
        out
    }

    fn read(png: Result<Vec<u8>, Refusal>) -> DynamicImage {
        image::load_from_memory(&png.expect("it is made")).expect("it is a PNG")
    }

    #[test]
    fn roughness_is_green_and_metalness_blue() {
        let metal = grey(2, |x, _| 100 * x as u8, ImageFormat::Png);
        let rough = grey(4, |_, y| 60 * y as u8, ImageFormat::Png);
        let both = read(metal_rough(Some(&metal), Some((&rough, false)), 1 << 20)).to_rgb8();
        assert_eq!(both.dimensions(), (4, 4));
        assert_eq!(both.get_pixel(0, 2).0, [255, 120, 0]);
        assert_eq!(both.get_pixel(3, 0).0, [255, 0, 100]);
        let gloss = read(metal_rough(None, Some((&rough, true)), 1 << 20)).to_rgb8();
        assert_eq!(gloss.get_pixel(0, 2).0, [255, 135, 255]);
        let alone = read(metal_rough(Some(&metal), None, 1 << 20)).to_rgb8();
        assert_eq!(alone.get_pixel(1, 1).0, [255, 255, 100]);
    }

    #[test]
    fn opacity_is_alpha_or_brightness() {
        let mask = grey(2, |x, _| 200 * x as u8, ImageFormat::Jpeg);
        let white = read(with_opacity(None, &mask, 1 << 20)).to_rgba8();
        let [r, g, b, a] = white.get_pixel(1, 0).0;
        assert!((r, g, b) == (255, 255, 255) && a.abs_diff(200) < 8, "{a}");
        // The result has an alpha channel, which another picture is given.
        let whole = with_opacity(None, &mask, 1 << 20).expect("it is made");
        let colour = grey(2, |_, _| 7, ImageFormat::Png);
        let both = read(with_opacity(Some(&colour), &whole, 1 << 20)).to_rgba8();
        let [r, .., a] = both.get_pixel(1, 0).0;
        assert!(r == 7 && a.abs_diff(200) < 8, "{r} {a}");
    }

    #[test]
    fn too_large_and_broken_ones_are_refused() {
        let large = grey(256, |x, y| (x ^ y) as u8, ImageFormat::Png);
        let refused = metal_rough(Some(&large), None, 1 << 18);
        assert_eq!(refused, Err(Refusal::TooLarge));
        let mut cut = large.clone();
        cut.truncate(large.len() / 2);
        assert_eq!(
            with_opacity(Some(&cut), &large, 1 << 22),
            Err(Refusal::Broken)
        );
        assert_eq!(
            metal_rough(Some(b"BM"), None, 1 << 22),
            Err(Refusal::Broken)
        );
        // A header that claims four thousand million pixels.
        let mut bomb = large;
        bomb[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
        assert!(metal_rough(Some(&bomb), None, 1 << 26).is_err());
    }

    /// Pictures with bytes that are changed at random are put together or refused, and so are the ones
    /// that are turned into PNG.
    #[test]
    fn changed_bytes_are_no_panic() {
        let formats = [
            ("a.png", ImageFormat::Png),
            ("a.jpg", ImageFormat::Jpeg),
            ("a.tga", ImageFormat::Tga),
            ("a.bmp", ImageFormat::Bmp),
        ];
        let mut state = 7_u64;
        let mut random = |end: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as usize % end
        };
        let (mut sound, mut refused) = (0, 0);
        for (name, format) in formats {
            let whole = grey(24, |x, y| (x * y) as u8, format);
            for _ in 0..CHANGED {
                let mut bytes = whole.clone();
                for _ in 0..=random(4) {
                    // Headers are where it matters.
                    let end = if random(2) == 0 { 64 } else { bytes.len() };
                    let at = random(end.min(bytes.len()));
                    bytes[at] = random(256) as u8;
                }
                if random(8) == 0 {
                    bytes.truncate(random(bytes.len()));
                }
                let fine = match mime(&bytes) {
                    Some(_) => with_opacity(Some(&bytes), &bytes, 1 << 20).is_ok(),
                    None => super::super::pictures::picture(name, &bytes, 1 << 20).is_ok(),
                };
                *(if fine { &mut sound } else { &mut refused }) += 1;
            }
        }
        assert!(
            sound > CHANGED / 4 && refused > CHANGED / 4,
            "{sound} {refused}"
        );
    }

    /// Pictures of each kind that are changed.
    const CHANGED: usize = 500;
}
