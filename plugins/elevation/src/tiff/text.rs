//! Tags of a TIFF that hold text.

use ::tiff::decoder::ifd::Value;
use ::tiff::tags::Tag;

use super::Tiff;
use super::failure::Failure;
use crate::error::ElevationError;

/// A text tag, without the zeros at its end.
pub(super) fn text(
    tiff: &mut Tiff<'_>,
    tag: Tag,
    failure: &Failure<'_>,
) -> Result<Option<String>, ElevationError> {
    let fail = |error| failure.of(&format!("tag {tag:?}"), error);
    let text = match tiff.find_tag(tag).map_err(fail)? {
        None => return Ok(None),
        Some(Value::Ascii(text)) => text,
        Some(other) => String::from_utf8_lossy(&other.into_u8_vec().map_err(fail)?).into_owned(),
    };
    Ok(Some(text.trim_end_matches('\0').to_owned()))
}
