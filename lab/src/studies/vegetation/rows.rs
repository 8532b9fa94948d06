//! A row of the study's table.

use crate::csv::Row;

/// A row without errors and times.
pub fn row(sweep: &str, method: &str, parameter: &str, value: f64, quantity: &str) -> Row {
    Row {
        sweep: sweep.into(),
        method: method.into(),
        parameter: parameter.into(),
        parameter_value: value,
        quantity: quantity.into(),
        error: None,
        error_unit: String::new(),
        time_ns: None,
        bytes: None,
        vertices: None,
        hash: None,
        device: "one core".into(),
    }
}
