//! An app that plays into memory.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use dolomite_sound::{
    SoundCounters, SoundFault, SoundListener, SoundOutput, SoundPlugin, SoundSettings, SoundTarget,
};

/// Samples a second.
pub const RATE: u32 = 44_100;

/// Samples of a frame of 60 a second.
pub const FRAME: usize = RATE as usize / 60;

/// An app without a listener.
pub fn deaf() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, SoundPlugin))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
            1.0 / 60.0,
        )));
    let mut settings = app.world_mut().resource_mut::<SoundSettings>();
    settings.target = SoundTarget::Samples { rate: RATE };
    settings.volume = 1.0;
    app
}

/// An app with a listener at the origin, who looks along −z.
pub fn app() -> App {
    let mut app = deaf();
    app.world_mut().spawn(SoundListener);
    app.update();
    app
}

/// Plays so many frames of 60 a second.
pub fn play(app: &mut App, frames: usize) -> Vec<[f32; 2]> {
    let mut all = Vec::with_capacity(frames * FRAME);
    for _ in 0..frames {
        app.update();
        let mut output = app.world_mut().resource_mut::<SoundOutput>();
        all.extend(output.render(FRAME).expect("an output of samples"));
    }
    all
}

pub fn counters(app: &App) -> SoundCounters {
    *app.world().resource::<SoundCounters>()
}

/// What was refused since this was asked last, as text.
pub fn faults(app: &mut App) -> Vec<String> {
    let mut messages = app.world_mut().resource_mut::<Messages<SoundFault>>();
    messages.drain().map(|fault| fault.0.to_string()).collect()
}

/// Root of the mean square, left and right.
pub fn loud(samples: &[[f32; 2]]) -> [f32; 2] {
    [0, 1].map(|side| {
        let square: f64 = samples
            .iter()
            .map(|pair| f64::from(pair[side]) * f64::from(pair[side]))
            .sum();
        (square / samples.len().max(1) as f64).sqrt() as f32
    })
}

/// The greatest sample.
pub fn peak(samples: &[[f32; 2]]) -> f32 {
    samples
        .iter()
        .flatten()
        .fold(0.0, |most, sample| most.max(sample.abs()))
}

/// The greatest step from one sample to the next.
pub fn steepest(samples: &[[f32; 2]]) -> f32 {
    let steps = samples
        .windows(2)
        .flat_map(|two| [0, 1].map(|side| two[1][side] - two[0][side]));
    steps.fold(0.0, |most, step| most.max(step.abs()))
}
