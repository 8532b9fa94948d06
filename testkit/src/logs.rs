//! What an app says: warnings and errors, kept for tests that ask how often one came.
//!
//! A process has one log, and systems run on any thread. A test that counts has its process to itself, or counts
//! what it alone can cause.

use std::fmt::{self, Write as _};
use std::sync::{Mutex, Once, PoisonError};

use bevy::log::tracing::field::{Field, Visit};
use bevy::log::tracing::subscriber::set_global_default;
use bevy::log::tracing::{Event, Level, Subscriber};
use bevy::log::tracing_subscriber::layer::{Context, SubscriberExt as _};
use bevy::log::tracing_subscriber::{Layer, Registry};

static KEPT: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Keeps events as they come.
struct Keep;

impl<S: Subscriber> Layer<S> for Keep {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        // The graver, the less.
        if *event.metadata().level() > Level::WARN {
            return;
        }
        let mut line = Line(format!("{}: ", event.metadata().target()));
        event.record(&mut line);
        let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push(line.0);
    }
}

/// Module and message of an event.
struct Line(String);

impl Visit for Line {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        if field.name() == "message" {
            // Into a string: it cannot fail.
            let _ = write!(self.0, "{value:?}");
        }
    }
}

/// Begins to keep warnings and errors, before the app is made. For apps without Bevy's `LogPlugin`; called again it
/// does nothing.
///
/// # Panics
/// If the process has another log already.
pub fn keep() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        set_global_default(Registry::default().with(Keep)).expect("no other log in a test");
    });
}

/// The warnings and errors so far in which a text occurs, each after the module that it came from.
#[must_use]
pub fn with(text: &str) -> Vec<String> {
    let kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    let found = kept.iter().filter(|line| line.contains(text));
    found.cloned().collect()
}

#[cfg(test)]
mod tests {
    use bevy::log::{error, info, warn};

    #[test]
    fn warnings_and_errors_are_kept_from_every_thread() {
        super::keep();
        super::keep();
        let number = 7;
        std::thread::spawn(move || warn!("of logs {number}"))
            .join()
            .unwrap();
        error!("of logs, an error");
        info!("of logs, no warning");
        let kept = super::with("of logs");
        assert_eq!(kept.len(), 2, "{kept:?}");
        assert!(kept[0].starts_with("dolomite_testkit::logs") && kept[0].ends_with("of logs 7"));
        assert!(super::with("of nothing").is_empty());
    }
}
