//! A chart as JSON or CSV.

use std::fmt::Write;
use std::path::Path;

use thiserror::Error;

use super::Chart;

/// Why a chart was not written.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FileError {
    /// The name ends otherwise.
    #[error("{0}: a chart is written as .json or .csv")]
    Kind(String),
    /// It cannot be written.
    #[error("{file}: {reason}")]
    Write {
        /// The file.
        file: String,
        /// What the system said.
        reason: String,
    },
}

/// Whether a chart can be written under a name.
///
/// # Errors
/// [`FileError::Kind`].
pub fn check(file: &Path) -> Result<(), FileError> {
    match file.extension().and_then(|end| end.to_str()) {
        Some("json" | "csv") => Ok(()),
        _ => Err(FileError::Kind(file.display().to_string())),
    }
}

/// Writes a chart.
///
/// # Errors
/// [`FileError`].
pub fn write(chart: &Chart, file: &Path) -> Result<(), FileError> {
    check(file)?;
    let text = if file.extension().is_some_and(|end| end == "csv") {
        csv(chart)
    } else {
        json(chart)
    };
    std::fs::write(file, text).map_err(|error| FileError::Write {
        file: file.display().to_string(),
        reason: error.to_string(),
    })
}

/// A row a value: the value, times in milliseconds, the error; empty where there is none.
#[must_use]
pub fn csv(chart: &Chart) -> String {
    let mut text = "value,time_ms,time_ms_p10,time_ms_p90,error\n".to_owned();
    for point in &chart.points {
        let [low, high] = point.spread;
        let error = point
            .error
            .map_or_else(String::new, |error| error.to_string());
        // Into a text nothing fails.
        let _ = writeln!(text, "{},{},{low},{high},{error}", point.value, point.time);
    }
    text
}

/// The same, with what was measured. An error that is not there is left out.
#[must_use]
pub fn json(chart: &Chart) -> String {
    let mut text = format!(
        "{{\n  \"setting\": {},\n  \"time\": {},\n  \"error\": {},\n  \"points\": [",
        quoted(&chart.setting),
        quoted(&chart.time),
        quoted(&chart.error)
    );
    for (k, point) in chart.points.iter().enumerate() {
        let [low, high] = point.spread;
        let error = point
            .error
            .map_or_else(String::new, |error| format!(", \"error\": {error}"));
        let comma = if k == 0 { "" } else { "," };
        let _ = write!(
            text,
            "{comma}\n    {{ \"value\": {}, \"time_ms\": {}, \"time_ms_p10\": {low}, \"time_ms_p90\": {high}{error} }}",
            point.value, point.time
        );
    }
    text + "\n  ]\n}\n"
}

fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted.push(' '),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::Point;

    fn chart() -> Chart {
        let point = |value, error| Point {
            value,
            time: 1.5,
            spread: [1.25, 2.0],
            error,
        };
        Chart {
            setting: "Fog@\"a\\b\".dust".to_owned(),
            error: "fog/drawn".to_owned(),
            points: vec![point(0.5, Some(1e-3)), point(2.0, None)],
            wanted: 2,
            done: true,
            ..Chart::default()
        }
    }

    #[test]
    fn a_chart_is_written_as_json_that_says_all_of_it() {
        // RON reads JSON without `null`.
        let value: ron::Value = ron::from_str(&json(&chart())).unwrap();
        let text = format!("{value:?}");
        for part in ["dust", "fog/drawn", "0.001", "1.25"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert_eq!(json(&chart()).matches("time_ms_p90").count(), 2);
    }

    #[test]
    fn a_chart_is_written_as_rows() {
        assert_eq!(
            csv(&chart()),
            "value,time_ms,time_ms_p10,time_ms_p90,error\n0.5,1.5,1.25,2,0.001\n2,1.5,1.25,2,\n"
        );
    }

    #[test]
    fn a_name_that_ends_otherwise_is_refused() {
        assert!(check(Path::new("a.json")).is_ok());
        for name in ["a", "a.txt", ".json", ""] {
            let fault = check(Path::new(name)).unwrap_err().to_string();
            assert!(fault.contains(".csv"), "{fault}");
        }
        let fault = write(&chart(), Path::new("/no/such/folder/a.csv")).unwrap_err();
        assert!(fault.to_string().contains("/no/such/folder/a.csv"));
    }
}
