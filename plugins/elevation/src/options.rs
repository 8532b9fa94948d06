//! How a file is read, where it does not say so itself. Serialisable: a scene file holds the same.

use crate::about::NumberType;
use crate::error::typed;
use serde::{Deserialize, Serialize};

/// Order of the bytes of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ByteOrder {
    /// The least first, as on PCs.
    #[default]
    Little,
    /// The greatest first, as "Mac" in Unity and Photoshop.
    Big,
}

/// A file of numbers without a header of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Raw {
    /// Columns and rows. Nothing in the file tells them.
    pub size: Option<[u32; 2]>,
    /// Kind of number; `None`: by the ending (`.raw` i16, `.r16` u16, `.r32` and `.f32` f32).
    pub number: Option<NumberType>,
    /// Order of bytes.
    pub order: ByteOrder,
    /// Bytes before the first sample.
    pub header: u64,
    /// Bytes after each row.
    pub row_padding: u64,
    /// Whether rows run from south to north.
    pub flip: bool,
}

/// Which number stands for no data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum NoData {
    /// What the file says, if it says so.
    #[default]
    File,
    /// None: every number is a height, also one that looks like no data.
    None,
    /// This number, besides that which the file names. NaN is allowed.
    Value(f64),
}

/// How a file is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Numbers without a header: whatever the file's content looks like.
    pub raw: Option<Raw>,
    /// Which number stands for no data.
    pub nodata: NoData,
    /// Which channel or band holds the heights, from 1; needed where there are several.
    pub band: Option<u32>,
    /// Every so many columns and rows one is taken, from the first; at least 1.
    pub every: u32,
    /// Most samples that are taken.
    pub max_samples: u64,
    /// Whether a projection that is not known is taken, without a distance in metres.
    pub any_projection: bool,
}

impl Options {
    /// Most samples that are taken unless another number is asked for: 16 385 × 16 385, 1 GiB.
    pub const MAX_SAMPLES: u64 = 16_385 * 16_385;
}

impl Options {
    /// The command that reads `file` like this, as it can be typed.
    pub(crate) fn command(&self, file: &str) -> String {
        let mut line = format!("dolomite heights {}", typed(file));
        let mut add = |words: String| {
            line.push(' ');
            line.push_str(&words);
        };
        if let Some(raw) = &self.raw {
            if let Some([columns, rows]) = raw.size {
                add(format!("--raw-size {columns}x{rows}"));
            }
            if let Some(number) = raw.number {
                add(format!("--raw-type {number}"));
            }
            if raw.order == ByteOrder::Big {
                add("--raw-order big".to_owned());
            }
            for (name, bytes) in [
                ("--raw-header", raw.header),
                ("--raw-row-padding", raw.row_padding),
            ] {
                if bytes != 0 {
                    add(format!("{name} {bytes}"));
                }
            }
            if raw.flip {
                add("--raw-flip".to_owned());
            }
        }
        if let Some(band) = self.band {
            add(format!("--band {band}"));
        }
        line
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            raw: None,
            nodata: NoData::File,
            band: None,
            every: 1,
            max_samples: Self::MAX_SAMPLES,
            any_projection: false,
        }
    }
}
