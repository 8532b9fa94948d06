//! What of a record is compared, and how near it has to be.

use serde::{Deserialize, Serialize};

/// A field of a record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// For reports.
    pub name: String,
    /// Byte within the record.
    pub at: u64,
    /// How many numbers of the type lie there, one after the other.
    pub count: u64,
    /// What they are, and how far off they may be.
    #[serde(flatten)]
    pub ty: FieldType,
}

/// What a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case")]
pub enum FieldType {
    /// A word whose bits must be the same.
    U32,
    /// A number. Its error is |found − expected| in units in the last place of the greater of |expected| and `scale`.
    F32 {
        /// Most units in the last place.
        ulp: f64,
        /// Size of the terms that the number is a sum of, in its unit; 0 for functions without cancellation.
        scale: f32,
    },
    /// A normal in 2 × 12 bits, octahedral, and a material in 8: the coordinates may be so many steps apart, the
    /// material may not.
    Oct12 {
        /// Most steps of a coordinate.
        steps: u32,
    },
    /// Two numbers of 16 bits, which may be so many steps apart.
    Snorm16x2 {
        /// Most steps.
        steps: u32,
    },
    /// Some bits of a word, a number that may be so many steps off.
    Part {
        /// The lowest of them.
        low: u32,
        /// How many.
        bits: u32,
        /// Most steps.
        steps: u32,
    },
}

impl Field {
    /// `count` numbers of a type, from the byte `at` on.
    #[must_use]
    pub fn new(name: &str, at: usize, count: u64, ty: FieldType) -> Self {
        Self {
            name: name.to_owned(),
            at: at as u64,
            count,
            ty,
        }
    }

    /// Words whose bits must be the same.
    #[must_use]
    pub fn words(name: &str, at: usize, count: u64) -> Self {
        Self::new(name, at, count, FieldType::U32)
    }
}
