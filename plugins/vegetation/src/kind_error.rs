//! Why kinds are refused.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why a list of kinds cannot be drawn.
#[derive(Debug, Error)]
pub enum KindError {
    /// The file cannot be read.
    #[error("{}: {reason}", file.display())]
    Read {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
    /// It is no file of kinds.
    #[error("{}, line {line}, column {column}: {reason}", file.display())]
    Parse {
        /// Which file.
        file: PathBuf,
        /// Where, from 1.
        line: usize,
        /// Where, from 1.
        column: usize,
        /// What was expected there; an unknown field is named.
        reason: String,
    },
    /// A number that cannot be drawn.
    #[error("{}kind `{kind}`: {field} is {value}; it has to be {allowed}", place(file.as_deref(), *line))]
    Field {
        /// Which file, if the kinds come from one.
        file: Option<Box<Path>>,
        /// Where, from 1; `None` if the file does not name the field.
        line: Option<usize>,
        /// Which kind.
        kind: Box<str>,
        /// The field, with a dot before that of an inner part.
        field: &'static str,
        /// What it is.
        value: Box<str>,
        /// What it may be.
        allowed: Box<str>,
    },
    /// More kinds than a list may have.
    #[error("{count} kinds; a list has at most {most}: put some into a second entity's list")]
    TooMany {
        /// How many.
        count: usize,
        /// How many there may be.
        most: usize,
    },
}

fn place(file: Option<&Path>, line: Option<usize>) -> String {
    match (file, line) {
        (Some(file), Some(line)) => format!("{}, line {line}: ", file.display()),
        (Some(file), None) => format!("{}: ", file.display()),
        _ => String::new(),
    }
}

/// The line, from 1, on which a field of a kind is written: behind the kind's name, which therefore comes first in
/// it, where a colon follows the field. The number is an aid to the reader; comments may mislead it.
pub(crate) fn line_of(text: &str, kind: &str, field: &str) -> Option<usize> {
    let mut at = text.find(&format!("\"{kind}\""))?;
    for name in field.split('.') {
        let found = text[at..].match_indices(name).find(|(k, _)| {
            let before = text[..at + k].chars().next_back();
            let after = text[at + k + name.len()..].trim_start();
            after.starts_with(':') && !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
        })?;
        at += found.0 + name.len();
    }
    Some(1 + text[..at].matches('\n').count())
}
