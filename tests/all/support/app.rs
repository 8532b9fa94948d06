//! An app that renders without a window.

use super::adapter;

use std::time::Duration;

use bevy::app::{App, PluginGroup};
use bevy::light::DirectionalLightShadowMap;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::time::TimeUpdateStrategy;
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;
use dolomite_game::run::device;

/// Bevy's plugins without a window, pipelines compiled in the frame that first needs them, every frame `step`
/// after the last; and what `add` adds. `None`, after a line that says so, without Vulkan; in CI that fails.
pub fn app(step: Duration, add: impl FnOnce(&mut App)) -> Option<App> {
    pipelined_app(step, false, add)
}

/// The same; `pipelined` renders a frame while the next is prepared.
pub fn pipelined_app(step: Duration, pipelined: bool, add: impl FnOnce(&mut App)) -> Option<App> {
    app_around(step, pipelined, |_| (), add)
}

/// The same, with what `before` adds before Bevy's plugins.
pub fn app_around(
    step: Duration,
    pipelined: bool,
    before: impl FnOnce(&mut App),
    add: impl FnOnce(&mut App),
) -> Option<App> {
    if !adapter::is_there() {
        return None;
    }
    let mut app = App::new();
    before(&mut app);
    let plugins = DefaultPlugins
        .build()
        .set(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        })
        .set(RenderPlugin {
            render_creation: device::wgpu_settings().into(),
            synchronous_pipeline_compilation: true,
            ..default()
        })
        .disable::<LogPlugin>()
        .disable::<WinitPlugin>();
    app.add_plugins(if pipelined {
        plugins
    } else {
        plugins.disable::<PipelinedRenderingPlugin>()
    })
    .insert_resource(TimeUpdateStrategy::ManualDuration(step))
    // Pictures here are small: shadow maps of Bevy's size would be most of the time on a software adapter.
    .insert_resource(DirectionalLightShadowMap { size: 512 });
    add(&mut app);
    app.finish();
    app.cleanup();
    Some(app)
}
