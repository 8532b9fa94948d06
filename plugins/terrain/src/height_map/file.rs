//! Height maps from files: 16-bit PNG, raw 16-bit, raw f32.

use super::error::check_size;
use super::{Filter, HeightMap, HeightMapError};
use bevy::math::DVec2;
use image::{
    ColorType, DynamicImage, ImageDecoder, ImageFormat, ImageReader, codecs::png::PngDecoder,
};
use serde::{Deserialize, Serialize};
use std::io::{Cursor, Read};
use std::path::Path;

/// Numbers of a raw file, little-endian, row after row, without a header.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RawFormat {
    /// Signed 16-bit.
    I16,
    /// Unsigned 16-bit.
    U16,
    /// 32-bit float.
    F32,
}

impl RawFormat {
    /// Bytes a sample.
    #[must_use]
    pub const fn bytes(self) -> u64 {
        match self {
            Self::I16 | Self::U16 => 2,
            Self::F32 => 4,
        }
    }
}

/// What kind of file a height map is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MapFormat {
    /// 16-bit grey PNG; numbers 0 to 65535.
    Png,
    /// Numbers without a header.
    Raw {
        /// Kind of number.
        format: RawFormat,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
}

/// A height map file and how it lies on the ground; what a scene file says of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeightMapFile {
    /// Path of the file.
    pub path: String,
    /// Kind of file.
    pub format: MapFormat,
    /// Metres a unit of the file's numbers.
    pub scale: f32,
    /// Height of the number 0, metres.
    pub offset: f32,
    /// Distance of columns and of rows, metres: 0.1 to 1e6.
    pub spacing: [f64; 2],
    /// Place of the middle of the map (x, z), metres.
    #[serde(default)]
    pub centre: [f64; 2],
    /// How heights between samples are found.
    #[serde(default)]
    pub filter: Filter,
}

impl HeightMapFile {
    /// Reads the file; a relative path is taken from `folder`.
    ///
    /// # Errors
    /// A [`HeightMapError`] with the path, the reason and what to do.
    pub fn load(&self, folder: &Path) -> Result<HeightMap, HeightMapError> {
        let path = folder.join(&self.path);
        let name = path.display().to_string();
        let read = |error: std::io::Error| HeightMapError::Read {
            file: name.clone(),
            reason: error.to_string(),
        };
        let file = std::fs::File::open(&path).map_err(read)?;
        // No valid file is longer than the largest map; never read more than that, and one byte
        // to tell that it is.
        let longest = 8 * HeightMap::MAX_SAMPLES as u64 + 1;
        let mut bytes = Vec::new();
        file.take(longest).read_to_end(&mut bytes).map_err(read)?;
        self.decode(&name, &bytes)
    }

    /// Makes the map from the file's bytes; `name` is what errors call it.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn decode(&self, name: &str, bytes: &[u8]) -> Result<HeightMap, HeightMapError> {
        let (width, height, numbers) = match self.format {
            MapFormat::Png => png(name, bytes)?,
            MapFormat::Raw {
                format,
                width,
                height,
            } => (width, height, raw(name, bytes, format, width, height)?),
        };
        let metres = |number: f32| number * self.scale + self.offset;
        let samples = numbers.into_iter().map(metres).collect();
        let spacing = DVec2::from_array(self.spacing);
        let steps = DVec2::new(f64::from(width - 1), f64::from(height - 1));
        let origin = DVec2::from_array(self.centre) - spacing * steps * 0.5;
        HeightMap::named(
            name,
            [width, height],
            samples,
            (origin, spacing),
            self.filter,
        )
    }
}

/// Width, height and numbers of a 16-bit grey PNG.
fn png(name: &str, bytes: &[u8]) -> Result<(u32, u32, Vec<f32>), HeightMapError> {
    let damaged = |error: image::ImageError| HeightMapError::Png {
        file: name.to_owned(),
        reason: error.to_string(),
    };
    // The header first: size and kind are refused before any pixel is unpacked.
    let header = PngDecoder::new(Cursor::new(bytes)).map_err(damaged)?;
    let (width, height) = header.dimensions();
    check_size(name, width, height)?;
    let found = match header.color_type() {
        ColorType::L16 => None,
        ColorType::L8 => Some("8-bit grey"),
        ColorType::La8 => Some("8-bit grey with alpha"),
        ColorType::Rgb8 => Some("8-bit colour"),
        ColorType::Rgba8 => Some("8-bit colour with alpha"),
        ColorType::La16 => Some("16-bit grey with alpha"),
        _ => Some("16-bit colour"),
    };
    if let Some(found) = found {
        return Err(HeightMapError::Depth {
            file: name.to_owned(),
            found,
        });
    }
    let mut reader = ImageReader::new(Cursor::new(bytes));
    reader.set_format(ImageFormat::Png);
    match reader.decode().map_err(damaged)? {
        DynamicImage::ImageLuma16(image) => Ok((
            width,
            height,
            image.into_raw().into_iter().map(f32::from).collect(),
        )),
        _ => Err(HeightMapError::Depth {
            file: name.to_owned(),
            found: "another depth than its header says",
        }),
    }
}

/// The numbers of a raw file.
fn raw(
    name: &str,
    bytes: &[u8],
    format: RawFormat,
    width: u32,
    height: u32,
) -> Result<Vec<f32>, HeightMapError> {
    check_size(name, width, height)?;
    let expected = u64::from(width) * u64::from(height) * format.bytes();
    let found = bytes.len() as u64;
    if found != expected {
        let sample_bytes = format.bytes();
        return Err(HeightMapError::RawLength {
            file: name.to_owned(),
            width,
            height,
            sample_bytes,
            expected,
            found,
        });
    }
    let (pairs, _) = bytes.as_chunks::<2>();
    let (quads, _) = bytes.as_chunks::<4>();
    Ok(match format {
        RawFormat::I16 => pairs
            .iter()
            .map(|b| f32::from(i16::from_le_bytes(*b)))
            .collect(),
        RawFormat::U16 => pairs
            .iter()
            .map(|b| f32::from(u16::from_le_bytes(*b)))
            .collect(),
        RawFormat::F32 => quads.iter().map(|b| f32::from_le_bytes(*b)).collect(),
    })
}
