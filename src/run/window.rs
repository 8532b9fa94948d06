//! The game in a window.

use bevy::app::AppExit;
use bevy::asset::AssetPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::window::{PresentMode, PrimaryWindow, Window, WindowPlugin, WindowResolution};

use super::device::Device;
use super::patient::PatientRenderingPlugin;
use super::{GameError, Setup, device, log_plugin};
use crate::input::devices::InputPlugin;
use crate::settings::quality::DeviceKind;
use crate::sound::GameSoundPlugin;
use crate::view::quality::DrawnBy;
use crate::view::start::Hidden;

/// Opens the window and plays until the player leaves.
///
/// # Errors
/// [`GameError`] when there is no display or no device.
pub fn play(setup: Setup) -> Result<AppExit, GameError> {
    let (mut app, _) = app(setup)?;
    Ok(app.run())
}

/// The game in its window, not yet running, and what draws it.
///
/// # Errors
/// [`GameError`] when there is no display or no device.
pub fn app(setup: Setup) -> Result<(App, Device), GameError> {
    device::display()?;
    let device = device::probe()?;
    let software = device.kind == DeviceKind::Software;
    if software {
        eprintln!(
            "dolomite: `{}` draws on the CPU; expect a few frames a second",
            device.name
        );
    }
    let (width, height) = setup.settings.window;
    let present_mode = if setup.settings.vsync {
        PresentMode::AutoVsync
    } else {
        PresentMode::AutoNoVsync
    };
    let mut app = App::new();
    app.add_plugins(
        DefaultPlugins
            .set(WindowPlugin {
                primary_window: Some(Window {
                    title: format!("Dolomite - {}", setup.scene.name),
                    name: Some("dolomite".to_owned()),
                    resolution: WindowResolution::new(width, height),
                    present_mode,
                    visible: false,
                    ..default()
                }),
                ..default()
            })
            .set(RenderPlugin {
                render_creation: device::wgpu_settings().into(),
                ..default()
            })
            .set(AssetPlugin {
                file_path: setup.assets.to_string_lossy().into_owned(),
                ..default()
            })
            .set(log_plugin()),
    );
    app.add_plugins(PatientRenderingPlugin { always: software });
    app.insert_resource(DrawnBy(Some(device.kind)));
    setup.add_behind_start_screen(&mut app);
    app.add_systems(PreStartup, hide_until_drawn);
    app.add_plugins((InputPlugin, GameSoundPlugin));
    Ok((app, device))
}

/// The window was made unseen; the start screen shows it.
fn hide_until_drawn(mut commands: Commands, windows: Query<Entity, With<PrimaryWindow>>) {
    for window in &windows {
        commands.entity(window).insert(Hidden);
    }
}
