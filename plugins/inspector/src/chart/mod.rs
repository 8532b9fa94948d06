//! Charts of the running scene: a setting is moved from one value to another, and at each the time of a frame is taken,
//! and the error, where one is asked for. Afterwards the setting is what it was.
//!
//! | file | concern |
//! |---|---|
//! | `run` | the setting is moved, frames are measured |
//! | `still` | the picture at a value, and how far it is from the first one (feature `picture`) |
//! | [`file`](mod@file) | a chart as JSON or CSV |

pub mod file;
mod run;
#[cfg(feature = "picture")]
mod still;

use bevy::ecs::resource::Resource;

pub use run::{ErrorOf, Order, OrderError, begin};

/// Most charts that are kept.
const KEPT: usize = 8;

/// What was measured at a value of the setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The value.
    pub value: f64,
    /// Median time of a frame, milliseconds.
    pub time: f64,
    /// Times that a tenth of the frames stayed below, and nine tenths, milliseconds.
    pub spread: [f64; 2],
    /// The error, where one was asked for.
    pub error: Option<f64>,
}

/// A chart, finished or growing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// The setting that was moved.
    pub setting: String,
    /// What the error is, and its unit; empty where none was asked for.
    pub error: String,
    /// What the time is of; empty: whole frames.
    pub time: String,
    /// In the order they were measured.
    pub points: Vec<Point>,
    /// How many there will be.
    pub wanted: usize,
    /// It is finished.
    pub done: bool,
}

/// The last charts of an app, the newest behind.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct Charts {
    list: Vec<Chart>,
    stop: bool,
}

impl Charts {
    /// All that are kept.
    #[must_use]
    pub fn list(&self) -> &[Chart] {
        &self.list
    }

    /// Ends the one that grows, after this frame.
    pub const fn stop(&mut self) {
        self.stop = true;
    }

    fn start(&mut self, chart: Chart) {
        self.stop = false;
        if self.list.len() == KEPT {
            self.list.remove(0);
        }
        self.list.push(chart);
    }

    const fn take_stop(&mut self) -> bool {
        std::mem::replace(&mut self.stop, false)
    }
}

/// The value that a share of sorted values lies below; `None` without values.
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    sorted.get((last as f64 * share).round() as usize).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_were_measured() {
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[3.0], 0.9), Some(3.0));
        let ten: Vec<f64> = (0..=10).map(f64::from).collect();
        assert_eq!(quantile(&ten, 0.5), Some(5.0));
        assert_eq!(
            [quantile(&ten, 0.1), quantile(&ten, 0.9)],
            [Some(1.0), Some(9.0)]
        );
    }

    #[test]
    fn the_oldest_chart_goes() {
        let mut charts = Charts::default();
        for k in 0..=KEPT {
            charts.start(Chart {
                wanted: k,
                ..Chart::default()
            });
        }
        assert_eq!(charts.list().len(), KEPT);
        assert_eq!(charts.list()[0].wanted, 1);
    }
}
