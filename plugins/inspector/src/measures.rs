//! Diagnostics by plugin: newest values, histories, sums; and those that are watched.
//!
//! Bevy keeps the history of each diagnostic itself, so nothing is recorded here, and nothing is done while nobody looks.

use bevy::diagnostic::{Diagnostic, DiagnosticPath, DiagnosticsStore};
use bevy::ecs::prelude::*;
use thiserror::Error;

/// A diagnostic as it is now.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Its path.
    pub path: String,
    /// The plugin that it is of, or the first part of the path.
    pub group: String,
    /// The newest value.
    pub value: Option<f64>,
    /// The mean of those that are kept.
    pub average: Option<f64>,
    /// The unit.
    pub unit: String,
}

impl Measure {
    fn of(diagnostic: &Diagnostic) -> Self {
        let path = diagnostic.path().as_str();
        Self {
            path: path.to_owned(),
            group: group(path).to_owned(),
            value: diagnostic.value(),
            average: diagnostic.average(),
            unit: unit(diagnostic),
        }
    }
}

/// What it is measured in: what it says itself, else what its name says.
fn unit(diagnostic: &Diagnostic) -> String {
    let suffix = diagnostic.suffix.trim();
    if !suffix.is_empty() {
        return suffix.to_owned();
    }
    let path = diagnostic.path().as_str();
    let unit = if path.contains("/elapsed_") {
        "ms"
    } else if path.ends_with("/bytes") || path.contains("/allocated") {
        "B"
    } else {
        ""
    };
    unit.to_owned()
}

/// The group of a path: `geometry` of `dolomite/geometry/bytes`, `render` of `render/main_opaque_pass_3d/elapsed_gpu`.
#[must_use]
pub fn group(path: &str) -> &str {
    let mut parts = path.split('/');
    let first = parts.next().unwrap_or_default();
    match (first, parts.next(), parts.next()) {
        ("dolomite", Some(plugin), Some(_)) => plugin,
        _ => first,
    }
}

/// The diagnostics whose path contains `filter`, by group and path. Those that are switched off are left out.
#[must_use]
pub fn measures(store: &DiagnosticsStore, filter: &str) -> Vec<Measure> {
    let filter = filter.to_lowercase();
    let mut measures: Vec<_> = store
        .iter()
        .filter(|diagnostic| diagnostic.is_enabled)
        .filter(|diagnostic| diagnostic.path().as_str().to_lowercase().contains(&filter))
        .map(Measure::of)
        .collect();
    measures.sort_by(|a, b| (&a.group, &a.path).cmp(&(&b.group, &b.path)));
    measures
}

/// What a plugin does in a frame, so far as it publishes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Totals {
    /// The plugin.
    pub group: String,
    /// Dispatches of compute passes.
    pub dispatches: Option<f64>,
    /// Triangles and other primitives.
    pub primitives: Option<f64>,
    /// Bytes of buffers and textures.
    pub bytes: Option<f64>,
    /// Render and compute passes, milliseconds of the GPU together.
    pub gpu: Option<f64>,
}

/// The sums of each group that has any.
#[must_use]
pub fn totals(store: &DiagnosticsStore) -> Vec<Totals> {
    let mut all: Vec<Totals> = Vec::new();
    for measure in measures(store, "") {
        let name = measure.path.rsplit('/').next().unwrap_or_default();
        // Of the bytes that are allocated also those of each pool are published, below the sum.
        let kind = match name {
            "dispatches" => 0,
            "primitives" | "triangles" => 1,
            "bytes" | "allocated" => 2,
            "elapsed_gpu" => 3,
            _ => continue,
        };
        if all.last().is_none_or(|last| last.group != measure.group) {
            all.push(Totals {
                group: measure.group.clone(),
                ..Totals::default()
            });
        }
        let (Some(last), Some(value)) = (all.last_mut(), measure.value) else {
            continue;
        };
        let sum = match kind {
            0 => &mut last.dispatches,
            1 => &mut last.primitives,
            2 => &mut last.bytes,
            _ => &mut last.gpu,
        };
        *sum = Some(sum.unwrap_or(0.0) + value);
    }
    all
}

/// What was left out: diagnostics whose names say so.
#[must_use]
pub fn skipped(store: &DiagnosticsStore) -> Vec<Measure> {
    const WORDS: [&str; 8] = [
        "skipped",
        "culled",
        "discarded",
        "hidden",
        "asleep",
        "resting",
        "interpolated",
        "lowered",
    ];
    let mut measures = measures(store, "");
    measures.retain(|measure| {
        let name = measure.path.rsplit('/').next().unwrap_or_default();
        WORDS.contains(&name)
    });
    measures
}

/// Times and values that are kept of a diagnostic, seconds before the newest, the oldest first.
#[must_use]
pub fn history(store: &DiagnosticsStore, path: &str) -> Vec<[f64; 2]> {
    let Some(diagnostic) = store.get(&DiagnosticPath::new(path.to_owned())) else {
        return Vec::new();
    };
    let newest = diagnostic.measurement().map(|newest| newest.time);
    let measurements = diagnostic
        .measurements()
        .filter(|one| one.value.is_finite());
    measurements
        .filter_map(|one| {
            let ago = newest?.saturating_duration_since(one.time);
            Some([-ago.as_secs_f64(), one.value])
        })
        .collect()
}

/// The diagnostics that are drawn as plots, in order.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub struct Watched(Vec<String>);

/// Why a diagnostic is not watched.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WatchError {
    /// There is none of the path.
    #[error("no diagnostic `{0}`; `stat` lists them")]
    Unknown(String),
    /// It is watched already.
    #[error("`{0}` is watched already")]
    Twice(String),
    /// It was not watched.
    #[error("`{0}` is not watched")]
    Not(String),
}

impl Watched {
    /// Their paths.
    #[must_use]
    pub fn paths(&self) -> &[String] {
        &self.0
    }

    /// Watches one.
    ///
    /// # Errors
    /// [`WatchError::Unknown`], [`WatchError::Twice`].
    pub fn watch(&mut self, store: &DiagnosticsStore, path: &str) -> Result<(), WatchError> {
        if path.is_empty() || store.get(&DiagnosticPath::new(path.to_owned())).is_none() {
            return Err(WatchError::Unknown(path.to_owned()));
        }
        if self.0.iter().any(|known| known == path) {
            return Err(WatchError::Twice(path.to_owned()));
        }
        self.0.push(path.to_owned());
        Ok(())
    }

    /// Watches it no more.
    ///
    /// # Errors
    /// [`WatchError::Not`].
    pub fn forget(&mut self, path: &str) -> Result<(), WatchError> {
        let known = self.0.iter().position(|known| known == path);
        let known = known.ok_or_else(|| WatchError::Not(path.to_owned()))?;
        self.0.remove(known);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::diagnostic::DiagnosticMeasurement;
    use std::time::{Duration, Instant};

    fn store() -> DiagnosticsStore {
        let mut store = DiagnosticsStore::default();
        let start = Instant::now();
        for (path, values) in [
            ("dolomite/geometry/dispatches", &[1.0, 3.0][..]),
            ("dolomite/geometry/primitives", &[70.0]),
            ("dolomite/geometry/allocated", &[100.0]),
            ("dolomite/geometry/allocated/Kind/7v0", &[60.0]),
            ("dolomite/logic/asleep", &[4.0]),
            ("render/a/elapsed_gpu", &[0.5]),
            ("render/b/elapsed_gpu", &[0.25, f64::NAN]),
            ("fps", &[]),
        ] {
            let mut diagnostic = Diagnostic::new(DiagnosticPath::new(path));
            for (k, value) in values.iter().enumerate() {
                diagnostic.add_measurement(DiagnosticMeasurement {
                    time: start + Duration::from_millis(100 * k as u64),
                    value: *value,
                });
            }
            // Twice under one name: Bevy keeps the later one, and it is listed once.
            store.add(Diagnostic::new(DiagnosticPath::new(path)));
            store.add(diagnostic);
        }
        store
    }

    #[test]
    fn diagnostics_are_listed_once_and_summed_by_plugin() {
        let store = store();
        let all = measures(&store, "");
        assert_eq!(all.len(), 8);
        assert_eq!(measures(&store, "LOGIC").len(), 1);
        let totals = totals(&store);
        let names: Vec<_> = totals.iter().map(|totals| totals.group.as_str()).collect();
        assert_eq!(names, ["geometry", "render"]);
        assert_eq!(totals[0].dispatches, Some(3.0));
        assert_eq!(totals[0].primitives, Some(70.0));
        assert_eq!((totals[0].bytes, totals[0].gpu), (Some(100.0), None));
        assert!(totals[1].gpu.is_some_and(f64::is_nan));
        let skipped = skipped(&store);
        assert_eq!(skipped[0].path, "dolomite/logic/asleep");
        assert_eq!(skipped.len(), 1);
    }

    #[test]
    fn histories_are_times_before_the_newest() {
        let store = store();
        let history = history(&store, "dolomite/geometry/dispatches");
        assert_eq!(history.len(), 2);
        assert!((history[0][0] + 0.1).abs() < 1e-9, "{history:?}");
        assert_eq!((history[0][1], history[1]), (1.0, [0.0, 3.0]));
        assert_eq!(super::history(&store, "render/b/elapsed_gpu").len(), 1);
        assert!(super::history(&store, "nothing").is_empty());
    }

    #[test]
    fn one_name_twice_is_a_message() {
        let store = store();
        let mut watched = Watched::default();
        assert_eq!(watched.watch(&store, "fps"), Ok(()));
        let twice = watched.watch(&store, "fps").unwrap_err();
        assert_eq!(twice.to_string(), "`fps` is watched already");
        for unknown in ["", "nothing"] {
            let error = watched.watch(&store, unknown).unwrap_err();
            assert_eq!(error, WatchError::Unknown(unknown.to_owned()));
        }
        assert_eq!(watched.forget("fps"), Ok(()));
        assert!(watched.forget("fps").is_err());
    }
}
