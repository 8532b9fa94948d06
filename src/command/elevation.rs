//! How a file of elevation is read, on the command line: the same for `dolomite heights` and `--scene`.

use std::str::FromStr;

use clap::{Args, ValueEnum};
use dolomite::terrain::elevation::{ByteOrder, NoData, NumberType, Options, Raw};

/// The numbers of a raw file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RawType {
    /// Unsigned 8-bit.
    U8,
    /// Signed 16-bit.
    I16,
    /// Unsigned 16-bit.
    U16,
    /// Unsigned 32-bit.
    U32,
    /// 32-bit float.
    F32,
}

/// Order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RawOrder {
    /// The least first ("Windows").
    Little,
    /// The greatest first ("Mac").
    Big,
}

/// Columns and rows: `4097x4097`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples(pub [u32; 2]);

impl FromStr for Samples {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "write COLUMNSxROWS, for example 4097x4097".to_owned();
        let (columns, rows) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
        let side = |text: &str| text.parse::<u32>().map_err(|_| wrong());
        Ok(Self([side(columns)?, side(rows)?]))
    }
}

/// A number that stands for no data, or `none`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Void(pub NoData);

impl FromStr for Void {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.eq_ignore_ascii_case("none") {
            return Ok(Self(NoData::None));
        }
        let number = text.parse().map_err(|_| {
            "write a number, nan, or none where every number is a height".to_owned()
        })?;
        Ok(Self(NoData::Value(number)))
    }
}

/// How a file of elevation is read.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Height map")]
pub struct ReadArgs {
    /// Raw file: columns and rows.
    #[arg(long, alias = "size-of-raw", value_name = "COLUMNSxROWS")]
    raw_size: Option<Samples>,
    /// Raw file: its numbers, where the ending does not tell (.raw is i16, .r16 is u16, .r32 and .f32 are f32).
    #[arg(long, value_enum)]
    raw_type: Option<RawType>,
    /// Raw file: the order of bytes [default: little].
    #[arg(long, value_enum)]
    raw_order: Option<RawOrder>,
    /// Raw file: bytes before the first sample.
    #[arg(long, value_name = "BYTES")]
    raw_header: Option<u64>,
    /// Raw file: bytes after each row.
    #[arg(long, value_name = "BYTES")]
    raw_row_padding: Option<u64>,
    /// Raw file: rows run from south to north.
    #[arg(long)]
    raw_flip: bool,
    /// The number that stands for no data (nan is one), or none: every number is a height.
    #[arg(long, value_name = "NUMBER|none", allow_hyphen_values = true)]
    nodata: Option<Void>,
    /// Which channel or band holds the heights, from 1, where there are several.
    #[arg(long, value_name = "N")]
    band: Option<u32>,
    /// Take every so many columns and rows.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    every: Option<u32>,
}

impl ReadArgs {
    /// The same for the reader of files. `spacing`: whether the distance of samples is given, so that an unknown
    /// projection does not matter.
    pub fn options(&self, spacing: bool) -> Options {
        let any = self.raw_size.is_some()
            || self.raw_type.is_some()
            || self.raw_order.is_some()
            || self.raw_header.is_some()
            || self.raw_row_padding.is_some()
            || self.raw_flip;
        let raw = Raw {
            size: self.raw_size.map(|Samples(size)| size),
            number: self.raw_type.map(|number| match number {
                RawType::U8 => NumberType::U8,
                RawType::I16 => NumberType::I16,
                RawType::U16 => NumberType::U16,
                RawType::U32 => NumberType::U32,
                RawType::F32 => NumberType::F32,
            }),
            order: match self.raw_order {
                Some(RawOrder::Big) => ByteOrder::Big,
                _ => ByteOrder::Little,
            },
            header: self.raw_header.unwrap_or(0),
            row_padding: self.raw_row_padding.unwrap_or(0),
            flip: self.raw_flip,
        };
        Options {
            raw: any.then_some(raw),
            nodata: self.nodata.map_or(NoData::File, |Void(nodata)| nodata),
            band: self.band,
            every: self.every.unwrap_or(1),
            any_projection: spacing,
            ..Options::default()
        }
    }
}
