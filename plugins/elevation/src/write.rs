//! Files that are written: a hillshade, plain numbers, ESRI ASCII, GeoTIFF.

use crate::error::ElevationError;
use crate::georeference::{Crs, Georeference, Registration};
use crate::hillshade::hillshade;
use crate::input::ending;
use crate::samples::Elevation;
use ::tiff::encoder::{Compression, DeflateLevel, Predictor, TiffEncoder, colortype};
use ::tiff::tags::Tag;
use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

/// Longest side of a hillshade, pixels.
pub(crate) const MOST_PIXELS: u32 = 4096;

/// Writes the samples, or a picture of them, as the ending of `path` says: `.png` is a hillshade, `.f32` and `.r32` little-endian floats with
/// NaN where there is no data, `.r16` u16 and `.raw` i16 little-endian where the samples are such numbers, `.asc` ESRI ASCII, `.tif`
/// a GeoTIFF of floats. All in rows from north to south. Written beside it first and then renamed.
///
/// `spacing`: distance of samples, metres, for the hillshade; `None`: that of the file.
///
/// # Errors
/// [`ElevationError::Write`].
pub fn write(
    path: &Path,
    map: &Elevation,
    spacing: Option<[f64; 2]>,
) -> Result<(), ElevationError> {
    let name = path.display().to_string();
    let failed = |reason: String| ElevationError::Write {
        file: name.clone(),
        reason,
    };
    let beside = &beside_of(path);
    let kind = ending(&name);
    let written = || -> Result<(), String> {
        let text = |error: std::io::Error| error.to_string();
        // Before a file is made: what cannot be written leaves nothing behind.
        let whole: Option<fn(f32) -> Option<[u8; 2]>> = match kind.as_str() {
            "png" | "f32" | "r32" | "asc" | "tif" | "tiff" => None,
            "r16" => Some(exact_u16),
            "raw" => Some(exact_i16),
            other => {
                return Err(format!(
                    "nothing is written as .{other}; write .png, .f32, .r32, .r16, .raw, .asc or .tif"
                ));
            }
        };
        let mut to = BufWriter::new(File::create(beside).map_err(text)?);
        match (kind.as_str(), whole) {
            (_, Some(whole)) => integers(&mut to, map, whole)?,
            ("png", _) => picture(&mut to, map, spacing).map_err(|error| error.to_string())?,
            ("asc", _) => ascii(&mut to, map)?,
            ("tif" | "tiff", _) => geotiff(&mut to, map).map_err(|error| error.to_string())?,
            _ => {
                for sample in &map.samples {
                    to.write_all(&sample.to_le_bytes()).map_err(text)?;
                }
            }
        }
        to.into_inner()
            .map_err(|error| error.to_string())?
            .sync_all()
            .map_err(text)?;
        std::fs::rename(beside, path).map_err(text)
    };
    written().map_err(|reason| {
        // Perhaps it was never made.
        let _ = std::fs::remove_file(beside);
        failed(reason)
    })
}

/// What grows beside a file until it is whole.
pub(crate) fn beside_of(path: &Path) -> PathBuf {
    let mut beside = path.as_os_str().to_owned();
    beside.push(format!(".{}.part", std::process::id()));
    PathBuf::from(beside)
}

/// Bytes of a sample that is a whole number from 0 to 65 535.
pub(crate) fn exact_u16(sample: f32) -> Option<[u8; 2]> {
    exact(sample, 0.0, 65_535.0).map(|n| (n as u16).to_le_bytes())
}

/// Bytes of a sample that is a whole number from −32 768 to 32 767.
pub(crate) fn exact_i16(sample: f32) -> Option<[u8; 2]> {
    exact(sample, -32_768.0, 32_767.0).map(|n| (n as i16).to_le_bytes())
}

/// The sample, if it is a whole number of the range.
fn exact(sample: f32, low: f32, high: f32) -> Option<f32> {
    (sample.fract() == 0.0 && (low..=high).contains(&sample)).then_some(sample)
}

fn integers(
    to: &mut impl Write,
    map: &Elevation,
    whole: fn(f32) -> Option<[u8; 2]>,
) -> Result<(), String> {
    for (at, &sample) in map.samples.iter().enumerate() {
        let bytes = whole(sample).ok_or_else(|| {
            let columns = map.size[0] as usize;
            format!(
                "the sample in column {}, row {} is {sample}, which 16-bit integers cannot hold; write .f32",
                at % columns,
                at / columns
            )
        })?;
        to.write_all(&bytes).map_err(|error| error.to_string())?;
    }
    Ok(())
}

fn picture(
    to: &mut impl Write,
    map: &Elevation,
    spacing: Option<[f64; 2]>,
) -> Result<(), png::EncodingError> {
    let unit = map.about.unit_metres.unwrap_or(1.0);
    let spacing = spacing.or_else(|| map.spacing()).unwrap_or_else(|| {
        // Nothing tells slopes: the relief is a tenth of the width.
        let relief = map
            .about
            .range
            .map_or(1.0, |[low, high]| f64::from(high - low) * unit);
        let side = f64::from(map.size[0].max(map.size[1]));
        [(10.0 * relief / side).max(1e-6); 2]
    });
    let every = map.size[0].max(map.size[1]).div_ceil(MOST_PIXELS);
    let (size, shades) = hillshade(&map.samples, map.size, (spacing, unit), every);
    shade_picture(to, size, shades)
}

/// A hillshade as PNG; transparent where there is no data.
pub(crate) fn shade_picture(
    to: &mut impl Write,
    [wide, high]: [u32; 2],
    shades: Vec<Option<u8>>,
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(to, wide, high);
    let holed = shades.iter().any(Option::is_none);
    encoder.set_color(if holed {
        png::ColorType::GrayscaleAlpha
    } else {
        png::ColorType::Grayscale
    });
    encoder.set_depth(png::BitDepth::Eight);
    let pixels: Vec<u8> = if holed {
        let pixel = |shade: Option<u8>| shade.map_or([0, 0], |shade| [shade, 255]);
        shades.into_iter().flat_map(pixel).collect()
    } else {
        shades.into_iter().flatten().collect()
    };
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()
}

/// A number that no sample is.
fn unused(map: &Elevation) -> f32 {
    let mut candidates = [-9999.0, -99_999.0, -999_999.0, f32::MIN].into_iter();
    let unused = candidates.find(|n| map.about.range.is_none_or(|[low, _]| *n < low));
    unused.unwrap_or(f32::MIN)
}

fn ascii(to: &mut impl Write, map: &Elevation) -> Result<(), String> {
    let mut lines = || -> std::io::Result<()> {
        let [columns, rows] = map.size;
        writeln!(to, "ncols {columns}\nnrows {rows}")?;
        if let Some(Georeference { first, step, .. }) = &map.georeference {
            let south = first[1] - step[1] * f64::from(rows - 1);
            writeln!(to, "xllcenter {}\nyllcenter {south}", first[0])?;
            if step[0] == step[1] {
                writeln!(to, "cellsize {}", step[0])?;
            } else {
                writeln!(to, "dx {}\ndy {}", step[0], step[1])?;
            }
        }
        let nodata = unused(map);
        if map.about.holes > 0 {
            writeln!(to, "NODATA_value {nodata}")?;
        }
        for line in map.samples.chunks(columns as usize) {
            for (column, sample) in line.iter().enumerate() {
                let blank = if column == 0 { "" } else { " " };
                let sample = if sample.is_nan() { nodata } else { *sample };
                write!(to, "{blank}{sample}")?;
            }
            writeln!(to)?;
        }
        Ok(())
    };
    lines().map_err(|error| error.to_string())
}

fn geotiff(to: &mut (impl Write + Seek), map: &Elevation) -> ::tiff::TiffResult<()> {
    let mut encoder = TiffEncoder::new(to)?
        .with_compression(Compression::Deflate(DeflateLevel::Balanced))
        .with_predictor(Predictor::None);
    let mut image = encoder.new_image::<colortype::Gray32Float>(map.size[0], map.size[1])?;
    let tags = image.encoder();
    if map.about.holes > 0 {
        tags.write_tag(Tag::GdalNodata, "nan")?;
    }
    if let Some(georeference) = &map.georeference {
        let ([x, y], [dx, dy]) = (georeference.first, georeference.step);
        // (0, 0) of an area's raster is its north-western corner.
        let (half, raster) = match georeference.registration {
            Registration::Point => (0.0, 2),
            Registration::Area => (0.5, 1),
        };
        tags.write_tag(Tag::ModelPixelScaleTag, &[dx, dy, 0.0][..])?;
        let tie = [0.0, 0.0, 0.0, x - half * dx, y + half * dy, 0.0];
        tags.write_tag(Tag::ModelTiepointTag, &tie[..])?;
        let code = |epsg: &Option<u32>| epsg.and_then(|code| u16::try_from(code).ok());
        let mut keys: Vec<[u16; 4]> = vec![[1025, 0, 1, raster]];
        match &georeference.crs {
            Crs::Degrees { epsg, .. } => {
                keys.insert(0, [1024, 0, 1, 2]);
                keys.push([2048, 0, 1, code(epsg).unwrap_or(4326)]);
                keys.push([2054, 0, 1, 9102]);
            }
            Crs::Projected { epsg, unit, .. } => {
                keys.insert(0, [1024, 0, 1, 1]);
                keys.push([3072, 0, 1, code(epsg).unwrap_or(32_767)]);
                let unit = match *unit {
                    crate::georeference::FOOT => 9002,
                    crate::georeference::US_FOOT => 9003,
                    _ => 9001,
                };
                keys.push([3076, 0, 1, unit]);
            }
            Crs::Unknown => {}
        }
        let unit = map.about.unit_metres.and_then(|unit| match unit {
            1.0 => Some(9001),
            crate::georeference::FOOT => Some(9002),
            crate::georeference::US_FOOT => Some(9003),
            _ => None,
        });
        keys.extend(unit.map(|unit| [4099, 0, 1, unit]));
        let head = [1, 1, 0, keys.len() as u16];
        let directory: Vec<u16> = head.into_iter().chain(keys.into_iter().flatten()).collect();
        tags.write_tag(Tag::GeoKeyDirectoryTag, &directory[..])?;
    }
    image.write_data(&map.samples)
}
