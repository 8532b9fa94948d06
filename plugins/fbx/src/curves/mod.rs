//! The file's curves, evaluated from its own keys, tangents and layers in f64.
//!
//! ufbx reads keys, tangents and properties; what they come to at a time is worked out here, since ufbx
//! leaves out which layers are muted or play alone and looks for keyed weights in one layer only.

mod curve;
mod curve_rates;
mod hanging;
mod layers;
mod majorant;
mod pose;
mod rates;
mod value;
mod value_rates;

pub(crate) use curve::{TICKS, repeats};
pub(crate) use layers::{Layers, Reading, playing};
pub(crate) use majorant::{Majorant, Number, ORDERS, Over, cubic, part};
pub(crate) use pose::{BlendWeight, NodeCurves, aside, order_of};
pub(crate) use rates::Rates;
pub(crate) use value::{Meaning, Value};
