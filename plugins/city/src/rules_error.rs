//! Why rules are refused.

use std::path::PathBuf;

use thiserror::Error;

/// Why a city cannot be made.
#[derive(Debug, Error)]
pub enum RulesError {
    /// The file cannot be read.
    #[error("{}: {reason}", file.display())]
    Read {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
    /// It is no rule file.
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
    /// A number by which no city can be made.
    #[error("{}{field} is {value}; it has to be {allowed}", place(file.as_ref(), *line))]
    Field {
        /// Which file, if the rules come from one.
        file: Option<PathBuf>,
        /// Where, from 1; `None` if the file does not name the field: a default does not fit the rest.
        line: Option<usize>,
        /// The field, with a dot before that of an inner part.
        field: &'static str,
        /// What it is.
        value: String,
        /// What it may be.
        allowed: String,
    },
    /// More blocks at once than are made in one go.
    #[error("{blocks} blocks at once; at most {most} are made in one go")]
    TooMany {
        /// How many.
        blocks: u64,
        /// How many there may be.
        most: u64,
    },
}

fn place(file: Option<&PathBuf>, line: Option<usize>) -> String {
    match (file, line) {
        (Some(file), Some(line)) => format!("{}, line {line}: ", file.display()),
        (Some(file), None) => format!("{}: ", file.display()),
        _ => String::new(),
    }
}

/// The line, from 1, on which a field is written: a name is found where a colon follows it, an inner one behind
/// the outer one. Comments that look like fields may mislead it; the number is an aid to the reader.
pub(crate) fn line_of(text: &str, field: &str) -> Option<usize> {
    let mut at = 0;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_by_whole_names() {
        let text = "(\n  footprint: 3,\n  print: 4,\n  roof: (\n    height: 2))";
        assert_eq!(line_of(text, "print"), Some(3));
        assert_eq!(line_of(text, "roof.height"), Some(5));
        assert_eq!(line_of(text, "hedge.height"), None);
    }
}
