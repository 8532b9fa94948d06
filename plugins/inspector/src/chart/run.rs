//! The setting is moved from value to value, and frames are measured.

use std::time::Instant;

use bevy::diagnostic::DiagnosticsStore;
use bevy::ecs::world::World;
use thiserror::Error;

use super::{Chart, Charts, Point, quantile};
use crate::settings::edit::{self, EditError};
use crate::settings::place::Place;

/// Most values of a chart, and most frames at each.
const MOST: u32 = 10_000;

/// What is to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// The setting, a number.
    pub place: Place,
    /// First and last value.
    pub ends: [f64; 2],
    /// How many values, the ends included.
    pub steps: u32,
    /// Equal steps; else equal ratios, where both ends are above 0.
    pub linear: bool,
    /// Frames that go by before a value is measured.
    pub settle: u32,
    /// Frames that are measured.
    pub frames: u32,
    /// A diagnostic in place of the time of whole frames, milliseconds.
    pub time: Option<String>,
    /// What the error is.
    pub error: ErrorOf,
}

/// What the error of a value is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ErrorOf {
    /// None is measured.
    #[default]
    Nothing,
    /// The median of a diagnostic.
    Diagnostic(String),
    /// How far the picture is from that at the first value: the root of the mean square over all channels, of 1. Virtual
    /// time stands still meanwhile, and the panel is left out.
    Picture,
}

/// Why a chart is not made, or ends.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum OrderError {
    /// The setting cannot be read or set.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// Its ends are no numbers, or the same.
    #[error("a chart needs two ends that are finite and differ: {0} and {1}")]
    Ends(f64, f64),
    /// Counts that make no chart.
    #[error("a chart has 2 to {MOST} values and 1 to {MOST} frames at each")]
    Counts,
    /// There is none of the path.
    #[error("no diagnostic `{0}`; `stat` lists them")]
    Unknown(String),
    /// It never had a value meanwhile.
    #[error("the diagnostic `{0}` has no value while the chart is made")]
    Silent(String),
    /// There is no picture.
    #[error("no picture can be taken: {0}")]
    Picture(String),
}

/// The values of an order.
#[expect(
    clippy::disallowed_methods,
    reason = "where a chart is measured may differ by a rounding between machines"
)]
fn values(order: &Order) -> Vec<f64> {
    let [from, to] = order.ends;
    let ratio = !order.linear && from > 0.0 && to > 0.0;
    let last = order.steps - 1;
    let at = |k: u32| {
        let share = f64::from(k) / f64::from(last);
        match k {
            0 => from,
            k if k == last => to,
            _ if ratio => from * (to / from).powf(share),
            _ => from + (to - from) * share,
        }
    };
    (0..order.steps).map(at).collect()
}

enum Phase {
    Settle(u32),
    Measure,
    #[cfg(feature = "picture")]
    Picture(super::still::Still),
}

/// A chart that is being made: asked once a frame.
struct Run {
    order: Order,
    values: Vec<f64>,
    /// The setting as it was, as RON.
    before: String,
    /// It has no fraction.
    whole: bool,
    phase: Phase,
    last: Option<Instant>,
    times: Vec<f64>,
    errors: Vec<f64>,
    #[cfg(feature = "picture")]
    pictures: super::still::Pictures,
}

/// Begins a chart: the result is asked once a frame, and gives the chart once it is finished. The setting is then what it
/// was, whatever came between.
///
/// # Errors
/// [`OrderError`]; then nothing has changed.
pub fn begin(
    world: &mut World,
    order: Order,
) -> Result<impl FnMut(&mut World) -> Option<Result<Chart, OrderError>> + use<>, OrderError> {
    let [from, to] = order.ends;
    if !(from.is_finite() && to.is_finite() && from != to) {
        return Err(OrderError::Ends(from, to));
    }
    if !(2..=MOST).contains(&order.steps) || !(1..=MOST).contains(&order.frames) {
        return Err(OrderError::Counts);
    }
    let of_error = match &order.error {
        ErrorOf::Diagnostic(path) => Some(path),
        ErrorOf::Nothing | ErrorOf::Picture => None,
    };
    for path in order.time.iter().chain(of_error) {
        if newest(world, path).is_none() {
            return Err(OrderError::Unknown(path.clone()));
        }
    }
    if order.error == ErrorOf::Picture && !cfg!(feature = "picture") {
        return Err(OrderError::Picture(
            "the inspector was built without it".to_owned(),
        ));
    }
    let before = edit::read(world, &order.place)?;
    let mut run = Run {
        values: values(&order),
        whole: before.parse::<i64>().is_ok(),
        before,
        phase: Phase::Settle(order.settle),
        last: None,
        times: Vec::new(),
        errors: Vec::new(),
        #[cfg(feature = "picture")]
        pictures: super::still::Pictures::new(world, order.error == ErrorOf::Picture)
            .map_err(OrderError::Picture)?,
        order,
    };
    // A value beyond its range is refused before anything is measured.
    let set = run.set(world, run.values[run.values.len() - 1]);
    if let Err(error) = set.and_then(|()| run.set(world, run.values[0])) {
        // What was refused first is what is said.
        let _ = run.end(world);
        return Err(error);
    }
    let error = match &run.order.error {
        ErrorOf::Nothing => String::new(),
        ErrorOf::Diagnostic(path) => path.clone(),
        ErrorOf::Picture => "root of the mean square of the picture's channels, of 1".to_owned(),
    };
    world.get_resource_or_init::<Charts>().start(Chart {
        setting: run.order.place.to_string(),
        error,
        time: run.order.time.clone().unwrap_or_default(),
        wanted: run.values.len(),
        ..Chart::default()
    });
    Ok(move |world: &mut World| {
        let answer = run.step(world)?;
        let back = run.end(world);
        let mut charts = world.get_resource_or_init::<Charts>();
        let chart = charts.list.last_mut().map(|chart| {
            chart.done = true;
            chart.clone()
        });
        Some(answer.and(back).map(|()| chart.unwrap_or_default()))
    })
}

fn newest(world: &World, path: &str) -> Option<Option<f64>> {
    let store = world.get_resource::<DiagnosticsStore>()?;
    let mut all = store.iter();
    let found = all.find(|diagnostic| diagnostic.path().as_str() == path)?;
    Some(found.value())
}

impl Run {
    fn set(&self, world: &mut World, value: f64) -> Result<(), OrderError> {
        let text = if self.whole {
            format!("{value:.0}")
        } else {
            format!("{value:?}")
        };
        edit::write_ron(world, &self.order.place, &text)?;
        Ok(())
    }

    /// Leaves the app as it was.
    fn end(&mut self, world: &mut World) -> Result<(), OrderError> {
        #[cfg(feature = "picture")]
        self.pictures.end(world);
        edit::write_ron(world, &self.order.place, &self.before)?;
        Ok(())
    }

    /// A frame; `None` while there is more to do.
    fn step(&mut self, world: &mut World) -> Option<Result<(), OrderError>> {
        if world.get_resource_or_init::<Charts>().take_stop() {
            return Some(Ok(()));
        }
        match self.go_on(world) {
            Ok(false) => None,
            Ok(true) => Some(Ok(())),
            Err(error) => Some(Err(error)),
        }
    }

    /// Whether the last value was measured.
    fn go_on(&mut self, world: &mut World) -> Result<bool, OrderError> {
        let now = Instant::now();
        let last = self.last.replace(now);
        match &mut self.phase {
            Phase::Settle(left) if *left > 0 => *left -= 1,
            // The time of a frame ends with the next one.
            Phase::Settle(_) => self.phase = Phase::Measure,
            Phase::Measure => {
                let whole = last.map(|last| 1e3 * (now - last).as_secs_f64());
                let time = match &self.order.time {
                    Some(path) => newest(world, path).flatten(),
                    None => whole,
                };
                self.times.extend(time);
                if let ErrorOf::Diagnostic(path) = &self.order.error {
                    self.errors.extend(newest(world, path).flatten());
                }
                let frames = self.order.frames as usize;
                // A diagnostic may say nothing: then it is not waited for.
                if time.is_none() && self.times.is_empty() {
                    let path = self.order.time.clone().unwrap_or_default();
                    return Err(OrderError::Silent(path));
                }
                if self.times.len() >= frames {
                    return self.measured(world);
                }
            }
            #[cfg(feature = "picture")]
            Phase::Picture(still) => {
                if let Some(error) = self
                    .pictures
                    .take(world, still)
                    .map_err(OrderError::Picture)?
                {
                    self.errors.push(error);
                    return self.noted(world);
                }
            }
        }
        Ok(false)
    }

    fn measured(&mut self, world: &mut World) -> Result<bool, OrderError> {
        #[cfg(feature = "picture")]
        if self.order.error == ErrorOf::Picture {
            let still = self.pictures.ask(world);
            self.phase = Phase::Picture(still);
            return Ok(false);
        }
        if let ErrorOf::Diagnostic(path) = &self.order.error
            && self.errors.is_empty()
        {
            return Err(OrderError::Silent(path.clone()));
        }
        self.noted(world)
    }

    /// Keeps a point, and goes on to the next value.
    fn noted(&mut self, world: &mut World) -> Result<bool, OrderError> {
        self.times.sort_by(f64::total_cmp);
        self.errors.sort_by(f64::total_cmp);
        let time = |share| quantile(&self.times, share).unwrap_or(f64::NAN);
        let mut charts = world.get_resource_or_init::<Charts>();
        let Some(chart) = charts.list.last_mut() else {
            return Ok(true);
        };
        let at = chart.points.len();
        chart.points.push(Point {
            value: self.values[at],
            time: time(0.5),
            spread: [time(0.1), time(0.9)],
            error: quantile(&self.errors, 0.5),
        });
        self.times.clear();
        self.errors.clear();
        let Some(next) = self.values.get(at + 1).copied() else {
            return Ok(true);
        };
        self.set(world, next)?;
        self.phase = Phase::Settle(self.order.settle);
        Ok(false)
    }
}
