//! What came of so many files that they are held in pieces: kept in a file between two of them, so that a run that was
//! ended goes on where it was.

use crate::run::{Outcome, Property, run_by};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// Files of a piece: some minutes' work.
const PIECE: u64 = 500;

/// Slow files that are named.
const SLOWEST: usize = 8;

/// Steps in which shares are counted.
const STEP: f64 = 1.01;

/// The sum of what came of several runs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Total {
    /// Files that were made.
    pub files: u64,
    /// Poses that were held.
    pub poses: u64,
    /// Files that were refused because of limits: which, and why.
    pub refused: Vec<(u64, String)>,
    /// The files that took longest: seconds, and which.
    pub slowest: Vec<(f64, u64)>,
    /// The largest true error over what is stated and allowed.
    pub worst: f64,
    /// How many files have so many hundredths (as factors of 1.01) between the largest true error and what is stated and allowed.
    pub shares: BTreeMap<u64, u64>,
    /// How many failed in each way.
    pub kinds: BTreeMap<String, u64>,
    /// What failed: seed, and how; of those that were made small, where the small file is.
    pub failed: BTreeMap<u64, String>,
}

/// Why a run cannot go on.
#[derive(Debug)]
pub enum ResumeError {
    /// The file between two pieces could not be read or written.
    File(std::io::Error),
    /// It holds something else.
    Broken,
    /// It belongs to another run: by another build, of other seeds.
    Other,
}

impl fmt::Display for ResumeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => write!(f, "{error}"),
            Self::Broken => write!(f, "it is no state of a run: remove it to begin anew"),
            Self::Other => write!(
                f,
                "it was begun by another build or for other files: remove it to begin anew"
            ),
        }
    }
}

impl std::error::Error for ResumeError {}

impl Total {
    /// With what came of another run.
    pub fn add(&mut self, outcome: &Outcome) {
        self.files += outcome.files;
        self.poses += outcome.poses as u64;
        self.refused.extend(outcome.refused.iter().cloned());
        self.refused.sort();
        self.slowest.extend(&outcome.slowest);
        self.slowest.sort_by(|a, b| b.0.total_cmp(&a.0));
        self.slowest.truncate(SLOWEST);
        self.worst = self.worst.max(outcome.worst);
        for share in &outcome.shares {
            let steps = (share.recip().ln() / STEP.ln()).floor().max(0.0);
            *self.shares.entry(steps as u64).or_default() += 1;
        }
        for (kind, count) in &outcome.kinds {
            *self.kinds.entry((*kind).to_owned()).or_default() += count;
        }
        for (seed, failure) in &outcome.failed {
            let line = format!("seed {seed}: {}: {}", failure.kind, failure.detail);
            self.failed.insert(*seed, line);
        }
        for failed in &outcome.failures {
            self.failed.insert(failed.seed, failed.to_string());
        }
    }

    /// How many times the true error what is stated and allowed is at most, to 1 %, for a share of all files.
    pub fn stated_over_true(&self, share: f64) -> f64 {
        let all: u64 = self.shares.values().sum();
        let wanted = (all as f64 * share) as u64;
        let mut seen = 0;
        let mut steps = self.shares.iter();
        let found = steps.find(|(_, count)| {
            seen += **count;
            seen > wanted
        });
        found.map_or(1.0, |(steps, _)| STEP.powf(*steps as f64))
    }

    /// One object to print.
    pub fn summary(&self, first: u64) -> Value {
        json!({
            "failed": self.kinds,
            "files": self.files,
            "first": first,
            "poses": self.poses,
            "refused": self.refused,
            "slowest": self.slowest,
            "stated_over_true": {
                "median": self.stated_over_true(0.5),
                "95 %": self.stated_over_true(0.95),
            },
            "true_error_over_stated": self.worst,
        })
    }

    fn state(&self, run: &Value) -> Value {
        json!({
            "failed": self.failed.iter().collect::<Vec<_>>(),
            "files": self.files,
            "kinds": self.kinds,
            "poses": self.poses,
            "refused": self.refused,
            "run": run,
            "shares": self.shares.iter().collect::<Vec<_>>(),
            "slowest": self.slowest,
            "worst": self.worst,
        })
    }

    fn of_state(state: &Value) -> Option<Self> {
        let pairs = |name: &str| -> Option<Vec<(&Value, &Value)>> {
            let each = state.get(name)?.as_array()?.iter();
            each.map(|pair| Some((pair.get(0)?, pair.get(1)?)))
                .collect()
        };
        let text = |value: &Value| value.as_str().map(str::to_owned);
        let refused = pairs("refused")?.into_iter();
        let slowest = pairs("slowest")?.into_iter();
        let shares = pairs("shares")?.into_iter();
        let failed = pairs("failed")?.into_iter();
        let kinds = state.get("kinds")?.as_object()?.iter();
        Some(Self {
            files: state.get("files")?.as_u64()?,
            poses: state.get("poses")?.as_u64()?,
            refused: refused
                .map(|(seed, why)| Some((seed.as_u64()?, text(why)?)))
                .collect::<Option<_>>()?,
            slowest: slowest
                .map(|(seconds, seed)| Some((seconds.as_f64()?, seed.as_u64()?)))
                .collect::<Option<_>>()?,
            worst: state.get("worst")?.as_f64()?,
            shares: shares
                .map(|(steps, count)| Some((steps.as_u64()?, count.as_u64()?)))
                .collect::<Option<_>>()?,
            kinds: kinds
                .map(|(kind, count)| Some((kind.clone(), count.as_u64()?)))
                .collect::<Option<_>>()?,
            failed: failed
                .map(|(seed, line)| Some((seed.as_u64()?, text(line)?)))
                .collect::<Option<_>>()?,
        })
    }
}

/// `count` files from `first` on, piece by piece. After each what came of all is written to `state`, from where a later run
/// with the same `build` goes on; `progress` is told. At the end the file is gone.
///
/// # Errors
/// [`ResumeError`]: the file cannot be read or written, or is another run's.
pub fn run_in_pieces(
    property: Property,
    (first, count, each): (u64, u64, u64),
    folder: &Path,
    state: &Path,
    build: &str,
    mut progress: impl FnMut(&Total),
) -> Result<Total, ResumeError> {
    let run = json!({ "build": build, "count": count, "first": first });
    let mut total = match std::fs::read_to_string(state) {
        Ok(text) => {
            let known: Value = serde_json::from_str(&text).map_err(|_| ResumeError::Broken)?;
            if known.get("run") != Some(&run) {
                return Err(ResumeError::Other);
            }
            Total::of_state(&known).ok_or(ResumeError::Broken)?
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Total::default(),
        Err(error) => return Err(ResumeError::File(error)),
    };
    // Whoever is ended while it writes leaves the last state whole.
    let beside = state.with_extension("new");
    while total.files < count {
        let piece = PIECE.min(count - total.files);
        let shrunk = if total.failed.is_empty() { each } else { 0 };
        total.add(&run_by(
            property,
            first + total.files,
            piece,
            shrunk,
            folder,
        ));
        let text = total.state(&run).to_string();
        std::fs::write(&beside, text)
            .and_then(|()| std::fs::rename(&beside, state))
            .map_err(ResumeError::File)?;
        progress(&total);
    }
    match std::fs::remove_file(state) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(ResumeError::File(error)),
        _ => Ok(total),
    }
}
