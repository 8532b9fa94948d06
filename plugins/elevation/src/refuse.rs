//! Samples that cannot be heights.

use crate::error::ElevationError;
use crate::extremes::{Extremes, is_customary};
use crate::options::{NoData, Options};

/// Refuses NaN without a word that it is no data, infinity, and numbers that can only be no data.
pub(crate) fn refuse(
    file: &str,
    options: &Options,
    columns: usize,
    samples: &[f32],
    (marked, found): (bool, &Extremes),
) -> Result<(), ElevationError> {
    let at = |index: usize| {
        let every = options.every.max(1);
        let place = [index % columns, index / columns];
        place.map(|n| n as u32 * every)
    };
    let find = |is: &dyn Fn(f32) -> bool| {
        let first = samples.iter().position(|&sample| is(sample));
        let count = samples.iter().filter(|&&sample| is(sample)).count();
        first.map(|first| (at(first), count as u64))
    };
    let again = || options.command(file);
    let not_finite = |value: f32, is: &dyn Fn(f32) -> bool| {
        find(is).map(|([column, row], count)| ElevationError::NotFinite {
            file: file.to_owned(),
            again: again(),
            value,
            column,
            row,
            count,
        })
    };
    // What was marked is NaN as well: only where nothing could mark is a NaN the file's own.
    if found.nan > 0
        && !marked
        && let Some(error) = not_finite(f32::NAN, &|s| s.is_nan())
    {
        return Err(error);
    }
    for infinite in [f32::INFINITY, f32::NEG_INFINITY] {
        if (found.low == infinite || found.high == infinite)
            && let Some(error) = not_finite(infinite, &|s| s == infinite)
        {
            return Err(error);
        }
    }
    if options.nodata == NoData::None {
        return Ok(());
    }
    for value in [found.low, found.high] {
        if !is_customary(value) {
            continue;
        }
        let mut others = Extremes::NONE;
        let parts = samples.chunks(1 << 16).map(|part| {
            let mut others = Extremes::NONE;
            for &sample in part.iter().filter(|&&sample| sample != value) {
                others.low = others.low.min(sample);
                others.high = others.high.max(sample);
            }
            others
        });
        for part in parts {
            others.join(part);
        }
        // Farther from all others than they are from each other, and than any step of a cliff.
        let apart = (value - others.high).max(others.low - value);
        if others.low <= others.high
            && apart > (others.high - others.low).max(100.0)
            && let Some(([column, row], count)) = find(&|s| s == value)
        {
            return Err(ElevationError::LooksLikeNoData {
                file: file.to_owned(),
                again: again(),
                value,
                column,
                row,
                count,
                low: others.low,
                high: others.high,
            });
        }
    }
    Ok(())
}
