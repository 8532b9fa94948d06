//! Errors of a TIFF, with the file and the place.

use ::tiff::TiffError;

use crate::error::{ElevationError, typed};

/// Error in a place of a file.
pub(super) struct Failure<'a> {
    pub(super) file: &'a str,
}

impl Failure<'_> {
    pub(super) fn damaged(
        &self,
        place: impl Into<String>,
        reason: impl Into<String>,
    ) -> ElevationError {
        ElevationError::Damaged {
            file: self.file.to_owned(),
            kind: "TIFF",
            place: place.into(),
            reason: reason.into(),
        }
    }

    pub(super) fn unsupported(&self, what: impl Into<String>, options: &str) -> ElevationError {
        ElevationError::Unsupported {
            file: self.file.to_owned(),
            what: what.into(),
            convert: format!("gdal_translate {options} {} readable.tif", typed(self.file)),
        }
    }

    pub(super) fn of(&self, place: &str, error: TiffError) -> ElevationError {
        match error {
            TiffError::UnsupportedError(what) => {
                self.unsupported(what.to_string(), "-co COMPRESS=DEFLATE")
            }
            TiffError::IoError(error)
                if !matches!(
                    error.kind(),
                    std::io::ErrorKind::UnexpectedEof
                        | std::io::ErrorKind::InvalidData
                        | std::io::ErrorKind::InvalidInput
                        | std::io::ErrorKind::Other
                ) =>
            {
                crate::error::read_error(self.file, &error)
            }
            error => self.damaged(place, error.to_string()),
        }
    }
}
