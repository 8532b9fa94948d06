//! Which numbers stand for no data.

use crate::options::{NoData, Options};

/// The numbers that stand for no data: the file's, and that of a setting.
pub(crate) fn named(options: &Options, file_nodata: &[f64]) -> Vec<f64> {
    let mut nodata: Vec<f64> = match options.nodata {
        NoData::None => Vec::new(),
        _ => file_nodata.to_vec(),
    };
    if let NoData::Value(value) = options.nodata
        && !nodata.iter().any(|n| n.to_bits() == value.to_bits())
    {
        nodata.push(value);
    }
    nodata
}

/// The largest floats, as text that was cut off names them: -3.40282e+38.
const LARGEST: f64 = 3.4e38;

/// Whether a number stands for no data where `nodata` does. Either infinity stands for both, and a number beyond all heights for all beyond:
/// digits of the largest float get lost on the way through text.
pub(crate) fn is_nodata(value: f64, nodata: f64) -> bool {
    if nodata.is_infinite() {
        return (value as f32).is_infinite();
    }
    if nodata.abs() >= LARGEST {
        return value.abs() >= LARGEST && value.is_sign_negative() == nodata.is_sign_negative();
    }
    // A fraction may have been a float before it was written with more digits.
    value == nodata || nodata.fract() != 0.0 && value as f32 == nodata as f32
}

/// The numbers that stand for no data, as they compare with samples.
#[derive(Clone, Debug)]
pub(crate) struct Marks(Vec<f64>);

impl Marks {
    pub fn new(nodata: &[f64]) -> Self {
        Self(nodata.to_vec())
    }

    pub fn any(&self) -> bool {
        !self.0.is_empty()
    }

    /// Makes them NaN.
    pub fn mark(&self, samples: &mut [f32]) {
        for &nodata in self.0.iter().filter(|n| !n.is_nan()) {
            if nodata.abs() >= LARGEST {
                for sample in samples.iter_mut() {
                    let is_one = is_nodata((*sample).into(), nodata);
                    *sample = if is_one { f32::NAN } else { *sample };
                }
                continue;
            }
            // A float that was written as text is that float again.
            let nodata = nodata as f32;
            for sample in samples.iter_mut() {
                *sample = if *sample == nodata { f32::NAN } else { *sample };
            }
        }
    }
}
