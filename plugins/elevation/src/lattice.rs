//! Columns and rows on the ground, before it is known what the numbers of their places are.

use crate::error::{ElevationError, typed};
use crate::georeference::{Crs, Georeference, Registration};

/// Where samples lie, in whatever units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lattice {
    /// Place of the first sample's centre, (east, north).
    pub first: [f64; 2],
    /// Distance of columns and of rows.
    pub step: [f64; 2],
    /// What a sample stands for.
    pub registration: Registration,
}

impl Lattice {
    /// That of six numbers: x is `x[0] + x[1] column + x[2] row`, and y likewise. `half`: how many columns and rows the first
    /// sample's centre lies from (0, 0).
    ///
    /// # Errors
    /// A reason: rows that do not run from west to east, columns that do not run from north to south.
    pub fn upright(
        [x, y]: [[f64; 3]; 2],
        half: f64,
        registration: Registration,
    ) -> Result<Self, String> {
        if x[2] != 0.0 || y[1] != 0.0 {
            return Err("its rows do not run from west to east".to_owned());
        }
        let step = [x[1], -y[2]];
        let lattice = Self {
            first: [x[0] + half * step[0], y[0] - half * step[1]],
            step,
            registration,
        };
        lattice.checked()
    }

    /// The same, if samples can lie so.
    ///
    /// # Errors
    /// A reason: steps that are not above 0, and what is not finite.
    pub fn checked(self) -> Result<Self, String> {
        let Self { first, step, .. } = self;
        if step[0] > 0.0 && step[1] > 0.0 && step.iter().chain(&first).all(|n| n.is_finite()) {
            return Ok(self);
        }
        Err(format!(
            "steps of {} and {} from ({}, {}), but columns must run to the east and rows to the south",
            step[0], step[1], first[0], first[1]
        ))
    }

    /// The same in a coordinate system.
    ///
    /// # Errors
    /// A reason: a place that there is not in degrees.
    pub fn within(self, crs: Crs) -> Result<Georeference, String> {
        let Self {
            first,
            step,
            registration,
        } = self;
        if let Crs::Degrees { .. } = crs
            && !(first[1] <= 91.0 && first[0].abs() <= 540.0 && step[1] <= 90.0)
        {
            return Err(format!(
                "({}, {}) is no place in degrees",
                first[0], first[1]
            ));
        }
        Ok(Georeference {
            crs,
            first,
            step,
            registration,
        })
    }
}

/// The error of a place that cannot be used; `command` is GDAL's that makes one which can.
pub(crate) fn refused(file: &str, tag: &str, reason: String, command: &str) -> ElevationError {
    ElevationError::Georeference {
        file: file.to_owned(),
        tag: tag.to_owned(),
        reason,
        convert: format!("{command} {} north-up.tif", typed(file)),
    }
}

/// What goes first where a file and the `.aux.xml` beside it say different things: in GDAL 3.9.3, asked file by file, a TIFF
/// takes what is beside it, an ESRI ASCII grid, an HGT file and a PNG what they say themselves
/// (`findings/gdal_aux_over_some_formats.sh`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum First {
    /// The `.aux.xml`.
    Beside,
    /// The file.
    File,
}

/// What a file itself says of where its samples lie. Asked for as far as nothing else goes before it.
pub(crate) trait Own {
    /// Columns and rows on the ground.
    fn lattice(&self) -> Result<Option<Lattice>, ElevationError> {
        Ok(None)
    }

    /// What the numbers of its places are.
    fn crs(&self) -> Result<Option<Crs>, ElevationError> {
        Ok(None)
    }

    /// What a sample stands for.
    fn registration(&self) -> Option<Registration> {
        None
    }

    /// Whether it goes before an `.aux.xml` beside it.
    fn first(&self) -> First {
        First::Beside
    }

    /// What tells its place, for errors.
    fn tag(&self) -> &'static str {
        "its place"
    }
}

/// Of a file that says nothing.
pub(crate) struct Nowhere;

impl Own for Nowhere {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_numbers_are_a_place_or_a_reason() {
        let area = Registration::Area;
        let plain = [[100.0, 10.0, 0.0], [200.0, 0.0, -5.0]];
        let lattice = Lattice::upright(plain, 0.5, area).expect("north is up");
        assert_eq!(lattice.first, [105.0, 197.5]);
        assert_eq!(lattice.step, [10.0, 5.0]);
        let lattice = Lattice::upright(plain, 0.0, area).expect("north is up");
        assert_eq!(lattice.first, [100.0, 200.0]);
        for (wrong, words) in [
            ([[0.0, 10.0, 0.1], [0.0, 0.0, -5.0]], "west to east"),
            ([[0.0, 10.0, 0.0], [0.0, 0.1, -5.0]], "west to east"),
            ([[0.0, 0.0, 10.0], [0.0, 5.0, 0.0]], "west to east"),
            ([[0.0, 10.0, 0.0], [0.0, 0.0, 5.0]], "rows to the south"),
            ([[0.0, -10.0, 0.0], [0.0, 0.0, -5.0]], "rows to the south"),
            ([[0.0, 0.0, 0.0], [0.0, 0.0, -5.0]], "rows to the south"),
            (
                [[f64::NAN, 1.0, 0.0], [0.0, 0.0, -5.0]],
                "rows to the south",
            ),
            (
                [[0.0, f64::INFINITY, 0.0], [0.0, 0.0, -5.0]],
                "rows to the south",
            ),
            ([[0.0, 1.0, f64::NAN], [0.0, 0.0, -5.0]], "west to east"),
        ] {
            let reason = Lattice::upright(wrong, 0.5, area).expect_err("not north-up");
            assert!(reason.contains(words), "{reason}");
        }
    }

    #[test]
    fn places_in_degrees_lie_on_the_globe() {
        let degrees = || Crs::Degrees {
            epsg: None,
            name: String::new(),
        };
        let at = |first| Lattice {
            first,
            step: [0.1; 2],
            registration: Registration::Area,
        };
        assert!(at([15.0, 46.0]).within(degrees()).is_ok());
        assert!(at([412_355.0, 46.0]).within(degrees()).is_err());
        assert!(at([15.0, 5e6]).within(degrees()).is_err());
        assert!(at([412_355.0, 5e6]).within(Crs::Unknown).is_ok());
    }
}
