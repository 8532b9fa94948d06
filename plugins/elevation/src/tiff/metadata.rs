//! What GDAL says of a TIFF in tags of its own: no data, scale, offset and unit.

use ::tiff::tags::Tag;

use super::Tiff;
use super::failure::Failure;
use super::text::text;
use crate::error::ElevationError;
use crate::georeference::unit_by_name;
use crate::number::number;
use crate::options::{NoData, Options};

/// XML with scale, offset and unit.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// The number that GDAL says is no data, unless a setting says what is.
pub(super) fn nodata(
    tiff: &mut Tiff<'_>,
    options: &Options,
    failure: &Failure<'_>,
) -> Result<Vec<f64>, ElevationError> {
    let Some(text) = text(tiff, Tag::GdalNodata, failure)? else {
        return Ok(Vec::new());
    };
    // GDAL reads the number that the text begins with.
    let Some(word) = text.split_whitespace().next() else {
        return Ok(Vec::new());
    };
    match number(word.as_bytes()) {
        Some(number) => Ok(vec![number]),
        None if options.nodata != NoData::File => Ok(Vec::new()),
        None => Err(ElevationError::NoDataText {
            file: failure.file.to_owned(),
            again: options.command(failure.file),
            text: text.chars().take(40).collect(),
        }),
    }
}

/// What GDAL's own XML says of the band.
pub(super) struct Metadata {
    /// Scale and offset.
    pub(super) scale: Option<(f64, f64)>,
    /// Metres a unit of height.
    pub(super) unit: Option<f64>,
}

impl Metadata {
    pub(super) fn read(
        tiff: &mut Tiff<'_>,
        band: u32,
        failure: &Failure<'_>,
    ) -> Result<Self, ElevationError> {
        let xml = text(tiff, GDAL_METADATA, failure)?.unwrap_or_default();
        let item = |role: &str| {
            let of_band = format!("sample=\"{band}\"");
            let items = xml.split("<Item").skip(1);
            let mut items = items.filter_map(|item| item.split_once('>'));
            let (_, rest) = items.find(|(attributes, _)| {
                attributes.contains(&format!("role=\"{role}\"")) && attributes.contains(&of_band)
            })?;
            Some(rest.split('<').next()?.trim().to_owned())
        };
        let number = |role| {
            let number: f64 = item(role)?.parse().ok()?;
            number.is_finite().then_some(number)
        };
        let scale = number("scale").filter(|&scale| scale != 0.0);
        let offset = number("offset");
        // One of both stands for both: the other is what changes nothing.
        let either = scale.is_some() || offset.is_some();
        Ok(Self {
            scale: either.then(|| (scale.unwrap_or(1.0), offset.unwrap_or(0.0))),
            unit: item("unittype").and_then(|name| unit_by_name(&name)),
        })
    }
}
