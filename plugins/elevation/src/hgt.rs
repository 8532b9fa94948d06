//! SRTM's own files: big-endian i16, one degree square, named after their south-western corner.

use crate::about::{FileKind, NumberType};
use crate::error::ElevationError;
use crate::georeference::{Crs, Registration};
use crate::input::Input;
use crate::lattice::{First, Lattice, Own};
use crate::options::{ByteOrder, Raw};
use crate::raw;
use crate::samples::Elevation;
use crate::sidecars::Numbers;
use std::path::Path;

/// Columns and rows: 3, 1 and half an arc second, and 2 by 1 arc seconds as north of 50° N.
const SIZES: [[u32; 2]; 4] = [[1201, 1201], [3601, 3601], [7201, 7201], [1801, 3601]];

/// Columns and rows, which its length tells.
pub(crate) fn size(input: &Input<'_>) -> Result<[u32; 2], ElevationError> {
    let bytes = |[columns, rows]: &[u32; 2]| 2 * u64::from(*columns) * u64::from(*rows);
    let size = SIZES.into_iter().find(|size| bytes(size) == input.bytes);
    size.ok_or_else(|| ElevationError::Damaged {
        file: input.file.to_owned(),
        kind: "HGT",
        place: "its length".to_owned(),
        reason: format!(
            "{} bytes, but 1201 x 1201 samples are 2884802 and 3601 x 3601 are 25934402",
            input.bytes
        ),
    })
}

pub(crate) fn read(input: &mut Input<'_>) -> Result<Elevation, ElevationError> {
    let size = size(input)?;
    let layout = Raw {
        size: Some(size),
        number: Some(NumberType::I16),
        order: ByteOrder::Big,
        ..Raw::default()
    };
    let name = Path::new(input.file).file_stem().unwrap_or_default();
    let place = Degree {
        size,
        corner: corner(&name.to_string_lossy()),
    };
    let own = Numbers {
        nodata: vec![-32_768.0],
        unit: Some(1.0),
        ..Numbers::default()
    };
    let mut map = raw::read_with(input, &layout, own, &place)?;
    map.about.kind = FileKind::Hgt;
    if map.georeference.is_none() {
        map.about.notes.push(
            "its name is not that of a degree, such as N36W085.hgt, so where it lies is not known"
                .to_owned(),
        );
    }
    Ok(map)
}

/// The degree that a file is of, so far as its name tells it.
struct Degree {
    size: [u32; 2],
    corner: Option<[f64; 2]>,
}

impl Own for Degree {
    fn lattice(&self) -> Result<Option<Lattice>, ElevationError> {
        Ok(self.corner.map(|[east, north]| Lattice {
            first: [east, north + 1.0],
            step: self.size.map(|n| 1.0 / f64::from(n - 1)),
            registration: Registration::Point,
        }))
    }

    fn crs(&self) -> Result<Option<Crs>, ElevationError> {
        Ok(Some(Crs::Degrees {
            epsg: Some(4326),
            name: "WGS 84".to_owned(),
        }))
    }

    fn registration(&self) -> Option<Registration> {
        Some(Registration::Point)
    }

    fn first(&self) -> First {
        First::File
    }

    fn tag(&self) -> &'static str {
        "its name"
    }
}

/// Longitude and latitude of the south-western corner, from a name such as `N36W085` or `s01e012_v3`.
fn corner(name: &str) -> Option<[f64; 2]> {
    let name = name.to_ascii_lowercase();
    let number = |text: Option<&str>, most: f64| {
        let text = text?;
        let number: f64 = text
            .bytes()
            .all(|b| b.is_ascii_digit())
            .then(|| text.parse().ok())??;
        (number <= most).then_some(number)
    };
    let south = match name.get(..1)? {
        "n" => 1.0,
        "s" => -1.0,
        _ => return None,
    };
    let west = match name.get(3..4)? {
        "e" => 1.0,
        "w" => -1.0,
        _ => return None,
    };
    let after = name.get(7..)?.bytes().next();
    if after.is_some_and(|b| b.is_ascii_alphanumeric()) {
        return None;
    }
    Some([
        west * number(name.get(4..7), 180.0)?,
        south * number(name.get(1..3), 90.0)?,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_the_corner() {
        assert_eq!(corner("N36W085"), Some([-85.0, 36.0]));
        assert_eq!(corner("s01e012_v3"), Some([12.0, -1.0]));
        for wrong in [
            "", "N36", "N3xW085", "N36W0855", "X36W085", "N36W0é5", "N99W085", "N-1W085",
        ] {
            assert_eq!(corner(wrong), None, "{wrong}");
        }
    }
}
