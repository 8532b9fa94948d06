//! What is drawn: a window with tabs, and the console, by `bevy_egui`.
//!
//! They have a camera of their own, which draws nothing but them over the others, so that no camera of the app is
//! touched. It is there while something is open; `bevy_egui`'s systems run as long.
//!
//! | file | concern |
//! |---|---|
//! | `shell` | windows and tabs |
//! | [`state`] | what they remember, and what widgets ask for |
//! | `values` | a value by reflection as widgets |
//! | `settings`, `entities`, `measures`, `frame` | a tab each |
//! | `plot`, `chart` | a history as a line; charts of the running scene |
//! | `console` | the console |
//! | `clip` | text for other programs |

mod chart;
mod clip;
mod console;
mod entities;
mod frame;
mod measures;
mod plot;
mod settings;
mod shell;
pub mod state;
mod values;

use bevy::camera::visibility::RenderLayers;
use bevy::camera::{CameraOutputMode, ClearColorConfig, RenderTarget};
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::BlendState;
use bevy_egui::{
    EguiGlobalSettings, EguiManagedTextures, EguiPlugin, EguiPostUpdateSet, EguiPreUpdateSet,
    EguiSchedule,
};

/// For windows of an app's own in [`InspectorPass`].
pub use bevy_egui::{EguiContext, egui};

use crate::{Inspector, InspectorWants};
use state::Shell;

/// Behind every other camera.
const ORDER: isize = 10_000;

/// Frames that `bevy_egui` has after closing, to notice that its context is gone: messages of removals live for two.
const LINGER: u8 = 3;

/// Where the inspector is drawn: the primary window, or an image of a test.
#[derive(Resource, Clone, Debug, Default)]
pub struct InspectorTarget(pub RenderTarget);

/// The camera that draws it, while it is open.
#[derive(Component)]
pub struct InspectorCamera;

/// The schedule in which it is drawn. An app adds windows of its own to it, which are then open as long as the inspector.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct InspectorPass;

/// `bevy_egui`'s systems run. Counts frames that are left where all is closed.
#[derive(Resource)]
struct Runs(u8);

/// The plugin was added to an app without a renderer.
#[derive(Resource)]
struct Blind;

pub(crate) fn build(app: &mut App) {
    if app.get_sub_app(RenderApp).is_none() {
        app.insert_resource(Blind);
        return;
    }
    if !app.is_plugin_added::<EguiPlugin>() {
        app.add_plugins(EguiPlugin::default());
        // Else the first camera of the app gets a context that nobody asked for.
        app.world_mut()
            .resource_mut::<EguiGlobalSettings>()
            .auto_create_primary_context = false;
        let runs = || resource_exists::<Runs>;
        app.configure_sets(
            PreUpdate,
            (
                EguiPreUpdateSet::InitContexts.run_if(runs()),
                EguiPreUpdateSet::ProcessInput.run_if(runs()),
                EguiPreUpdateSet::BeginPass.run_if(runs()),
            ),
        )
        .configure_sets(
            PostUpdate,
            (
                EguiPostUpdateSet::EndPass.run_if(runs()),
                EguiPostUpdateSet::ProcessOutput.run_if(runs()),
                EguiPostUpdateSet::PostProcessOutput.run_if(runs()),
            ),
        );
    }
    app.init_resource::<InspectorTarget>()
        .init_resource::<Shell>()
        .init_schedule(InspectorPass)
        .add_systems(InspectorPass, shell::show)
        .add_systems(
            PreUpdate,
            (
                open_or_close.run_if(resource_changed::<Inspector>),
                end.run_if(resource_exists::<Runs>),
            )
                .chain()
                .after(crate::InspectorSystems)
                .before(EguiPreUpdateSet::InitContexts),
        );
}

pub(crate) fn finish(app: &mut App) {
    if app.world().contains_resource::<Blind>() && app.get_sub_app(RenderApp).is_some() {
        warn!("the inspector has no panel: add InspectorPlugin after Bevy's DefaultPlugins");
    }
}

fn open_or_close(
    mut commands: Commands,
    inspector: Res<Inspector>,
    target: Res<InspectorTarget>,
    cameras: Query<Entity, With<InspectorCamera>>,
    mut textures: ResMut<EguiManagedTextures>,
    mut wants: ResMut<InspectorWants>,
) {
    let camera = cameras.iter().next();
    match (inspector.is_open(), camera) {
        (true, None) => {
            commands.spawn((
                InspectorCamera,
                Name::new("inspector"),
                Camera2d,
                Camera {
                    order: ORDER,
                    clear_color: ClearColorConfig::Custom(Color::NONE),
                    output_mode: CameraOutputMode::Write {
                        blend_state: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                        clear_color: ClearColorConfig::None,
                    },
                    ..default()
                },
                Msaa::Off,
                RenderLayers::none(),
                target.0.clone(),
                EguiContext::default(),
                EguiSchedule::new(InspectorPass),
            ));
            commands.insert_resource(Runs(LINGER));
        }
        (false, Some(camera)) => {
            commands.entity(camera).despawn();
            textures.retain(|(context, _), _| *context != camera);
            wants.set_if_neq(InspectorWants::default());
        }
        _ => {}
    }
}

/// Lets `bevy_egui` rest some frames after all was closed.
fn end(
    mut commands: Commands,
    inspector: Res<Inspector>,
    runs: Option<ResMut<Runs>>,
    cameras: Query<(), With<InspectorCamera>>,
) {
    let Some(mut runs) = runs else { return };
    if inspector.is_open() || !cameras.is_empty() {
        runs.0 = LINGER;
    } else if runs.0 > 0 {
        runs.0 -= 1;
    } else {
        commands.remove_resource::<Runs>();
    }
}
