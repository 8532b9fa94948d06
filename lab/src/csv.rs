//! The table that a study writes: one row a measurement, numbers in full.

use dolomite_testkit::metrics::ErrorStats;
use serde::Serialize;
use std::fmt::Write;

/// One measurement. What was not measured is `None` and an empty field of the file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Which of the study's sweeps it belongs to.
    pub sweep: String,
    /// What was run.
    pub method: String,
    /// Name of the knob and where it stood.
    pub parameter: String,
    /// Where the knob stood, as a number.
    pub parameter_value: f64,
    /// What is wrong by the error: `value`, `gradient`, ...
    pub quantity: String,
    /// Error against the method's f64 definition.
    pub error: Option<ErrorNumbers>,
    /// Unit of the three errors.
    pub error_unit: String,
    /// Wall time per sample, nanoseconds, median over the repeats.
    pub time_ns: Option<f64>,
    /// Bytes that the method keeps: tables and parameters, without its input and output.
    pub bytes: Option<usize>,
    /// Vertices that are drawn.
    pub vertices: Option<u64>,
    /// FNV-1a over the bits of the results.
    pub hash: Option<u64>,
    /// What it ran on.
    pub device: String,
}

/// The three errors of a [`Row`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorNumbers {
    /// See [`ErrorStats::max`].
    pub max: f64,
    /// See [`ErrorStats::rms`].
    pub rms: f64,
    /// See [`ErrorStats::p99`].
    pub p99: f64,
}

impl From<ErrorStats> for ErrorNumbers {
    fn from(stats: ErrorStats) -> Self {
        Self {
            max: stats.max,
            rms: stats.rms,
            p99: stats.p99,
        }
    }
}

const HEADER: &str = "sweep,method,parameter,quantity,error_max,error_rms,error_p99,error_unit,time_ns,bytes,vertices,hash,device";

/// The whole file: a header and a line for each row (RFC 4180; `\n` ends a line).
pub fn to_csv(rows: &[Row]) -> String {
    let mut out = format!("{HEADER}\n");
    for row in rows {
        let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:e}"));
        let error = |pick: fn(&ErrorNumbers) -> f64| number(row.error.as_ref().map(pick));
        let fields = [
            quoted(&row.sweep),
            quoted(&row.method),
            quoted(&row.parameter),
            quoted(&row.quantity),
            error(|e| e.max),
            error(|e| e.rms),
            error(|e| e.p99),
            quoted(&row.error_unit),
            number(row.time_ns),
            row.bytes.map_or(String::new(), |b| b.to_string()),
            row.vertices.map_or(String::new(), |v| v.to_string()),
            row.hash.map_or(String::new(), |h| format!("{h:016x}")),
            quoted(&row.device),
        ];
        writeln!(out, "{}", fields.join(",")).expect("a String takes everything that is written");
    }
    out
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_written_in_full() {
        let mut row = Row {
            sweep: "octaves".into(),
            method: "a, \"b\"".into(),
            parameter: "octaves=8".into(),
            parameter_value: 8.0,
            quantity: "value".into(),
            error: Some(ErrorNumbers {
                max: 0.1,
                rms: 0.25,
                p99: 1e-7,
            }),
            error_unit: "amplitude".into(),
            time_ns: Some(12.5),
            bytes: Some(64),
            vertices: Some(12),
            hash: Some(0xab),
            device: "CPU".into(),
        };
        let text = to_csv(std::slice::from_ref(&row));
        let line = text.lines().nth(1).unwrap();
        let expected = "octaves,\"a, \"\"b\"\"\",octaves=8,value,1e-1,2.5e-1,1e-7,amplitude,1.25e1,64,12,00000000000000ab,CPU";
        assert_eq!(line, expected);
        row.method = "a".into();
        row.error = None;
        row.time_ns = None;
        let text = to_csv(&[row]);
        let line = text.lines().nth(1).unwrap();
        assert_eq!(
            line,
            "octaves,a,octaves=8,value,,,,amplitude,,64,12,00000000000000ab,CPU"
        );
        assert_eq!(line.split(',').count(), HEADER.split(',').count());
    }
}
