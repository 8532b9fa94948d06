//! Where times of frames come from, and where they wait to be taken in.

use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore};
use bevy::prelude::*;

/// A measured frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeSample {
    /// What it took. One that is not finite and above 0 is passed over.
    pub milliseconds: f32,
    /// The tolerance that it was drawn with, pixels.
    pub tau: f32,
    /// Triangles (or vertices, as long as it is always the same) that were counted in it, if they were:
    /// they correct what the work curve predicts.
    pub triangles: Option<u32>,
    /// Which frame, as [`NextFrame::number`](super::NextFrame::number) had it. A frame that is no longer
    /// remembered is passed over.
    pub frame: u64,
}

/// Where a camera's time is measured.
///
/// Reflected as a whole: paths of diagnostics have no parts.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(opaque)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub enum FrameTime {
    /// By whoever pushes it into the camera's [`TimeSamples`], with the frame that it is of. Nobody in Dolomite
    /// does: put one of the others beside a [`Budget`](super::Budget) unless your app does.
    #[default]
    Given,
    /// The sum of the newest values of diagnostics in milliseconds, as Bevy's render diagnostics publish
    /// the spans of GPU passes (`render/<span>/elapsed_gpu`). Counts when one of them is new and none
    /// is missing.
    Diagnostics {
        /// Which are added up.
        paths: Vec<DiagnosticPath>,
        /// Frames between a frame's decision and the moment when its time is known. Diagnostics carry no number;
        /// 3 is the most that Bevy's take. Rather one too many: a time taken for one of an older view is
        /// passed over, one taken for one of a newer view misleads.
        lag: u32,
    },
    /// Wall time from frame to frame. With a display that waits for its refresh it is never below the
    /// refresh, whatever is drawn.
    Wall {
        /// As above; 1 where the CPU is the slower one.
        lag: u32,
    },
}

impl FrameTime {
    /// The sum of the GPU's times of render passes, by the names of their spans. Needs Bevy's
    /// `RenderDiagnosticsPlugin`.
    #[must_use]
    pub fn of_passes(spans: &[&str]) -> Self {
        let path = |span: &&str| DiagnosticPath::new(format!("render/{span}/elapsed_gpu"));
        Self::Diagnostics {
            paths: spans.iter().map(path).collect(),
            lag: 3,
        }
    }

    /// What has to be there for a time to come, where none has come.
    pub(super) fn missing(&self, diagnostics: Option<&DiagnosticsStore>) -> String {
        let (paths, store) = match (self, diagnostics) {
            (Self::Given, _) => {
                return "nobody pushes into its TimeSamples; put a FrameTime beside the Budget \
                        that says where times come from (the ground's is `frame_time()`)"
                    .to_owned();
            }
            (Self::Wall { .. }, _) => return "the app has no `Time<Real>` that goes on".to_owned(),
            (Self::Diagnostics { .. }, None) => {
                return "the app has no DiagnosticsStore; add Bevy's DiagnosticsPlugin".to_owned();
            }
            (Self::Diagnostics { paths, .. }, Some(store)) => (paths, store),
        };
        let silent = paths
            .iter()
            .filter(|path| store.get_measurement(path).is_none());
        let silent: Vec<&str> = silent.map(DiagnosticPath::as_str).collect();
        format!(
            "there is no measurement of {silent:?}; times of passes need Bevy's RenderDiagnosticsPlugin, a device \
             with timestamp queries (Vulkan, DirectX 12), and that the passes run"
        )
    }
}

/// Measured frames that have not been taken in. In the order of frames; emptied every frame.
#[derive(Component, Clone, Debug, Default, PartialEq)]
pub struct TimeSamples {
    waiting: Vec<TimeSample>,
    /// Whether there was ever a time, of whichever frame.
    come: bool,
}

impl TimeSamples {
    /// Most that wait.
    const MOST: usize = 64;

    /// Adds a measured frame; its number is [`BudgetReport::frame`](super::BudgetReport::frame) as it stood
    /// when it was drawn. What is over 64 in a frame is dropped.
    pub fn push(&mut self, sample: TimeSample) {
        self.sees(sample.milliseconds);
        if self.waiting.len() < Self::MOST {
            self.waiting.push(sample);
        }
    }

    /// Takes notice of a time that may be of no frame that is known.
    pub(super) fn sees(&mut self, milliseconds: f32) {
        self.come |= milliseconds.is_finite() && milliseconds > 0.0;
    }

    /// Whether there was ever a time that can be used.
    pub(super) const fn has_come(&self) -> bool {
        self.come
    }

    /// What waits.
    pub(super) fn take(&mut self) -> impl Iterator<Item = TimeSample> {
        self.waiting.drain(..)
    }
}

/// Sum of the newest values, and when the newest of them came; `None` if one is missing.
pub(super) fn newest_sum(
    store: &DiagnosticsStore,
    paths: &[DiagnosticPath],
) -> Option<(f64, bevy::platform::time::Instant)> {
    let mut found: Option<(f64, bevy::platform::time::Instant)> = None;
    for path in paths {
        let next = store.get_measurement(path)?;
        let (sum, when) = found.unwrap_or((0.0, next.time));
        found = Some((sum + next.value, when.max(next.time)));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::diagnostic::{Diagnostic, DiagnosticMeasurement};

    #[test]
    fn what_is_missing_is_named() {
        let source = FrameTime::of_passes(&["there", "gone"]);
        assert!(source.missing(None).contains("DiagnosticsStore"));
        assert!(FrameTime::Given.missing(None).contains("TimeSamples"));
        let mut store = DiagnosticsStore::default();
        let mut there = Diagnostic::new(DiagnosticPath::new("render/there/elapsed_gpu"));
        there.add_measurement(DiagnosticMeasurement {
            time: bevy::platform::time::Instant::now(),
            value: 1.0,
        });
        store.add(there);
        let missing = source.missing(Some(&store));
        assert!(missing.contains("render/gone/elapsed_gpu"), "{missing}");
        assert!(!missing.contains("render/there"), "{missing}");
        assert!(missing.contains("RenderDiagnosticsPlugin"), "{missing}");
    }
}
