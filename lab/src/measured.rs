//! Measured tables: a JSON file a topic, and the Markdown that is made of it.
//!
//! ```json
//! {
//!   "topic": "Noise",
//!   "device": "two cores, llvmpipe",
//!   "date": "2026-01-31",
//!   "commit": "0123abc",
//!   "rows": [{ "what": "...", "asked": "≤ 1e-5", "reached": 2.7e-7, "unit": "m", "command": "..." }],
//!   "notes": ["..."]
//! }
//! ```
//!
//! `commit` and `notes` may be left out. `reached` is one number, or a word where there is none.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};
use thiserror::Error;

/// What was measured about one topic, on one device, on one day.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Topic {
    /// Heading of the page.
    pub topic: String,
    /// What it was measured on.
    pub device: String,
    /// Year, month and day, with hyphens.
    pub date: String,
    /// Version of the code.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// One number each.
    pub rows: Vec<Measurement>,
    /// What a reader must know besides.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// One number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measurement {
    /// What was measured.
    pub what: String,
    /// What was asked for; empty where nothing was.
    pub asked: String,
    /// A number, or a word where there is none.
    pub reached: Value,
    /// Its unit; empty for a word.
    pub unit: String,
    /// What measures it again.
    pub command: String,
}

/// Why a file is no table.
#[derive(Debug, Error)]
pub enum TopicError {
    /// It cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is not of the form.
    #[error("{}: {source}", path.display())]
    Form {
        /// Which.
        path: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// A field holds what it may not.
    #[error("{}: {reason}", path.display())]
    Field {
        /// Which.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

impl Topic {
    /// Reads and looks through a file.
    ///
    /// # Errors
    /// [`TopicError`].
    pub fn read(path: &Path) -> Result<Self, TopicError> {
        let text = std::fs::read_to_string(path).map_err(|source| TopicError::File {
            path: path.to_owned(),
            source,
        })?;
        let topic: Self = serde_json::from_str(&text).map_err(|source| TopicError::Form {
            path: path.to_owned(),
            source,
        })?;
        match topic.fault() {
            None => Ok(topic),
            Some(reason) => Err(TopicError::Field {
                path: path.to_owned(),
                reason,
            }),
        }
    }

    /// What is wrong with it, if anything is.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        if self.topic.is_empty() || self.device.is_empty() {
            return Some("topic and device need words".into());
        }
        if !is_date(&self.date) {
            return Some(format!("the date {:?} is not like 2026-01-31", self.date));
        }
        self.rows.iter().find_map(|row| {
            let of_row = |reason: &str| Some(format!("{:?}: {reason}", row.what));
            if row.what.is_empty() || row.command.is_empty() {
                return of_row("what and command need words");
            }
            match &row.reached {
                Value::Number(_) => None,
                // Two numbers want two rows.
                Value::String(word)
                    if !word.is_empty() && !word.contains(|c: char| c.is_ascii_digit()) =>
                {
                    None
                }
                _ => of_row("reached is one number, or a word without one"),
            }
        })
    }

    /// The page, made of the file of this name.
    #[must_use]
    pub fn to_markdown(&self, file: &str) -> String {
        let mut page = format!(
            "<!-- Written by `dolomite_lab tables` from data/{file}: change that, not this. -->\n\n# {}\n\n",
            self.topic
        );
        let mut line = |text: std::fmt::Arguments<'_>| {
            page.write_fmt(text)
                .expect("a String takes everything that is written");
        };
        line(format_args!("Measured on {}: {}.", self.date, self.device));
        if let Some(commit) = &self.commit {
            line(format_args!(" Commit {commit}."));
        }
        line(format_args!(
            "\n\n| what | asked | reached | unit | command |\n|---|---|---:|---|---|\n"
        ));
        for row in &self.rows {
            let reached = match &row.reached {
                Value::String(word) => cell(word),
                number => cell(&number.to_string()),
            };
            line(format_args!(
                "| {} | {} | {reached} | {} | `{}` |\n",
                cell(&row.what),
                cell(&row.asked),
                cell(&row.unit),
                cell(&row.command)
            ));
        }
        if !self.notes.is_empty() {
            line(format_args!("\n"));
        }
        for note in &self.notes {
            line(format_args!("- {}\n", note.replace('\n', " ")));
        }
        page
    }
}

/// Text of one cell: a bar would end it.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn is_date(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    let number = |part: &str, digits: usize| -> Option<u32> {
        (part.len() == digits).then(|| part.parse().ok()).flatten()
    };
    let [year, month, day] = parts[..] else {
        return false;
    };
    number(year, 4).is_some()
        && number(month, 2).is_some_and(|month| (1..=12).contains(&month))
        && number(day, 2).is_some_and(|day| (1..=31).contains(&day))
}

/// Today, as UTC has it.
#[must_use]
pub fn today() -> String {
    let seconds = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs());
    let (year, month, day) = civil((seconds / 86_400) as i64);
    format!("{year:04}-{month:02}-{day:02}")
}

/// Year, month and day of a number of days since 1970-01-01 (H. Hinnant, "chrono-compatible low-level date
/// algorithms", 2013): years begin in March, so that the leap day is the last.
fn civil(days: i64) -> (i64, i64, i64) {
    let days = days + 719_468;
    let era = days.div_euclid(146_097);
    let of_era = days.rem_euclid(146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (year + era * 400 + i64::from(month <= 2), month, day)
}

/// The commit that is checked out, if this is a checkout and there is a `git`.
#[must_use]
pub fn commit() -> Option<String> {
    let output = std::process::Command::new("git")
        .args(["rev-parse", "--short", "HEAD"])
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !text.trim().is_empty()).then(|| text.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn topic() -> Topic {
        Topic {
            topic: "Noise".into(),
            device: "two cores".into(),
            date: "2026-01-31".into(),
            commit: None,
            rows: vec![Measurement {
                what: "error | value".into(),
                asked: "≤ 1e-5".into(),
                reached: json!(2.7e-7),
                unit: "m".into(),
                command: "dolomite_lab noise".into(),
            }],
            notes: vec!["Once.".into()],
        }
    }

    #[test]
    fn a_page_has_a_line_a_row_and_says_where_it_comes_from() {
        let page = topic().to_markdown("noise.json");
        assert!(page.starts_with("<!-- Written by `dolomite_lab tables` from data/noise.json"));
        let row = "| error \\| value | ≤ 1e-5 | 2.7e-7 | m | `dolomite_lab noise` |\n";
        assert!(page.contains(row), "{page}");
        assert!(page.ends_with("\n- Once.\n"), "{page}");
    }

    #[test]
    fn two_numbers_in_a_cell_and_other_faults_are_named() {
        assert_eq!(topic().fault(), None);
        let with = |change: fn(&mut Topic)| {
            let mut topic = topic();
            change(&mut topic);
            topic.fault()
        };
        let two = with(|t| t.rows[0].reached = json!("0.061 and 0.059"));
        assert!(two.is_some_and(|fault| fault.contains("one number")));
        assert!(with(|t| t.rows[0].reached = json!([1, 2])).is_some());
        assert!(with(|t| t.rows[0].reached = json!("not reached")).is_none());
        assert!(with(|t| t.rows[0].command.clear()).is_some());
        assert!(with(|t| t.date = "31.1.2026".into()).is_some());
        assert!(with(|t| t.device.clear()).is_some());
    }

    #[test]
    fn days_are_dates() {
        assert_eq!(civil(0), (1970, 1, 1));
        assert_eq!(civil(59), (1970, 3, 1));
        // 2000 has a leap day, as every 400th year.
        assert_eq!(civil(11_016), (2000, 2, 29));
        assert_eq!(civil(-1), (1969, 12, 31));
        assert!(is_date(&today()));
    }

    #[test]
    fn a_file_of_another_form_is_refused_by_name() {
        let path = std::env::temp_dir().join(format!("dolomite_topic_{}.json", std::process::id()));
        std::fs::write(&path, "{\"topic\": \"x\", \"rows\": [], \"more\": 1}").unwrap();
        let refusal = Topic::read(&path).unwrap_err().to_string();
        assert!(refusal.contains("dolomite_topic_"), "{refusal}");
        std::fs::write(&path, serde_json::to_string(&topic()).unwrap()).unwrap();
        assert_eq!(Topic::read(&path).unwrap(), topic());
        std::fs::remove_file(path).unwrap();
    }
}
