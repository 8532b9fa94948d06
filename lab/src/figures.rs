//! `dolomite_lab figures`: makes `docs/figures/index.html` of `docs/measured`: every table with a bar a number that was
//! asked for, and every chart that is kept there.

use crate::measured::{Measurement, Topic, TopicError};
use crate::page::{Page, escaped};
use bevy::math::ops;
use clap::Parser;
use serde_json::Value;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Makes the page of figures.
#[derive(Debug, Parser)]
#[command(name = "dolomite_lab figures")]
pub struct Arguments {
    /// Changes nothing; fails if the page is not what the data say
    #[arg(long)]
    pub check: bool,
    /// The folder with what was measured
    #[arg(long, default_value = "docs/measured")]
    pub measured: PathBuf,
    /// The page
    #[arg(long, default_value = "docs/figures/index.html")]
    pub out: PathBuf,
}

/// Why the page was not made, or is not right.
#[derive(Debug, Error)]
pub enum FiguresError {
    /// A file is no table, or cannot be read or written.
    #[error(transparent)]
    Topic(#[from] TopicError),
    /// The page is not what the data say.
    #[error("{} is not as its data say; run `dolomite_lab figures`", .0.display())]
    Stale(PathBuf),
}

/// Makes or checks the page; whether it was written.
///
/// # Errors
/// [`FiguresError`].
pub fn run(arguments: &Arguments) -> Result<bool, FiguresError> {
    let page = page(&arguments.measured)?;
    if std::fs::read_to_string(&arguments.out).is_ok_and(|old| old == page) {
        return Ok(false);
    }
    if arguments.check {
        return Err(FiguresError::Stale(arguments.out.clone()));
    }
    let fault = |source| TopicError::File {
        path: arguments.out.clone(),
        source,
    };
    if let Some(folder) = arguments.out.parent() {
        std::fs::create_dir_all(folder).map_err(fault)?;
    }
    std::fs::write(&arguments.out, page).map_err(fault)?;
    Ok(true)
}

/// The page of all that was measured.
///
/// # Errors
/// [`TopicError`].
pub fn page(measured: &Path) -> Result<String, TopicError> {
    let mut page = Page::new(
        "Dolomite: figures",
        "What was asked for and what was reached. A bar is what was reached over what was asked for, \
         on a logarithmic scale from a thousandth to ten times; the line is what was asked for, and a bar that goes \
         beyond it is a number that was not reached. Times of software Vulkan compare methods on one machine and are \
         not for quoting.",
    );
    for path in files(&measured.join("data"), "json")? {
        let topic = Topic::read(&path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        page.section(&name, &topic.topic);
        let commit = topic
            .commit
            .as_ref()
            .map_or_else(String::new, |commit| format!(" Commit {commit}."));
        page.weak(&format!(
            "Measured on {}: {}.{commit}",
            topic.date, topic.device
        ));
        let rows: Vec<_> = topic.rows.iter().map(row).collect();
        page.table(
            &[
                "what",
                "asked",
                "reached",
                "unit",
                "reached over asked",
                "measured by",
            ],
            &rows,
        );
        page.list(topic.notes.iter().map(String::as_str));
        for chart in files(&measured.join(&*name), "svg")? {
            let svg = std::fs::read_to_string(&chart).map_err(|source| TopicError::File {
                path: chart.clone(),
                source,
            })?;
            let stem = chart.file_stem().unwrap_or_default().to_string_lossy();
            page.figure(&svg, &stem.replace('_', " "));
        }
    }
    Ok(page.finish())
}

/// Paths of the files with an ending, sorted; none in a folder that is not there.
fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, TopicError> {
    let fault = |source| TopicError::File {
        path: folder.to_owned(),
        source,
    };
    let entries = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(fault)?,
    };
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.map_err(fault)?.path();
        if path.extension().is_some_and(|is| is == ending) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

fn row(row: &Measurement) -> Vec<String> {
    let reached = match &row.reached {
        Value::String(word) => word.clone(),
        number => number.to_string(),
    };
    let cell = |text: &str| format!("<td>{}</td>", escaped(text));
    vec![
        cell(&row.what),
        cell(&row.asked),
        format!("<td class=\"number\">{}</td>", escaped(&reached)),
        cell(&row.unit),
        format!("<td>{}</td>", ratio(row).map_or_else(String::new, bar)),
        format!("<td><code>{}</code></td>", escaped(&row.command)),
    ]
}

/// What was reached over what was asked for, so that 1 and less is what was wanted: turned round where at least so
/// much was asked for. `None` where one of the two is no number, or what was asked for has another unit than the number
/// beside it.
fn ratio(row: &Measurement) -> Option<f64> {
    let reached = row.reached.as_f64()?;
    let asked = row.asked.trim();
    let (most, number) = match asked.chars().next()? {
        '≤' | '<' => (true, &asked[asked.chars().next()?.len_utf8()..]),
        '≥' | '>' => (false, &asked[asked.chars().next()?.len_utf8()..]),
        _ => return None,
    };
    let mut words = number.split_whitespace();
    let asked: f64 = words.next()?.parse().ok()?;
    let unit = words.next();
    if words.next().is_some() || unit.is_some_and(|unit| unit != row.unit) {
        return None;
    }
    let ratio = if most {
        reached / asked
    } else {
        asked / reached
    };
    ratio.is_finite().then_some(ratio)
}

/// The ends of a bar's scale, and where 1 lies on it.
const SCALE: (f64, f64) = (1e-3, 10.0);

/// A bar of 160 by 14.
fn bar(ratio: f64) -> String {
    let place = |ratio: f64| {
        // A tenth of a pixel is all that is written of it.
        let log = |x: f64| f64::from(ops::log2(x as f32));
        let (low, high) = (log(SCALE.0), log(SCALE.1));
        let share = (log(ratio.max(SCALE.0)) - low) / (high - low);
        160.0 * share.clamp(0.0, 1.0)
    };
    // A number that is far below still has a bar that is seen.
    let width = place(ratio).max(2.0);
    let end = place(1.0);
    let class = if ratio <= 1.0 { "good" } else { "bad" };
    format!(
        "<svg class=\"bar\" viewBox=\"0 0 160 14\" role=\"img\" aria-label=\"{ratio:.3} of what was asked for\">\
         <rect class=\"field\" width=\"160\" height=\"14\"/>\
         <rect class=\"{class}\" y=\"2\" width=\"{width:.1}\" height=\"10\"/>\
         <line class=\"end\" x1=\"{end:.1}\" y1=\"0\" x2=\"{end:.1}\" y2=\"14\"/></svg>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn measured(asked: &str, reached: Value, unit: &str) -> Measurement {
        Measurement {
            what: "w".into(),
            asked: asked.into(),
            reached,
            unit: unit.into(),
            command: "c".into(),
        }
    }

    #[test]
    fn a_ratio_is_of_numbers_with_one_unit() {
        let ratio = |asked, reached, unit| super::ratio(&measured(asked, reached, unit));
        assert_eq!(ratio("≤ 2", json!(1), ""), Some(0.5));
        assert_eq!(ratio("≤ 2 ms", json!(4.0), "ms"), Some(2.0));
        assert_eq!(ratio("≥ 3", json!(6), "x"), Some(0.5));
        assert_eq!(ratio("≤ 0", json!(0), ""), None);
        for (asked, reached, unit) in [
            ("0", json!(0), ""),
            ("", json!(1), ""),
            ("≤ 1 s", json!(1), "ms"),
            ("≤ 1 at 99 %", json!(1), ""),
            ("≤ 1", json!("none"), ""),
            ("≤", json!(1), ""),
        ] {
            assert_eq!(ratio(asked, reached, unit), None, "{asked}");
        }
    }

    #[test]
    fn what_was_not_reached_goes_beyond_the_line() {
        assert!(bar(0.5).contains("class=\"good\"") && bar(1.0).contains("class=\"good\""));
        assert!(bar(1.001).contains("class=\"bad\""));
        assert!(bar(0.0).contains("width=\"2.0\"") && bar(1e9).contains("width=\"160.0\""));
        // A thousandth to ten: 1 is at three quarters.
        assert!(bar(1.0).contains("x1=\"120.0\""));
    }

    #[test]
    fn every_number_and_every_chart_of_this_checkout_is_on_the_page() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let measured = root.join("docs/measured");
        let page = page(&measured).unwrap();
        let (mut rows, mut charts) = (0, 0);
        for path in files(&measured.join("data"), "json").unwrap() {
            rows += Topic::read(&path).unwrap().rows.len();
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            charts += files(&measured.join(name), "svg").unwrap().len();
        }
        assert_eq!(page.matches("<code>").count(), rows);
        assert_eq!(page.matches("<figure>").count(), charts);
        assert!(charts >= 7 && rows > 100, "{charts} {rows}");
        let arguments = Arguments {
            check: true,
            measured,
            out: root.join("docs/figures/index.html"),
        };
        run(&arguments).unwrap_or_else(|error| panic!("{error}"));
        let other = Arguments {
            out: root.join("docs/figures/none.html"),
            ..arguments
        };
        assert!(matches!(run(&other), Err(FiguresError::Stale(_))));
    }
}
