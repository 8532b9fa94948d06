//! From file to file row by row: for maps that are larger than memory.

use crate::about::About;
use crate::error::ElevationError;
use crate::grid::Feed;
use crate::hillshade::hillshade;
use crate::input::ending;
use crate::options::Options;
use crate::progress::ElevationProgress;
use crate::samples::Elevation;
use crate::write::{MOST_PIXELS, beside_of, exact_i16, exact_u16, shade_picture};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Most bytes of rows that are held until they are complete.
const HELD: u64 = 1 << 30;

/// What samples become.
enum Kind {
    Floats,
    Integers(fn(f32) -> Option<[u8; 2]>),
    /// Every so many columns and rows are kept for a hillshade.
    Picture,
}

/// Reads a file of any size and writes its samples, or a picture of them, as the ending of `to` says: `.f32`, `.r32`, `.r16`, `.raw`, `.png` as
/// [`write`](crate::write()) does. `None`: nothing is written, and it is only said what the file is. `spacing` is for the hillshade.
///
/// # Errors
/// [`ElevationError`], as [`Elevation::read`] and [`write`](crate::write()).
pub fn convert(
    from: &Path,
    to: Option<&Path>,
    options: &Options,
    spacing: Option<[f64; 2]>,
    progress: &ElevationProgress,
) -> Result<About, ElevationError> {
    let options = Options {
        max_samples: crate::grid::MOST_SAMPLES,
        ..*options
    };
    let Some(to) = to else {
        let sink = |_, _, _: &[f32]| Ok(());
        return read(from, &options, progress, sink);
    };
    let name = to.display().to_string();
    let failed = |reason: String| ElevationError::Write {
        file: name.clone(),
        reason,
    };
    let kind = match ending(&name).as_str() {
        "f32" | "r32" => Kind::Floats,
        "r16" => Kind::Integers(exact_u16),
        "raw" => Kind::Integers(exact_i16),
        "png" => Kind::Picture,
        other => {
            return Err(failed(format!(
                "a map of this size is not written as .{other}; write .f32, .r16, .raw or .png"
            )));
        }
    };
    let beside = beside_of(to);
    let written = || -> Result<About, ElevationError> {
        let text = |error: std::io::Error| failed(error.to_string());
        let mut file = BufWriter::with_capacity(1 << 20, File::create(&beside).map_err(text)?);
        let mut small: Vec<f32> = Vec::new();
        let mut every = 1;
        let about = read(from, &options, progress, |size, first, samples| {
            let columns = size[0] as usize;
            every = size[0].max(size[1]).div_ceil(MOST_PIXELS);
            match kind {
                Kind::Floats => {
                    let bytes: Vec<u8> = samples.iter().flat_map(|s| s.to_le_bytes()).collect();
                    file.write_all(&bytes).map_err(text)
                }
                Kind::Integers(whole) => {
                    for (at, &sample) in samples.iter().enumerate() {
                        let bytes = whole(sample).ok_or_else(|| {
                            failed(format!(
                                "the sample in column {}, row {} is {sample}, which 16-bit integers cannot hold; write .f32",
                                at % columns,
                                first + at / columns
                            ))
                        })?;
                        file.write_all(&bytes).map_err(text)?;
                    }
                    Ok(())
                }
                Kind::Picture => {
                    let rows = samples.chunks(columns).enumerate();
                    let step = every as usize;
                    for (_, row) in rows.filter(|(k, _)| (first + k).is_multiple_of(step)) {
                        small.extend(row.iter().step_by(step));
                    }
                    Ok(())
                }
            }
        })?;
        if let Kind::Picture = kind {
            let size = about.size.map(|n| n.div_ceil(every));
            let unit = about.unit_metres.unwrap_or(1.0);
            let own = spacing.or_else(|| about.georeference.as_ref()?.spacing(about.size));
            let own = own.unwrap_or_else(|| {
                // Nothing tells slopes: the relief is a tenth of the width.
                let relief = about
                    .range
                    .map_or(1.0, |[low, high]| f64::from(high - low) * unit);
                [(10.0 * relief / f64::from(about.size[0].max(about.size[1]))).max(1e-6); 2]
            });
            let spacing = own.map(|metres| metres * f64::from(every));
            let (size, shades) = hillshade(&small, size, (spacing, unit), 1);
            shade_picture(&mut file, size, shades).map_err(|error| failed(error.to_string()))?;
        }
        let file = file
            .into_inner()
            .map_err(|error| failed(error.to_string()))?;
        file.sync_all().map_err(text)?;
        std::fs::rename(&beside, to).map_err(text)?;
        Ok(about)
    };
    written().inspect_err(|_| {
        // Perhaps it was never made.
        let _ = std::fs::remove_file(&beside);
    })
}

fn read<'a>(
    from: &Path,
    options: &Options,
    progress: &ElevationProgress,
    sink: impl FnMut([u32; 2], usize, &[f32]) -> Result<(), ElevationError> + 'a,
) -> Result<About, ElevationError> {
    let feed = Feed {
        progress: progress.clone(),
        sink: Some(Box::new(sink)),
        most: HELD,
        ..Feed::default()
    };
    Elevation::fed(from, options, feed).map(|read| read.about)
}
