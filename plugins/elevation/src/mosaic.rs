//! Several maps that are one ground.
//!
//! Rule for what tiles share: where two tiles have a sample at one place, both must say the same number to the bit; where only
//! one of them has data there, that counts. What no tile covers has no data. So a mosaic of tiles cut from one map is that map,
//! and no seam can be seen.

use crate::error::ElevationError;
use crate::georeference::Georeference;
use crate::grid::check_size;
use crate::options::Options;

/// A map of a mosaic.
#[derive(Clone, Copy, Debug)]
pub struct Tile<'a> {
    /// What errors call it.
    pub name: &'a str,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Its samples, NaN where there is no data.
    pub samples: &'a [f32],
    /// Column and row of its first sample, from any common place.
    pub at: [i64; 2],
}

/// Columns, rows and samples of all tiles together, and where the first sample lies in the tiles' columns and rows.
///
/// # Errors
/// [`ElevationError::Border`] where two tiles disagree, [`ElevationError::TooLarge`] where together they are too large.
pub fn mosaic(
    tiles: &[Tile<'_>],
    options: &Options,
) -> Result<([u32; 2], Vec<f32>, [i64; 2]), ElevationError> {
    let Some(first) = tiles.first() else {
        return Err(ElevationError::Empty {
            file: "(no tiles)".to_owned(),
            columns: 0,
            rows: 0,
        });
    };
    let corner = [0, 1].map(|k| tiles.iter().map(|tile| tile.at[k]).min().unwrap_or(0));
    let end = |k: usize| {
        let ends = tiles
            .iter()
            .map(|tile| tile.at[k].saturating_add(tile.size[k].into()));
        ends.max().unwrap_or(0)
    };
    let size = [0, 1].map(|k| {
        let side = end(k).saturating_sub(corner[k]);
        u32::try_from(side).unwrap_or(u32::MAX)
    });
    check_size(
        first.name,
        size,
        &Options {
            every: 1,
            ..*options
        },
    )?;
    let width = size[0] as usize;
    let count = width * size[1] as usize;
    let mut samples: Vec<f32> = Vec::new();
    if samples.try_reserve_exact(count).is_err() {
        return Err(ElevationError::Memory {
            file: first.name.to_owned(),
            again: options.command(first.name),
            bytes: 4 * count as u64,
        });
    }
    samples.resize(count, f32::NAN);
    for (number, tile) in tiles.iter().enumerate() {
        let at = [0, 1].map(|k| (tile.at[k] - corner[k]) as usize);
        let lines = tile.samples.chunks(tile.size[0].max(1) as usize);
        for (row, line) in lines.enumerate() {
            let row = at[1] + row;
            let to = &mut samples[row * width + at[0]..][..line.len()];
            for (column, (to, from)) in to.iter_mut().zip(line).enumerate() {
                if to.is_nan() {
                    *to = *from;
                } else if !from.is_nan() && to.to_bits() != from.to_bits() {
                    let place = [at[0] + column, row];
                    let other = tiles[..number]
                        .iter()
                        .find(|other| other.covers(place, corner));
                    return Err(ElevationError::Border {
                        file: other.map_or("?", |other| other.name).to_owned(),
                        other: tile.name.to_owned(),
                        column: place[0] as u32,
                        row: place[1] as u32,
                        value: *to,
                        other_value: *from,
                    });
                }
            }
        }
    }
    Ok((size, samples, corner))
}

impl Tile<'_> {
    /// Whether it has data at a column and row of the mosaic.
    fn covers(&self, place: [usize; 2], corner: [i64; 2]) -> bool {
        let at = [0, 1].map(|k| place[k] as i64 + corner[k] - self.at[k]);
        let inside = (0..2).all(|k| (0..i64::from(self.size[k])).contains(&at[k]));
        inside && {
            let index = at[1] as usize * self.size[0] as usize + at[0] as usize;
            self.samples
                .get(index)
                .is_some_and(|sample| !sample.is_nan())
        }
    }
}

/// Columns and rows of each tile's first sample, counted from the first tile's, by where the files say that they lie.
///
/// # Errors
/// [`ElevationError::Tiles`] where the tiles do not lie on one grid: another coordinate system, another step, or
/// samples between those of the first.
pub fn place_by_georeference(
    tiles: &[(&str, &Georeference, [u32; 2])],
) -> Result<Vec<[i64; 2]>, ElevationError> {
    let Some(&(name, base, _)) = tiles.first() else {
        return Ok(Vec::new());
    };
    tiles
        .iter()
        .map(|&(other, place, size)| {
            let wrong = |reason: String| ElevationError::Tiles {
                file: name.to_owned(),
                other: other.to_owned(),
                reason,
            };
            if !base.crs.agrees(&place.crs) {
                return Err(wrong(format!(
                    "the one is in {}, the other in {}; convert one: `gdalwarp -t_srs CRS IN OUT.tif`",
                    base.crs.name(),
                    place.crs.name()
                )));
            }
            let mut at = [0; 2];
            for k in 0..2 {
                let (step, other) = (base.step[k], place.step[k]);
                // A hundredth of a step over the whole tile.
                if (step - other).abs() * f64::from(size[k]) > 0.01 * step {
                    return Err(wrong(format!(
                        "their samples are {step} and {other} apart; convert one: `gdalwarp -tr {} {} IN OUT.tif`",
                        base.step[0], base.step[1]
                    )));
                }
                let to_east_or_south = if k == 0 { 1.0 } else { -1.0 };
                let steps = to_east_or_south * (place.first[k] - base.first[k]) / step;
                let whole = steps.round();
                if (steps - whole).abs() > 0.01 || whole.abs() > 1e9 {
                    return Err(wrong(format!(
                        "the one begins {steps} samples from the other, but must lie on the same grid; convert one: `gdalwarp -tap -tr {} {} IN OUT.tif`",
                        base.step[0], base.step[1]
                    )));
                }
                at[k] = whole as i64;
            }
            Ok(at)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile<'a>(name: &'a str, samples: &'a [f32], columns: u32, at: [i64; 2]) -> Tile<'a> {
        let size = [columns, samples.len() as u32 / columns];
        Tile {
            name,
            size,
            samples,
            at,
        }
    }

    #[test]
    fn shared_samples_must_agree() {
        let options = Options::default();
        let (a, b) = ([1.0, 2.0, 3.0, 4.0], [2.0, 7.0, 4.0, 8.0]);
        let made = mosaic(
            &[tile("a", &a, 2, [5, -3]), tile("b", &b, 2, [6, -3])],
            &options,
        );
        let (size, samples, corner) = made.unwrap();
        assert_eq!((size, corner), ([3, 2], [5, -3]));
        assert_eq!(samples, [1.0, 2.0, 7.0, 3.0, 4.0, 8.0]);
        let gap = [f32::NAN, 7.0, 4.0, 8.0];
        let made = mosaic(
            &[tile("b", &gap, 2, [1, 0]), tile("a", &a, 2, [0, 0])],
            &options,
        );
        assert_eq!(made.unwrap().1, [1.0, 2.0, 7.0, 3.0, 4.0, 8.0]);
        let wrong = [2.0, 7.0, 4.0_f32.next_up(), 8.0];
        let made = mosaic(
            &[tile("a", &a, 2, [0, 0]), tile("b", &wrong, 2, [1, 0])],
            &options,
        );
        let error = made.unwrap_err();
        assert!(
            matches!(
                error,
                ElevationError::Border {
                    column: 1,
                    row: 1,
                    ..
                }
            ),
            "{error}"
        );
        let far = mosaic(
            &[
                tile("a", &a, 2, [0, 0]),
                tile("b", &b, 2, [i64::MAX - 9, 0]),
            ],
            &options,
        );
        assert!(matches!(far, Err(ElevationError::TooLarge { .. })));
        assert!(matches!(
            mosaic(&[], &options),
            Err(ElevationError::Empty { .. })
        ));
    }
}
