//! Where samples lie: coordinate system, place and step.

use crate::geodesy::{mercator_shrink, metres_per_degree};
use serde::Serialize;

/// What the numbers of a place are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Crs {
    /// Longitude and latitude in degrees.
    Degrees {
        /// Code of the EPSG, where the file names one.
        epsg: Option<u32>,
        /// Name, where the file has one.
        name: String,
    },
    /// East and north in a plane.
    Projected {
        /// Code of the EPSG, where the file names one.
        epsg: Option<u32>,
        /// Name, where the file has one.
        name: String,
        /// Metres a unit.
        unit: f64,
        /// Whether lengths have to be multiplied by the cosine of the latitude (Web Mercator).
        mercator: bool,
    },
    /// Nothing says what the numbers are.
    Unknown,
}

impl Crs {
    /// What people call it.
    #[must_use]
    pub fn name(&self) -> String {
        let of = |kind: &str, epsg: Option<u32>, name: &str| match (epsg, name) {
            (Some(code), "") => format!("{kind} (EPSG:{code})"),
            (Some(code), name) => format!("{kind} (EPSG:{code}, {name})"),
            (None, "") => kind.to_owned(),
            (None, name) => format!("{kind} ({name})"),
        };
        match self {
            Self::Degrees { epsg, name } => of("degrees", *epsg, name),
            Self::Projected {
                epsg, name, unit, ..
            } => of(&unit_name(*unit), *epsg, name),
            Self::Unknown => "unknown units".to_owned(),
        }
    }

    /// Whether places of both can be compared.
    pub(crate) fn agrees(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Degrees { epsg: a, .. }, Self::Degrees { epsg: b, .. }) => {
                a.is_none() || b.is_none() || a == b
            }
            (
                Self::Projected {
                    epsg: a, unit: u, ..
                },
                Self::Projected {
                    epsg: b, unit: v, ..
                },
            ) => u == v && (a.is_none() || b.is_none() || a == b),
            (Self::Unknown, Self::Unknown) => true,
            _ => false,
        }
    }
}

/// Metres a US survey foot.
pub(crate) const US_FOOT: f64 = 1200.0 / 3937.0;
/// Metres a foot.
pub(crate) const FOOT: f64 = 0.3048;

/// Metres a unit, by its name in GDAL.
pub(crate) fn unit_by_name(name: &str) -> Option<f64> {
    Some(match name.to_ascii_lowercase().as_str() {
        "m" | "metre" | "meter" | "metres" | "meters" => 1.0,
        "ft" | "foot" | "feet" | "international foot" => FOOT,
        "us survey foot" | "us-ft" | "ussft" | "us survey feet" | "foot_us" => US_FOOT,
        "km" => 1000.0,
        "cm" => 0.01,
        "dm" => 0.1,
        _ => return None,
    })
}

/// The name of a unit of so many metres.
#[must_use]
pub(crate) fn unit_name(metres: f64) -> String {
    match metres {
        1.0 => "metres".to_owned(),
        FOOT => "feet".to_owned(),
        US_FOOT => "US survey feet".to_owned(),
        other => format!("units of {other} m"),
    }
}

/// What a sample stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Registration {
    /// The height at a point.
    Point,
    /// The mean height of a cell; its place is the cell's middle.
    Area,
}

/// Where samples lie. Exactly what the file says: nothing is rounded to metres here.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Georeference {
    /// What the numbers are.
    pub crs: Crs,
    /// Place of the first sample's centre, (east, north) in units of `crs`. It is the north-western one.
    pub first: [f64; 2],
    /// Distance of columns and of rows, in units of `crs`; both above 0.
    pub step: [f64; 2],
    /// What a sample stands for.
    pub registration: Registration,
}

impl Georeference {
    /// Distance of samples, metres, at the middle of a map of so many columns and rows. `None` where nothing says
    /// what the numbers are.
    #[must_use]
    pub fn spacing(&self, [_, rows]: [u32; 2]) -> Option<[f64; 2]> {
        let middle = self.first[1] - self.step[1] * 0.5 * f64::from(rows.saturating_sub(1));
        let [x, z] = self.step;
        match self.crs {
            Crs::Degrees { .. } => {
                let [east, north] = metres_per_degree(middle.clamp(-90.0, 90.0));
                Some([x * east, z * north])
            }
            Crs::Projected { unit, mercator, .. } => {
                let shrink = if mercator {
                    mercator_shrink(middle * unit)
                } else {
                    1.0
                };
                Some([x * unit * shrink, z * unit * shrink])
            }
            Crs::Unknown => None,
        }
    }

    /// The place of the middle of a map of so many columns and rows, in units of `crs`.
    #[must_use]
    pub fn middle(&self, [columns, rows]: [u32; 2]) -> [f64; 2] {
        let half = |count: u32| 0.5 * f64::from(count.saturating_sub(1));
        [
            self.first[0] + self.step[0] * half(columns),
            self.first[1] - self.step[1] * half(rows),
        ]
    }
}
