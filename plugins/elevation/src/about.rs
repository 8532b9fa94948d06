//! What a file turned out to be.

use crate::georeference::Georeference;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Kind of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FileKind {
    /// Numbers without a header.
    Raw,
    /// SRTM's own.
    Hgt,
    /// ESRI ASCII grid.
    Ascii,
    /// PNG.
    Png,
    /// TIFF of 4 GiB at most, GeoTIFF too.
    Tiff,
    /// TIFF with offsets of 64 bits.
    BigTiff,
}

impl FileKind {
    /// What people call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw numbers",
            Self::Hgt => "HGT",
            Self::Ascii => "ESRI ASCII grid",
            Self::Png => "PNG",
            Self::Tiff => "TIFF",
            Self::BigTiff => "BigTIFF",
        }
    }
}

/// Kind of a number in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NumberType {
    /// Unsigned, 8 bits or less.
    U8,
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 16 bits.
    I16,
    /// Unsigned, 32 bits.
    U32,
    /// Signed, 32 bits.
    I32,
    /// Unsigned, 64 bits.
    U64,
    /// Signed, 64 bits.
    I64,
    /// Float, 16 bits.
    F16,
    /// Float, 32 bits.
    F32,
    /// Float, 64 bits.
    F64,
    /// Decimal digits.
    Text,
}

impl NumberType {
    /// Bytes a number; 1 for digits.
    #[must_use]
    pub const fn bytes(self) -> u64 {
        match self {
            Self::U8 | Self::I8 | Self::Text => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Whether there are such numbers that f32 does not hold.
    pub(crate) const fn is_wide(self) -> bool {
        use NumberType::{F64, I32, I64, Text, U32, U64};
        matches!(self, U32 | I32 | U64 | I64 | F64 | Text)
    }
}

impl fmt::Display for NumberType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = format!("{self:?}");
        f.write_str(&name.to_lowercase())
    }
}

/// What the head of a file tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    /// Kind of the file.
    pub kind: FileKind,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Kind of its numbers.
    pub number: NumberType,
    /// Metres a unit of the heights, where the file tells the unit.
    pub unit_metres: Option<f64>,
}

impl Head {
    pub(crate) const fn new(
        kind: FileKind,
        size: [u32; 2],
        number: NumberType,
        unit_metres: Option<f64>,
    ) -> Self {
        Self {
            kind,
            size,
            number,
            unit_metres,
        }
    }
}

/// What a file says of itself, and what its samples are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct About {
    /// The file.
    pub file: String,
    /// Its kind.
    pub kind: FileKind,
    /// Columns and rows of the file.
    pub size: [u32; 2],
    /// Kind of its numbers.
    pub number: NumberType,
    /// How they are packed, for instance "deflate, predictor 2, 64 x 64 tiles".
    pub packing: String,
    /// Bands or channels.
    pub bands: u32,
    /// Numbers that stand for no data, from the file or a setting.
    pub nodata: Vec<Text64>,
    /// The file's own scale: a sample is number × scale + offset.
    pub scale: f64,
    /// The file's own offset.
    pub offset: f64,
    /// Metres a unit of the heights, where the file tells the unit.
    pub unit_metres: Option<f64>,
    /// Where the samples lie, where the file tells it.
    pub georeference: Option<Georeference>,
    /// Samples without data.
    pub holes: u64,
    /// Lowest and highest sample, in the file's unit after its own scale; `None` where all are holes.
    pub range: Option<[f32; 2]>,
    /// What one should know, a sentence each.
    pub notes: Vec<String>,
}

/// A number that JSON may not know: NaN is written as a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Text64(pub f64);

impl Serialize for Text64 {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_finite() {
            serializer.serialize_f64(self.0)
        } else {
            serializer.collect_str(&self.0)
        }
    }
}

impl fmt::Display for Text64 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}
