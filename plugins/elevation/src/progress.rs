//! How far reading has come: for whoever shows it, and on stderr for what takes longer than a second.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// From when on, and how often, a line is written.
const PATIENCE: Duration = Duration::from_secs(1);

/// How far the reading or converting of a map has come. Clones tell of the same work; another thread may look at it while one reads.
#[derive(Clone, Debug, Default)]
pub struct ElevationProgress(Arc<State>);

#[derive(Debug, Default)]
struct State {
    /// Rows of samples, whatever else is done with them.
    done: AtomicU64,
    all: AtomicU64,
    told: Mutex<Told>,
}

#[derive(Debug, Default)]
struct Told {
    what: &'static str,
    file: String,
    /// Since when this step goes on.
    began: Option<Instant>,
    on_stderr: bool,
    last: Option<Instant>,
    lines: u32,
}

/// One look at an [`ElevationProgress`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ElevationStep {
    /// What is done, for instance "reading"; empty before anything has begun.
    pub what: &'static str,
    /// Of which file.
    pub file: String,
    /// How much of it is done, 0 to 1.
    pub share: f32,
}

impl ElevationProgress {
    /// The same, with a line on stderr each second of a step that takes longer than one.
    #[must_use]
    pub fn on_stderr() -> Self {
        let progress = Self::default();
        progress.told().on_stderr = true;
        progress
    }

    /// What is being done, and how much of it is done.
    #[must_use]
    pub fn step(&self) -> ElevationStep {
        let told = self.told();
        let (done, all) = (
            self.0.done.load(Ordering::Relaxed),
            self.0.all.load(Ordering::Relaxed),
        );
        ElevationStep {
            what: told.what,
            file: told.file.clone(),
            share: (done as f64 / all.max(1) as f64).min(1.0) as f32,
        }
    }

    /// Lines that were written on stderr.
    #[must_use]
    pub fn lines(&self) -> u32 {
        self.told().lines
    }

    fn told(&self) -> std::sync::MutexGuard<'_, Told> {
        // Nothing panics while it is held; and if, then the text is still whole.
        self.0
            .told
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// A step of so many rows begins.
    pub(crate) fn begin(&self, what: &'static str, file: &str, rows: u64) {
        self.0.done.store(0, Ordering::Relaxed);
        self.0.all.store(rows, Ordering::Relaxed);
        let mut told = self.told();
        told.what = what;
        file.clone_into(&mut told.file);
        told.began = Some(Instant::now());
        told.last = None;
    }

    /// So many rows more are done.
    pub(crate) fn add(&self, rows: u64) {
        let done = self.0.done.fetch_add(rows, Ordering::Relaxed) + rows;
        // A look at the clock for each row of a large map costs nothing beside the row; others do not wait for the lock.
        let Ok(mut told) = self.0.told.try_lock() else {
            return;
        };
        if !told.on_stderr {
            return;
        }
        let now = Instant::now();
        let since = told.last.or(told.began).unwrap_or(now);
        if now.duration_since(since) < PATIENCE {
            return;
        }
        told.last = Some(now);
        told.lines += 1;
        let all = self.0.all.load(Ordering::Relaxed).max(1);
        let percent = (100.0 * done as f64 / all as f64).min(100.0);
        eprintln!("{}: {}, {percent:.0} %", told.file, told.what);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_of_more_than_a_second_is_told_and_a_short_one_is_not() {
        let progress = ElevationProgress::on_stderr();
        assert_eq!(progress.step(), ElevationStep::default());
        progress.begin("reading", "alps.tif", 8);
        progress.add(2);
        let step = progress.step();
        assert_eq!(
            (step.what, step.file.as_str(), step.share),
            ("reading", "alps.tif", 0.25)
        );
        assert_eq!(progress.lines(), 0, "no second has passed");
        progress.told().began = Instant::now().checked_sub(2 * PATIENCE);
        progress.add(2);
        progress.add(2);
        assert_eq!(progress.lines(), 1, "one a second");
        let quiet = ElevationProgress::default();
        quiet.begin("reading", "alps.tif", 8);
        quiet.told().began = Instant::now().checked_sub(2 * PATIENCE);
        quiet.add(8);
        assert_eq!((quiet.lines(), quiet.clone().step().share), (0, 1.0));
    }
}
