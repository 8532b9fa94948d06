//! The file's curves, evaluated from its own keys, tangents and layers in f64.
//!
//! ufbx reads keys, tangents and properties; what they come to at a time is worked out here, since ufbx
//! leaves out which layers are muted or play alone and looks for keyed weights in one layer only.

mod circle;
mod cubic;
mod curve;
mod curve_rates;
mod functions;
mod hanging;
mod layers;
mod majorant;
mod number;
mod over;
mod pose;
mod rates;
mod squares;
mod tangents;
mod value;
mod value_rates;

pub(crate) use cubic::{cubic, part};
pub(crate) use curve::{TICKS, repeats};
pub(crate) use layers::{Layers, Reading, playing};
pub(crate) use majorant::{Majorant, ORDERS};
pub(crate) use number::Number;
pub(crate) use over::Over;
#[cfg(test)]
pub(crate) use over::holds;
pub(crate) use pose::{BlendWeight, NodeCurves, aside, order_of};
pub(crate) use rates::{Rates, Turning};
pub(crate) use squares::Squares;
pub(crate) use value::{Meaning, Value};
