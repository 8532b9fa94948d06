//! FBX files as text and as bytes, written from a tree of records.
//!
//! A record has a name, values and records below it. [`ascii`] and [`binary`] write the same tree; arrays are values.

pub mod ascii;
pub mod binary;
mod document;

pub use document::{Ids, document};

/// A value of a record.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A whole number of 32 bits.
    Int(i32),
    /// A whole number of 64 bits: ids and times.
    Long(i64),
    /// A number.
    Double(f64),
    /// A letter.
    Letter(u8),
    /// Text; the two parts of a name are parted by `\0\1`, as in binary files.
    Text(String),
    /// Whole numbers of 32 bits.
    Ints(Vec<i32>),
    /// Whole numbers of 64 bits.
    Longs(Vec<i64>),
    /// Numbers of 32 bits.
    Floats(Vec<f32>),
    /// Numbers of 32 bits some of which are no numbers: text has their bits as whole numbers.
    Bits(Vec<u32>),
    /// Numbers of 64 bits.
    Doubles(Vec<f64>),
}

/// A record of an FBX file.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Its name.
    pub name: String,
    /// Its values.
    pub values: Vec<Value>,
    /// Records below it.
    pub below: Vec<Record>,
}

impl Record {
    /// A record with values.
    pub fn new(name: &str, values: Vec<Value>) -> Self {
        Self {
            name: name.to_owned(),
            values,
            below: Vec::new(),
        }
    }

    /// The same with one more record below it.
    #[must_use]
    pub fn with(mut self, below: Self) -> Self {
        self.below.push(below);
        self
    }

    /// The same with records below it.
    #[must_use]
    pub fn holding(mut self, below: Vec<Self>) -> Self {
        self.below.extend(below);
        self
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<i32> for Value {
    fn from(number: i32) -> Self {
        Self::Int(number)
    }
}

impl From<i64> for Value {
    fn from(number: i64) -> Self {
        Self::Long(number)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Double(number)
    }
}
