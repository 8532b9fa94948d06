//! Where a frame without a window spends the time of the thread that draws it: one span behind the other, from its
//! beginning to the end of its submission. What is left of the frame is the wait for the device.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use bevy::prelude::*;
use bevy::render::renderer::{RenderGraph, RenderGraphSystems};
use bevy::render::{Render, RenderApp, RenderSystems};

/// The newest frame's spans, milliseconds.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct Spans {
    /// The game: input, figures, camera, height queries, all systems of the main world.
    pub simulation: f64,
    /// Copying what is drawn into the renderer's world.
    pub extraction: f64,
    /// The renderer's preparations: meshes, uniforms, bind groups, and pipelines that are missing.
    pub preparation: f64,
    /// Recording all passes, and handing them to the device; software draws some of it before it returns.
    pub recording: f64,
    /// Waiting for the device to finish.
    pub device: f64,
}

impl Spans {
    /// Name and value of each.
    pub const ALL: [(&'static str, fn(&Self) -> f64); 5] = [
        ("simulation", |spans| spans.simulation),
        ("extraction", |spans| spans.extraction),
        ("preparation", |spans| spans.preparation),
        ("recording", |spans| spans.recording),
        ("wait for the device", |spans| spans.device),
    ];
}

/// The borders of a frame's spans, in order; the same in both worlds.
#[derive(Resource, Clone, Default)]
struct Borders(Arc<Mutex<[Option<Instant>; 5]>>);

impl Borders {
    fn note(&self, at: usize) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)[at] = Some(Instant::now());
    }
}

/// Notes the borders of each frame. For an app whose renderer has no thread of its own.
pub(super) fn add(app: &mut App) {
    let borders = Borders::default();
    app.insert_resource(borders.clone())
        .init_resource::<Spans>()
        .add_systems(First, (finish, note::<0>).chain())
        .add_systems(Last, note::<1>);
    if let Some(render) = app.get_sub_app_mut(RenderApp) {
        render
            .insert_resource(borders)
            .add_systems(Render, note::<2>.in_set(RenderSystems::ExtractCommands))
            .add_systems(RenderGraph, note::<3>.in_set(RenderGraphSystems::Begin))
            .add_systems(Render, note::<4>.in_set(RenderSystems::PostCleanup));
    }
}

fn note<const AT: usize>(borders: Res<Borders>) {
    borders.note(AT);
}

/// The next frame begins when the device has finished the last one.
fn finish(borders: Res<Borders>, mut spans: ResMut<Spans>) {
    let mut noted = borders.0.lock().unwrap_or_else(PoisonError::into_inner);
    let [
        Some(begin),
        Some(simulated),
        Some(extracted),
        Some(prepared),
        Some(recorded),
    ] = *noted
    else {
        return;
    };
    *noted = [None; 5];
    let span = |from: Instant, to: Instant| to.saturating_duration_since(from).as_secs_f64() * 1e3;
    *spans = Spans {
        simulation: span(begin, simulated),
        extraction: span(simulated, extracted),
        preparation: span(extracted, prepared),
        recording: span(prepared, recorded),
        device: span(recorded, Instant::now()),
    };
}
