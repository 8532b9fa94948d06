//! An app that renders without a window.

use std::time::Duration;

use bevy::app::{App, PluginGroup};
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::settings::{Backends, WgpuSettings};
use bevy::tasks::block_on;
use bevy::time::TimeUpdateStrategy;
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;

/// Bevy's plugins without a window, and then what `add` adds. `None`, after a line that says so, without
/// Vulkan; in CI that fails.
pub fn app(add: impl FnOnce(&mut App)) -> Option<App> {
    app_of(|app| {
        bevys(app);
        add(app);
    })
}

/// The same, where `add` adds all plugins, [`bevys`] among them.
pub fn app_of(add: impl FnOnce(&mut App)) -> Option<App> {
    if !adapter_is_there() {
        return None;
    }
    let mut app = App::new();
    add(&mut app);
    app.finish();
    app.cleanup();
    Some(app)
}

/// Adds Bevy's plugins without a window; pipelines are compiled in the frame that first needs them.
pub fn bevys(app: &mut App) {
    let settings = WgpuSettings {
        backends: Some(Backends::VULKAN),
        ..default()
    };
    app.add_plugins(
        DefaultPlugins
            .build()
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(RenderPlugin {
                render_creation: settings.into(),
                synchronous_pipeline_compilation: true,
                ..default()
            })
            .disable::<LogPlugin>()
            .disable::<WinitPlugin>()
            // Else the render world lives on another thread and cannot be asked.
            .disable::<PipelinedRenderingPlugin>(),
    )
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
        16,
    )));
}

fn adapter_is_there() -> bool {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    let instance = wgpu::Instance::new(descriptor);
    let Err(error) = block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
    else {
        return true;
    };
    assert!(
        std::env::var_os("CI").is_none(),
        "CI must not skip GPU tests: {error}"
    );
    eprintln!("skipped, no Vulkan device: {error}");
    false
}
