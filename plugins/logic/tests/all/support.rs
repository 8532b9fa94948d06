//! An app that takes one step an update.

use bevy::MinimalPlugins;
use bevy::app::{App, FixedUpdate};
use bevy::ecs::prelude::*;
use bevy::time::{Fixed, Time, TimeUpdateStrategy};
use dolomite_logic::{Action, Key, LogicPlugin, LogicSystems, Output, Value};
use std::time::{Duration, Instant};

/// Of a step.
pub const SECONDS: f32 = 1.0 / 64.0;

/// What was said so far.
#[derive(Resource, Default)]
pub struct Said(pub Vec<Output>);

fn listen(mut outputs: MessageReader<Output>, mut said: ResMut<Said>) {
    said.0.extend(outputs.read().copied());
}

/// With the plugin added twice, which does no harm.
pub fn app() -> App {
    app_with(|_| ())
}

/// The same with plugins of others.
pub fn app_with(add: impl FnOnce(&mut App)) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, LogicPlugin));
    add(&mut app);
    app.add_plugins(LogicPlugin);
    let step = Duration::from_secs_f64(1.0 / 64.0);
    app.insert_resource(Time::<Fixed>::from_duration(step));
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.init_resource::<Said>();
    app.add_systems(FixedUpdate, listen.after(LogicSystems::Wire));
    app.finish();
    app.cleanup();
    app.update();
    app
}

pub fn steps(app: &mut App, count: usize) {
    for _ in 0..count {
        app.update();
    }
}

pub fn act(app: &mut App, target: Entity, verb: Key, parameter: impl Into<Value>) {
    let action = Action::new(target, verb, parameter);
    app.world_mut().write_message(action);
}

/// What was said, without who said it with what.
pub fn said(app: &mut App) -> Vec<(Entity, Key)> {
    let said = std::mem::take(&mut app.world_mut().resource_mut::<Said>().0);
    said.iter()
        .map(|output| (output.source, output.name))
        .collect()
}

/// Nanoseconds that all threads of this process were on a core: what others do on the machine is not in it.
fn on_cores() -> Option<f64> {
    let tasks = std::fs::read_dir("/proc/self/task").ok()?;
    let mut sum = 0.0;
    for task in tasks {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        sum += text.split_whitespace().next()?.parse::<f64>().ok()?;
    }
    Some(sum)
}

/// The least of some runs, milliseconds, and what a run takes of all cores on the mean; the least where the system
/// does not say.
pub fn milliseconds(runs: u32, mut work: impl FnMut()) -> (f64, f64) {
    let before = on_cores();
    let mut least = f64::INFINITY;
    for _ in 0..runs {
        let begun = Instant::now();
        work();
        least = least.min(begun.elapsed().as_secs_f64() * 1e3);
    }
    let on_cores = before.zip(on_cores()).map(|(before, after)| after - before);
    (
        least,
        on_cores.map_or(least, |ns| ns / 1e6 / f64::from(runs)),
    )
}
