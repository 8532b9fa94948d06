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
    /// Bytes that are used of buffers, or all of them where a plugin says no more.
    pub bytes: Option<f64>,
    /// Bytes that are allocated.
    pub allocated: Option<f64>,
    /// Render and compute passes, milliseconds of the GPU together.
    pub gpu: Option<f64>,
}

/// The sums of each group that has any.
#[must_use]
pub fn totals(store: &DiagnosticsStore) -> Vec<Totals> {
    let mut all: Vec<Totals> = Vec::new();
    for measure in measures(store, "") {
        let name = measure.path.rsplit('/').next().unwrap_or_default();
        // What is published of each view stands below the sum, and is not counted twice.
        let kind = match name {
            "dispatches" => 0,
            "primitives" | "triangles" => 1,
            "bytes" => 2,
            "allocated" => 3,
            "elapsed_gpu" => 4,
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
            3 => &mut last.allocated,
            _ => &mut last.gpu,
        };
        *sum = Some(sum.unwrap_or(0.0) + value);
    }
    all
}

/// What a plugin does in a view, so far as it publishes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewTotals {
    /// The plugin.
    pub group: String,
    /// What of it.
    pub kind: String,
    /// The camera, as it is written.
    pub view: String,
    /// Passes, and dispatches of compute passes.
    pub passes: Option<f64>,
    /// Triangles and other primitives.
    pub primitives: Option<f64>,
    /// Bytes of buffers and textures.
    pub bytes: Option<f64>,
}

/// What each view has, by plugin: diagnostics of the path `dolomite/PLUGIN/MEASURE/KIND/VIEW`. Views that are gone have
/// 0 of all, and are left out.
#[must_use]
pub fn view_totals(store: &DiagnosticsStore) -> Vec<ViewTotals> {
    let mut all: Vec<ViewTotals> = Vec::new();
    for measure in measures(store, "dolomite/") {
        let parts: Vec<_> = measure.path.split('/').collect();
        let (&["dolomite", group, name, kind, view], Some(value)) = (&parts[..], measure.value)
        else {
            continue;
        };
        let known = |of: &ViewTotals| (&*of.group, &*of.kind, &*of.view) == (group, kind, view);
        let at = all.iter().position(known).unwrap_or_else(|| {
            all.push(ViewTotals {
                group: group.to_owned(),
                kind: kind.to_owned(),
                view: view.to_owned(),
                ..ViewTotals::default()
            });
            all.len() - 1
        });
        let sum = match name {
            "passes" | "dispatches" => &mut all[at].passes,
            "primitives" | "triangles" => &mut all[at].primitives,
            "bytes" | "allocated" => &mut all[at].bytes,
            _ => continue,
        };
        *sum = Some(sum.unwrap_or(0.0) + value);
    }
    all.retain(|of| {
        let values = [of.passes, of.primitives, of.bytes];
        values.into_iter().flatten().any(|value| value != 0.0)
    });
    all
}

/// Names of diagnostics that say that something was left out, and why that is.
const REASONS: [(&str, &str); 8] = [
    ("skipped", "nothing that it depends on has changed"),
    ("culled", "it cannot be seen from here"),
    (
        "discarded",
        "it lies outside of the view, or behind what is drawn",
    ),
    ("hidden", "it lies behind what is drawn"),
    (
        "asleep",
        "nothing happened to it: it wakes when something does",
    ),
    ("resting", "it is too small in the picture, or out of it"),
    (
        "interpolated",
        "it is small in the picture: every second frame is enough",
    ),
    ("lowered", "the pool has no more room: levels so much lower"),
];

/// What was left out, and why: diagnostics whose names say so.
#[must_use]
pub fn skipped(store: &DiagnosticsStore) -> Vec<(Measure, &'static str)> {
    let all = measures(store, "").into_iter();
    let with_reason = all.filter_map(|measure| {
        let name = measure.path.rsplit('/').next().unwrap_or_default();
        let mut known = REASONS.iter();
        let (_, reason) = known.find(|(known, _)| *known == name)?;
        Some((measure, *reason))
    });
    with_reason.collect()
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
            ("dolomite/geometry/bytes", &[80.0]),
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
        assert_eq!(all.len(), 9);
        assert_eq!(measures(&store, "LOGIC").len(), 1);
        let totals = totals(&store);
        let names: Vec<_> = totals.iter().map(|totals| totals.group.as_str()).collect();
        assert_eq!(names, ["geometry", "render"]);
        assert_eq!(totals[0].dispatches, Some(3.0));
        assert_eq!(totals[0].primitives, Some(70.0));
        assert_eq!((totals[0].bytes, totals[0].gpu), (Some(80.0), None));
        assert_eq!(totals[0].allocated, Some(100.0));
        assert!(totals[1].gpu.is_some_and(f64::is_nan));
        let skipped = skipped(&store);
        assert_eq!(skipped[0].0.path, "dolomite/logic/asleep");
        assert!(skipped[0].1.contains("nothing happened"), "{skipped:?}");
        assert_eq!(skipped.len(), 1);
    }

    #[test]
    fn what_a_view_has_is_summed_by_plugin_and_kind_and_what_is_gone_left_out() {
        let mut store = store();
        for (path, value) in [
            ("dolomite/geometry/primitives/Kind/7v0", 50.0),
            ("dolomite/geometry/allocated/Kind/9v0", 0.0),
            ("dolomite/deferred/passes/light/7v0", 2.0),
            ("dolomite/deferred/passes/light", 9.0),
            ("dolomite/deferred/other/light/8v0", 9.0),
        ] {
            let mut diagnostic = Diagnostic::new(DiagnosticPath::new(path));
            diagnostic.add_measurement(DiagnosticMeasurement {
                time: Instant::now(),
                value,
            });
            store.add(diagnostic);
        }
        let views = view_totals(&store);
        let names: Vec<_> = views.iter().map(|of| (&*of.kind, &*of.view)).collect();
        assert_eq!(names, [("light", "7v0"), ("Kind", "7v0")]);
        assert_eq!(views[0].passes, Some(2.0));
        assert_eq!(
            (views[1].primitives, views[1].bytes, views[1].passes),
            (Some(50.0), Some(60.0), None)
        );
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
