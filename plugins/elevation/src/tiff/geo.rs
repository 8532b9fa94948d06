//! Where a GeoTIFF's samples lie (OGC 19-008r4): pixel scale and tie point, or a transformation, and keys.

use super::Tiff;
use super::failure::Failure;
use super::text::text;
use crate::error::ElevationError;
use crate::georeference::{Crs, FOOT, Registration, US_FOOT};
use crate::lattice::{Lattice, Own, refused};
use crate::options::Options;
use ::tiff::tags::Tag;
use std::collections::BTreeMap;

/// Keys that are looked at.
mod key {
    pub const MODEL: u16 = 1024;
    pub const RASTER: u16 = 1025;
    pub const CITATION: u16 = 1026;
    pub const GEOGRAPHIC: u16 = 2048;
    pub const GEOGRAPHIC_CITATION: u16 = 2049;
    pub const ANGLE: u16 = 2054;
    pub const PROJECTED: u16 = 3072;
    pub const PROJECTED_CITATION: u16 = 3073;
    pub const METHOD: u16 = 3075;
    pub const LENGTH: u16 = 3076;
    pub const LENGTH_SIZE: u16 = 3077;
    pub const VERTICAL: u16 = 4096;
    pub const VERTICAL_UNIT: u16 = 4099;
}

/// Stands for "user-defined" in a key.
const USER: u16 = 32_767;

/// Tags on place, as they are.
pub(super) struct Keys {
    shorts: BTreeMap<u16, u16>,
    doubles: BTreeMap<u16, f64>,
    names: BTreeMap<u16, String>,
    scale: Option<Vec<f64>>,
    ties: Option<Vec<f64>>,
    matrix: Option<Vec<f64>>,
    /// Metres a unit of height.
    pub vertical: Option<f64>,
}

/// Metres a unit, by the EPSG's code of it.
fn unit(code: u16) -> Option<f64> {
    Some(match code {
        9001 => 1.0,
        9002 => FOOT,
        9003 => US_FOOT,
        9005 => 0.304_797_265_4, // Clarke's foot
        9036 => 1000.0,
        9041 => 0.914_398_530_744_440_8 / 3.0, // Sears' foot, of 1922
        _ => return None,
    })
}

/// Metres a unit of projected coordinate systems that files name without their unit.
fn unit_of_projection(epsg: u32) -> Option<f64> {
    match epsg {
        // UTM: WGS 84, WGS 72, NAD 83, NAD 27, ETRS 89, ED 50, SIRGAS, GDA, NZGD and others that count in metres.
        32_601..=32_661 | 32_701..=32_761 | 32_201..=32_260 | 32_301..=32_360 => Some(1.0),
        26_901..=26_923 | 26_701..=26_722 | 25_828..=25_838 | 23_028..=23_038 => Some(1.0),
        31_965..=31_985 | 28_348..=28_358 | 7_846..=7_859 => Some(1.0),
        // Web and world Mercator, Europe, polar.
        3_857 | 3_785 | 3_395 | 3_035 | 3_034 | 3_031 | 3_413 | 3_995 | 3_976 | 6_933 | 54_009 => {
            Some(1.0)
        }
        // France, Britain, Ireland, Belgium, Netherlands, Switzerland, Austria, Germany, Italy, Spain, Nordic lands,
        // Poland, Czechia, New Zealand, Japan, Canada, United States' Albers.
        2_154 | 27_700 | 2_157 | 29_902 | 31_370 | 3_812 | 28_992 | 2_056 | 21_781 => Some(1.0),
        31_254..=31_259 | 31_284..=31_287 | 31_466..=31_469 | 5_650..=5_653 => Some(1.0),
        3_003 | 3_004 | 3_006 | 3_067 | 5_972..=5_975 | 2_180 | 5_514 | 2_193 => Some(1.0),
        2_443..=2_461 | 6_669..=6_687 | 3_978 | 3_979 | 5_070 | 6_350 | 3_577 => Some(1.0),
        // State planes of the United States in survey feet.
        2_225..=2_230 | 2_232..=2_248 | 2_261..=2_264 => Some(US_FOOT),
        2_222..=2_224 | 2_265 | 2_266 => Some(FOOT),
        _ => None,
    }
}

/// Whether the length of a metre on the map grows with the latitude.
fn is_mercator(epsg: Option<u32>, method: Option<u16>) -> bool {
    matches!(
        epsg,
        Some(3_857 | 3_785 | 3_395 | 900_913 | 102_100 | 102_113)
    ) || (epsg.is_none() && method == Some(7))
}

impl Keys {
    pub(super) fn read(tiff: &mut Tiff<'_>, failure: &Failure<'_>) -> Result<Self, ElevationError> {
        let mut reals = |tag: Tag| -> Result<Option<Vec<f64>>, ElevationError> {
            let fail = |error| failure.of(&format!("tag {tag:?}"), error);
            let value = tiff.find_tag(tag).map_err(fail)?;
            value
                .map(|value| value.into_f64_vec().map_err(fail))
                .transpose()
        };
        let scale = reals(Tag::ModelPixelScaleTag)?;
        let ties = reals(Tag::ModelTiepointTag)?;
        let matrix = reals(Tag::ModelTransformationTag)?;
        let parameters = reals(Tag::GeoDoubleParamsTag)?.unwrap_or_default();
        let letters = text(tiff, Tag::GeoAsciiParamsTag, failure)?.unwrap_or_default();
        let directory = tiff
            .find_tag_unsigned_vec::<u16>(Tag::GeoKeyDirectoryTag)
            .map_err(|error| failure.of("tag GeoKeyDirectoryTag", error))?
            .unwrap_or_default();
        let mut keys = Self {
            shorts: BTreeMap::new(),
            doubles: BTreeMap::new(),
            names: BTreeMap::new(),
            scale,
            ties,
            matrix,
            vertical: None,
        };
        let (entries, _) = directory.get(4..).unwrap_or_default().as_chunks::<4>();
        for &[id, place, count, value] in entries {
            let at = usize::from(value);
            match place {
                0 => {
                    keys.shorts.insert(id, value);
                }
                34_736 => {
                    let value = parameters.get(at).copied();
                    keys.doubles.extend(value.map(|value| (id, value)));
                }
                34_737 => {
                    let name = letters.get(at..(at + usize::from(count)).min(letters.len()));
                    let name = name.unwrap_or_default().trim_end_matches(['|', '\0']);
                    keys.names.insert(id, name.to_owned());
                }
                _ => {}
            }
        }
        let by_unit = keys.short(key::VERTICAL_UNIT).and_then(unit);
        keys.vertical = by_unit.or(match keys.short(key::VERTICAL) {
            // EGM 96, EGM 2008, NAVD 88, EVRF, DHHN and others in metres.
            Some(5_773 | 3_855 | 5_703 | 5_621 | 5_730 | 5_783 | 7_837 | 5_701 | 5_720 | 5_728) => {
                Some(1.0)
            }
            Some(6_360) => Some(US_FOOT),
            Some(8_228) => Some(FOOT),
            _ => None,
        });
        Ok(keys)
    }

    fn short(&self, id: u16) -> Option<u16> {
        self.shorts.get(&id).copied()
    }

    /// A code that is one, neither 0 nor "user-defined".
    fn code(&self, id: u16) -> Option<u32> {
        self.short(id)
            .filter(|&code| code != 0 && code != USER)
            .map(u32::from)
    }

    fn registration(&self) -> Option<Registration> {
        match self.short(key::RASTER) {
            Some(1) => Some(Registration::Area),
            Some(2) => Some(Registration::Point),
            _ => None,
        }
    }

    /// Columns and rows on the ground, if the tags tell it.
    fn lattice(&self, file: &str) -> Result<Option<Lattice>, ElevationError> {
        let registration = self.registration().unwrap_or(Registration::Area);
        // The raster's (0, 0) is a sample's centre, or the north-western corner of one.
        let half = match registration {
            Registration::Point => 0.0,
            Registration::Area => 0.5,
        };
        let (tag, lattice) = match (&self.matrix, &self.scale, &self.ties) {
            (Some(m), _, _) if m.len() >= 16 => {
                let numbers = [[m[3], m[0], m[1]], [m[7], m[4], m[5]]];
                let lattice = Lattice::upright(numbers, half, registration);
                ("ModelTransformationTag", lattice)
            }
            (_, Some(scale), Some(ties)) if scale.len() >= 2 && ties.len() >= 6 => {
                let step = [scale[0], scale[1]];
                let lattice = Lattice {
                    first: [
                        ties[3] + (half - ties[0]) * step[0],
                        ties[4] - (half - ties[1]) * step[1],
                    ],
                    step,
                    registration,
                };
                ("ModelPixelScaleTag", lattice.checked())
            }
            (None, None, Some(ties)) if ties.len() > 6 => {
                let reason = format!(
                    "{} points tie it to the ground, which is not that of a grid",
                    ties.len() / 6
                );
                return Err(refused(file, "ModelTiepointTag", reason, "gdalwarp -tps"));
            }
            _ => return Ok(None),
        };
        let lattice = lattice.map_err(|reason| refused(file, tag, reason, "gdalwarp"))?;
        Ok(Some(lattice))
    }

    fn crs(&self, file: &str, options: &Options) -> Result<Crs, ElevationError> {
        let unknown = |tag: &str, name: String| ElevationError::Projection {
            file: file.to_owned(),
            again: options.command(file),
            tag: tag.to_owned(),
            name,
        };
        let name = |ids: [u16; 2]| {
            let mut names = ids.iter().filter_map(|id| self.names.get(id));
            names.next().cloned().unwrap_or_default()
        };
        let model = self.short(key::MODEL).or_else(|| {
            let has = |id| self.code(id).is_some();
            (has(key::PROJECTED).then_some(1)).or(has(key::GEOGRAPHIC).then_some(2))
        });
        match model {
            Some(2) => {
                if let Some(angle) = self.short(key::ANGLE)
                    && !matches!(angle, 9_102 | 9_122)
                {
                    return Err(unknown(
                        "GeogAngularUnitsGeoKey",
                        format!("in angles of code {angle}"),
                    ));
                }
                Ok(Crs::Degrees {
                    epsg: self.code(key::GEOGRAPHIC),
                    name: name([key::GEOGRAPHIC_CITATION, key::CITATION]),
                })
            }
            Some(1) => {
                let epsg = self.code(key::PROJECTED);
                let name = name([key::PROJECTED_CITATION, key::CITATION]);
                let called = || match epsg {
                    Some(code) => format!("EPSG:{code}"),
                    None if name.is_empty() => "without a name".to_owned(),
                    None => format!("{name:?}"),
                };
                let metres = match (self.short(key::LENGTH), epsg) {
                    (Some(USER), _) => self.doubles.get(&key::LENGTH_SIZE).copied(),
                    (Some(code), _) => unit(code),
                    (None, Some(epsg)) => unit_of_projection(epsg),
                    (None, None) => None,
                };
                let metres = metres.filter(|m| *m > 0.0 && m.is_finite());
                let tag = match self.short(key::LENGTH) {
                    Some(_) => "ProjLinearUnitsGeoKey",
                    None => "ProjectedCRSGeoKey",
                };
                let unit = metres.ok_or_else(|| unknown(tag, called()))?;
                let mercator = is_mercator(epsg, self.short(key::METHOD));
                Ok(Crs::Projected {
                    epsg,
                    name,
                    unit,
                    mercator,
                })
            }
            Some(0) | None => Ok(Crs::Unknown),
            Some(3) => Err(unknown("GTModelTypeGeoKey", "geocentric".to_owned())),
            Some(USER) => Ok(Crs::Unknown),
            Some(other) => Err(unknown("GTModelTypeGeoKey", format!("of model {other}"))),
        }
    }
}

/// What the tags say, for whoever puts it together with what stands beside the file.
pub(super) struct OwnPlace<'a> {
    pub keys: &'a Keys,
    pub file: &'a str,
    pub options: &'a Options,
}

impl Own for OwnPlace<'_> {
    fn lattice(&self) -> Result<Option<Lattice>, ElevationError> {
        self.keys.lattice(self.file)
    }

    fn crs(&self) -> Result<Option<Crs>, ElevationError> {
        match self.keys.crs(self.file, self.options) {
            Err(ElevationError::Projection { .. }) if self.options.any_projection => {
                Ok(Some(Crs::Unknown))
            }
            crs => crs.map(Some),
        }
    }

    fn registration(&self) -> Option<Registration> {
        self.keys.registration()
    }

    fn tag(&self) -> &'static str {
        "ModelTiepointTag"
    }
}
