//! An app of logic that takes one step an update, and what a step costs.

use std::time::{Duration, Instant};

use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::time::{Fixed, Time, TimeUpdateStrategy};
use dolomite_logic::LogicPlugin;
use dolomite_testkit::cores::processor_time;

/// Steps a second.
pub const RATE: u32 = 64;

/// Without a window, 64 steps a second.
pub fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, LogicPlugin));
    let step = Duration::from_secs_f64(1.0 / f64::from(RATE));
    app.insert_resource(Time::<Fixed>::from_duration(step));
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.finish();
    app.cleanup();
    app.update();
    app
}

/// Takes a step: milliseconds by the clock, and of all cores together.
pub fn cores_ms(app: &mut App) -> (f64, f64) {
    let start = Instant::now();
    let before = processor_time(start);
    let begun = Instant::now();
    app.update();
    let wall = begun.elapsed().as_secs_f64() * 1e3;
    let used = processor_time(start).saturating_sub(before);
    (wall, used.as_secs_f64() * 1e3)
}
